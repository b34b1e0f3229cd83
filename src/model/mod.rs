//! The network as a whole: its configuration, its named weights, its forward pass.

mod config;
mod embedded;
mod network;
mod weights;

pub use config::{ModelConfig, Position};
#[cfg(feature = "train")]
pub(crate) use embedded::TRUST;
pub use embedded::{Model, PointEmbedding};
pub use network::{Embedding, Network};
pub use weights::{Source, Start, Weights, WeightsError};
