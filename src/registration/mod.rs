//! Registration: the frame that two bodies are first compared in, and rounds of matching in which each body is deformed onto the other.

mod alignment;
mod as_rigid_as_possible;
mod chirality;
mod deformation;
mod initial;
mod landmarks;
mod refine;

pub(crate) use alignment::{Rotation, best_rotation_and_certainty, turned};
pub(crate) use initial::initial_maps;
pub(crate) use landmarks::Constraints;
pub(crate) use landmarks::{AWAY, distinct, sampled_at};
pub use refine::Refinement;
pub(crate) use refine::{COARSE, Refined, refine};
