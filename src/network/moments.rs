//! Where a point lies among weighted centres of the body: what makes left and right visible in any pose and orientation.
//!
//! Distances and inner products are blind to mirroring, and so is the Laplacian; a network that sees nothing else matches a body and its mirror image
//! alike. The triple product of three vectors changes its sign. Each of the q learned weightings a of the points gives a vector G = Σ mass·a·x; every
//! point x then gets x·G_i and x·(G_i × G_j): invariant under rotation, odd under mirroring, without normals or aligned axes.

use super::error::WeightsError;
use super::inputs::InputsOn;
use super::layers::Linear;
use super::weights::Source;
use crate::device::Device;

/// Learned weightings.
#[derive(Clone, Debug)]
pub struct Moments<T> {
    weighting: Linear<T>,
}

/// Channels that `q` weightings give.
pub fn moment_channels(q: usize) -> usize {
    q + q * q.saturating_sub(1) / 2
}

impl<T> Moments<T> {
    /// `q` weightings from `channels`.
    pub fn new(source: &mut impl Source<T>, name: &str, channels: usize, q: usize) -> Result<Self, WeightsError> {
        Ok(Self { weighting: Linear::new(source, &format!("{name}.weighting"), channels, q, 1.0)? })
    }

    /// (n, channels) → (n, q) inner and (n, q(q−1)/2) triple products.
    pub fn forward<D: Device<Tensor = T>>(&self, device: &D, x: &T, shape: &InputsOn<T>) -> [T; 2] {
        let weights = device.tanh(&self.weighting.forward(device, x));
        let centres = device.matmul_tn(&weights, &shape.moments);
        let crosses = device.cross_pairs(&centres);
        [device.matmul_nt(&shape.points, &centres), device.matmul_nt(&shape.points, &crosses)]
    }
}
