//! How sure a match is: what it shows of its own faults, and the probability that this makes of being right.

mod calibration;
mod cues;
mod distortion;
#[cfg(any(test, feature = "train"))]
mod fit;
mod overlap;

pub(crate) use calibration::confidence;
#[cfg(feature = "train")]
pub(crate) use calibration::{Situation, probability};
pub(crate) use cues::Cues;
#[cfg(feature = "train")]
pub(crate) use cues::GENERAL;
pub use distortion::{relative_scale, strain, stretch};
#[cfg(feature = "train")]
pub(crate) use fit::{Fit, fit_of_faults, signs};
pub(crate) use overlap::overlap;
