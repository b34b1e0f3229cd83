//! The method, in order: [`prepare`] takes a scan to what can be matched, [`match_shapes`] two of these to a correspondence.

mod block;
mod body;
mod choice;
mod contact;
mod embedding;
mod error;
mod extent;
mod geometry;
mod given;
mod hypotheses;
mod matcher;
mod matching;
mod options;
mod prepare;
mod prepared;
mod processor;
mod reliability;
mod scan;
mod share;
mod surface;
mod thinned;
mod warnings;

pub use block::BlockError;
pub use choice::{DeviceChoice, DeviceError, DeviceInfo, DeviceKind, GpuUse};
#[cfg(feature = "train")]
pub(crate) use embedding::network_inputs;
pub use error::{Error, Result};
pub use matcher::Matcher;
#[cfg(feature = "train")]
pub(crate) use matching::match_with_cues;
pub use matching::{Match, Scale, ScaleSource, match_shapes, match_with};
pub use options::{FaceUse, MatchOptions, OptionError, Parts, PrepareOptions};
pub use prepare::{prepare, prepare_with};
pub use prepared::{Info, PreparedShape, ShapeKind};
pub use processor::Processor;
#[cfg(feature = "train")]
pub(crate) use scan::prepare_with_carriers;
pub use warnings::Warning;
