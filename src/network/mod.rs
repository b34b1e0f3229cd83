//! The network: what it sees of a shape, its layers, its weights, and the parts of the body that it knows.

mod attention;
mod category;
mod config;
mod diffusion_net;
mod inputs;
mod layers;
mod model;
mod moments;
#[allow(clippy::module_inception)] // The network's own file, among those of its pieces.
mod network;
mod weights;

pub(crate) use category::meeting;
pub use category::{GROUP_OF_PART, GROUPS, PARTS};
pub use config::{ModelConfig, Position};
pub use inputs::ShapeInputs;
#[cfg(feature = "train")]
pub(crate) use model::PRIOR;
pub use model::{Model, PointEmbedding};
pub use network::{Embedding, Network};
pub use weights::{Source, Start, Weights, WeightsError};
