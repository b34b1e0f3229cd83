//! What a correspondence is used for.

mod geodesic_error;
mod part_scores;

pub use geodesic_error::{EdgeDistances, mean_error, point_errors};
pub use part_scores::{PartScores, part_scores};
