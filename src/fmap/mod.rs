//! Functional maps between two shapes, their refinement, and the correspondences they stand for.
//!
//! **Direction.** A functional map C_ab takes functions on A to functions on B (k_b rows, k_a columns). The point map that belongs to it goes the
//! other way, from points of B to points of A. To send points of A to B one needs C_ba. All names here say which is which.

mod alignment;
mod chirality;
mod confidence;
mod correspondence;
mod cues;
mod embedding;
mod functional_map;
mod initial;
mod landmarks;
mod laying;
mod learned;
mod lifting;
mod metrics;
mod part_scores;
mod refine;
mod rigidity;
mod stretch;

#[cfg(feature = "train")]
pub(crate) use confidence::{Fit, Situation, fit, probability};
pub use correspondence::{Correspondence, UNMATCHED};
#[cfg(feature = "train")]
pub(crate) use cues::CUES;
pub(crate) use cues::Cues;
pub use embedding::Matchable;
pub use functional_map::FunctionalMap;
#[cfg(feature = "train")]
pub use functional_map::functional_maps;
pub use initial::initial_maps;
pub use landmarks::{landmark_functions, part_functions};
pub use learned::{Familiarity, learned_maps};
pub use lifting::lift;
pub use metrics::{EdgeDistances, mean_error, point_errors};
pub use part_scores::{PartScores, part_scores};
pub use refine::{COARSE, Refined, Refinement, refine};
pub use stretch::{strain, stretch};
