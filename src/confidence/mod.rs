//! How sure a match is: what it shows of its own faults, and the probability that this makes of being right.

mod calibration;
mod cues;
mod distortion;
mod overlap;

pub(crate) use calibration::confidence;
#[cfg(feature = "train")]
pub(crate) use calibration::{Fit, Situation, fit_of_faults, probability, signs};
pub(crate) use cues::Cues;
#[cfg(feature = "train")]
pub(crate) use cues::GENERAL;
pub use distortion::{relative_scale, strain, stretch};
pub(crate) use overlap::overlap;
