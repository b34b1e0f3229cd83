//! One variant per stage, each wrapping that stage's own error.

use crate::read::ReadError;
use crate::shape::ShapeError;

/// Why a call could not give a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The bytes are not a scan in a known format.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The points, faces or labels do not make a shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

impl Error {
    /// A stable, machine-readable name: `"truncated-file"`, `"too-few-points"`, …
    pub fn code(&self) -> &'static str {
        match self {
            Error::Read(e) => e.code(),
            Error::Shape(e) => e.code(),
        }
    }

    /// The numbers behind the sentence, as a JSON object: `{"promised": 60000, "found": 41232}`.
    pub fn details(&self) -> serde_json::Value {
        match self {
            Error::Read(e) => e.details(),
            Error::Shape(e) => e.details(),
        }
    }
}
