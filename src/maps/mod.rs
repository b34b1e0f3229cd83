//! Functional maps between two shapes, and the point maps that belong to them.
//!
//! **Direction.** A functional map C_ab takes functions on A to functions on B (k_b rows, k_a columns). The point map that belongs to it goes the
//! other way, from points of B to points of A. To send points of A to B one needs C_ba. All names here say which is which.

mod correspondence;
mod functional_map;
mod known_functions;
mod learned;
mod matchable;
mod point_map;

pub use correspondence::{Correspondence, UNMATCHED};
pub use functional_map::FunctionalMap;
#[cfg(feature = "train")]
pub use functional_map::functional_maps;
pub(crate) use functional_map::{smoothed, smoothed_where};
pub use known_functions::{landmark_functions, part_functions};
pub(crate) use learned::{OutOfDistribution, learned_maps};
pub use matchable::{LearnedCues, Matchable};
pub use point_map::MapPair;
pub(crate) use point_map::{SideColumns, joint_nearest, maps_of_match};
