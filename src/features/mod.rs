//! What is known about a point before any map: descriptors per point.

mod diffusion_net;
mod heat_kernel;
mod inputs;
mod layers;
mod moments;
mod wave_kernel;

use ndarray::Array2;

pub(crate) use diffusion_net::DiffusionBlock;
pub(crate) use inputs::{InputsOn, input_channels};
pub use inputs::{ShapeInputs, weyl_factor};
pub(crate) use layers::{LayerNorm, Linear};
pub use wave_kernel::wave_kernel_signature;

/// Descriptors (n, c), one row per point used. Each column has mean 0 and mean square 1 under the mass, so that columns weigh alike.
#[derive(Clone, Debug, PartialEq)]
pub struct PointFeatures {
    /// Values (n, c).
    pub values: Array2<f32>,
}
