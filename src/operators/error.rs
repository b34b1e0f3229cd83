//! Why no Laplacian could be built.

use serde_json::{Value, json};

use crate::progress::Cancelled;

/// Why no Laplacian could be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OperatorError {
    /// Cotangents need triangles.
    #[error("a cotangent Laplacian needs faces, and this scan is a point cloud: choose the geodesic one")]
    NeedsFaces,
    /// An option that this kind of Laplacian does not have, or a value that it cannot have.
    #[error("{message}")]
    InvalidOption {
        /// The option by the name users write: `k0`, `k`, `tau`, `iterations`, `sigma`.
        option: &'static str,
        /// A sentence for a person.
        message: String,
    },
    /// The listener asked for a stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl OperatorError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            OperatorError::NeedsFaces => "needs-faces",
            OperatorError::InvalidOption { .. } => "invalid-option",
            OperatorError::Cancelled(_) => "cancelled",
        }
    }

    /// The facts behind the sentence.
    pub fn details(&self) -> Value {
        match self {
            OperatorError::InvalidOption { option, .. } => json!({ "option": option }),
            OperatorError::NeedsFaces | OperatorError::Cancelled(_) => json!({}),
        }
    }
}
