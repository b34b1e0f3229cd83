//! One variant per stage, each wrapping that stage's own error.

use serde_json::json;

use super::{BlockError, DeviceError, OptionError};
use crate::network::WeightsError;
use crate::operators::OperatorError;
use crate::progress::Cancelled;
use crate::read::ReadError;
use crate::shape::ShapeError;
use crate::spectrum::SpectrumError;

/// What calls give, or why they could not.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a call could not give a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The bytes are not a scan in a known format.
    #[error(transparent)]
    Read(ReadError),
    /// The points, faces or labels do not make a shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// No Laplacian can be built.
    #[error(transparent)]
    Operator(OperatorError),
    /// No eigenpairs can be found.
    #[error(transparent)]
    Spectrum(SpectrumError),
    /// The device asked for is not there.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// An option has no meaning here.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Weights that cannot be used.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// Bytes that should be a prepared shape are not.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// Something that a match computes with holds what is no finite number.
    #[error("{what}: there is something in it that is no finite number")]
    NotFinite {
        /// What.
        what: String,
    },
    /// The listener asked for a stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<ReadError> for Error {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Shape(error) => Error::Shape(error),
            error => Error::Read(error),
        }
    }
}

impl From<OperatorError> for Error {
    fn from(error: OperatorError) -> Self {
        match error {
            OperatorError::Cancelled(stop) => Error::Cancelled(stop),
            error => Error::Operator(error),
        }
    }
}

impl From<SpectrumError> for Error {
    fn from(error: SpectrumError) -> Self {
        match error {
            SpectrumError::Cancelled(stop) => Error::Cancelled(stop),
            error => Error::Spectrum(error),
        }
    }
}

impl Error {
    /// A stable, machine-readable name: `"truncated-file"`, `"too-few-points"`, …
    pub fn code(&self) -> &'static str {
        match self {
            Error::Read(e) => e.code(),
            Error::Shape(e) => e.code(),
            Error::Operator(e) => e.code(),
            Error::Spectrum(e) => e.code(),
            Error::Device(e) => e.code(),
            Error::Option(e) => e.code(),
            Error::Weights(_) => "invalid-weights",
            Error::Block(e) => e.code(),
            Error::NotFinite { .. } => "not-finite",
            Error::Cancelled(_) => "cancelled",
        }
    }

    /// The numbers behind the sentence, as a JSON object: `{"promised": 60000, "found": 41232}`.
    pub fn details(&self) -> serde_json::Value {
        match self {
            Error::Read(e) => e.details(),
            Error::Shape(e) => e.details(),
            Error::Operator(e) => e.details(),
            Error::Spectrum(e) => e.details(),
            Error::Device(e) => e.details(),
            Error::Option(e) => e.details(),
            Error::Weights(e) => json!({ "reason": e.0 }),
            Error::Block(e) => json!({ "reason": e.to_string() }),
            Error::NotFinite { what } => json!({ "what": what }),
            Error::Cancelled(e) => json!({ "stage": e.stage }),
        }
    }
}
