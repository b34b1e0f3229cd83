//! The network: what it sees of a shape, its layers, its weights, and the parts of the body that it knows.

mod attention;
mod batch_norm;
mod category;
mod config;
mod diffusion_net;
mod error;
mod inputs;
mod layers;
mod model;
mod moments;
#[allow(clippy::module_inception)] // The network's own file, among those of its pieces.
mod network;
mod weights;

pub use batch_norm::Statistics;
pub(crate) use category::{CUES, SITUATIONS};
pub use category::{Category, Part, Thresholds};
pub use config::{Encoding, InputConfig, ModelConfig, Norm, Position, Solver};
pub use error::WeightsError;
pub use inputs::ShapeInputs;
#[cfg(feature = "train")]
pub(crate) use model::PRIOR;
pub use model::{Model, PointEmbedding, TrainedNetwork};
pub use network::{Embedding, Network};
pub use weights::{Source, Start, Weights, WeightsId};
