//! What is known of points without a network: spectral descriptors, and the surface around a sampling.

mod heat_kernel;
mod outward_normals;
mod sampled_surface;
mod wave_kernel;

use ndarray::Array2;

pub(crate) use heat_kernel::heat_kernel_signature;
pub use sampled_surface::SampledSurface;
pub(crate) use wave_kernel::ENERGIES;
pub use wave_kernel::wave_kernel_signature;

/// Descriptors (n, c), one row per point used. Each column has mean 0 and mean square 1 under the mass, so that columns weigh alike.
#[derive(Clone, Debug, PartialEq)]
pub struct PointFeatures {
    /// Values (n, c).
    pub values: Array2<f32>,
}
