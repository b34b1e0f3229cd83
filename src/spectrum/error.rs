//! Why there are no eigenpairs.

use crate::progress::Cancelled;

/// Why there are no eigenpairs.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumError {
    /// Arrays of different lengths, unsorted columns, an index out of range, entries that are not finite or not symmetric.
    #[error("the matrix is not valid: {reason}")]
    InvalidMatrix {
        /// What is wrong.
        reason: String,
    },
    /// A basis without functions.
    #[error("a spectrum needs at least one eigenpair, and none was asked for")]
    NoEigenpairs,
    /// Too few points with mass for even one eigenpair.
    #[error("a spectrum needs at least 3 points with mass, and there are {found}")]
    TooFewPoints {
        /// Points with mass.
        found: usize,
    },
    /// A negative or non-finite mass, or none where the matrix has entries.
    #[error("point {index} has mass {mass}: it must be positive wherever the Laplacian has entries")]
    InvalidMass {
        /// First such point.
        index: usize,
        /// Its mass.
        mass: f64,
    },
    /// A negative eigenvalue, or no factorisation at all.
    #[error("the Laplacian could not be factorised: it is not a positive semi-definite matrix")]
    NotFactorised,
    /// More pairs asked for than fit in memory.
    #[error(
        "{eigenpairs} eigenpairs of {points} points need {bytes} bytes, more than the 2 GiB there may be: ask for fewer"
    )]
    TooLarge {
        /// Pairs asked for.
        eigenpairs: usize,
        /// Points.
        points: usize,
        /// Memory it would take.
        bytes: u64,
    },
    /// The iteration ended before all pairs had the residual promised.
    #[error("only {converged} of {wanted} eigenpairs converged (residual {residual:.1e})")]
    NotConverged {
        /// Pairs with a small enough residual.
        converged: usize,
        /// Pairs asked for.
        wanted: usize,
        /// Largest residual, relative to the largest eigenvalue.
        residual: f64,
    },
    /// The listener asked for a stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl SpectrumError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            SpectrumError::InvalidMatrix { .. } => "invalid-matrix",
            SpectrumError::NoEigenpairs => "invalid-option",
            SpectrumError::TooFewPoints { .. } => "too-few-points",
            SpectrumError::InvalidMass { .. } => "invalid-mass",
            SpectrumError::NotFactorised => "not-factorised",
            SpectrumError::TooLarge { .. } => "too-large",
            SpectrumError::NotConverged { .. } => "not-converged",
            SpectrumError::Cancelled(_) => "cancelled",
        }
    }

    /// The numbers behind the sentence.
    pub fn details(&self) -> serde_json::Value {
        use serde_json::json;
        match self {
            SpectrumError::TooFewPoints { found } => json!({ "found": found }),
            SpectrumError::InvalidMass { index, mass } => json!({ "index": index, "mass": mass }),
            SpectrumError::TooLarge { eigenpairs, points, bytes } => {
                json!({ "eigenpairs": eigenpairs, "points": points, "bytes": bytes })
            }
            SpectrumError::NotConverged { converged, wanted, residual } => {
                json!({ "converged": converged, "wanted": wanted, "residual": residual })
            }
            SpectrumError::NoEigenpairs
            | SpectrumError::InvalidMatrix { .. }
            | SpectrumError::NotFactorised
            | SpectrumError::Cancelled(_) => {
                json!({})
            }
        }
    }
}
