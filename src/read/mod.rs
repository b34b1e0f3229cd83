//! Bytes to a [`Shape`](crate::Shape), whatever the format.

use crate::error::Error;
use crate::shape::Shape;

/// File formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Object File Format, text.
    Off,
    /// Stanford polygon format, text or binary of either byte order.
    Ply,
    /// Wavefront OBJ, text.
    Obj,
    /// Binary glTF 2.0.
    Glb,
}

/// Why bytes could not be read as a scan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// No bytes at all.
    #[error("the file is empty")]
    Empty,
}

impl ReadError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            ReadError::Empty => "empty-file",
        }
    }

    /// The numbers behind the sentence.
    pub fn details(&self) -> serde_json::Value {
        serde_json::json!({})
    }
}

/// Reads a scan. The format is `format` if given, else found from the bytes, else from the extension of `name`.
pub fn read(bytes: &[u8], name: Option<&str>, format: Option<Format>) -> Result<Shape, Error> {
    let _ = (bytes, name, format);
    Err(ReadError::Empty.into())
}
