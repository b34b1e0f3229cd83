//! Why weights are refused.

/// Why weights cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("these weights cannot be used: {0}")]
pub struct WeightsError(pub String);
