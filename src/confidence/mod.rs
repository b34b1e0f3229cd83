//! How sure a match is: what it shows of its own faults, and the probability that this makes of being right.

mod alone;
mod calibration;
mod cues;
mod distortion;
mod overlap;

#[cfg(feature = "train")]
pub(crate) use alone::SIGNS as SIGNS_OF_ALONE;
pub(crate) use calibration::confidence;
#[cfg(feature = "train")]
pub(crate) use calibration::{Fit, Situation, fit, fit_of_faults, probability};
pub(crate) use cues::Cues;
pub use distortion::{relative_scale, strain, stretch};
pub(crate) use overlap::overlap;
