//! Point-cloud Laplacians: Algorithm 1 as printed, and the density-normalised form that is the default.
//!
//! Paper Sec. 3.2 (Algorithm 1, steps 3 and 4). On FAUST clouds with the exact map at k = 120 the printed form has an error of
//! 2.07 (×100/√area), plain k-NN weights 1.77, and the density-normalised form below 1.14.

use super::{Laplacian, LaplacianKind, cloud_mass};
use crate::graph::{EdgeGraph, Neighbours};

/// Parameters of the Gaussian weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianParams {
    /// k: candidate neighbours of each point (Algorithm 1: 20).
    pub neighbours: usize,
}

impl Default for GaussianParams {
    fn default() -> Self {
        Self { neighbours: 20 }
    }
}

/// W′ = exp(−d²/2σ²)·exp(−d_g²/2σ²). On a kept edge d_g = d, so this is exp(−d²/σ²).
fn weights(graph: &EdgeGraph, sigma: f64) -> impl Iterator<Item = (u32, u32, f64)> + '_ {
    let inverse = if sigma > 0.0 { 1.0 / (sigma * sigma) } else { 0.0 };
    graph.edges().map(move |(i, j, d)| (i, j, (-d * d * inverse).exp()))
}

/// L̃ = D̃ − W′ with unit mass, as printed. `sigma` is the mean distance to the k nearest neighbours over the cloud.
pub fn literal_laplacian(graph: &EdgeGraph, sigma: f64) -> Laplacian {
    Laplacian::from_weights(LaplacianKind::GeodesicLiteral, vec![1.0; graph.len()], weights(graph, sigma))
}

/// W ← Q⁻¹WQ⁻¹ with Q the row sums including the point itself (α = 1, so that sampling density drops out in the limit),
/// mass from the neighbourhood discs.
///
/// The scale makes the Dirichlet energy of the coordinate functions twice the area, as on any surface:
/// Σ_c ∫|∇x_c|² = ∫ tr(tangent projector) = 2·area. It replaces the kernel constant, which truncation at k neighbours spoils.
pub fn gaussian_laplacian(
    points: &[[f64; 3]],
    graph: &EdgeGraph,
    neighbours: &Neighbours,
    kind: LaplacianKind,
) -> Laplacian {
    let sigma = neighbours.mean_distance();
    let mut density = vec![1.0; graph.len()];
    for (i, j, w) in weights(graph, sigma) {
        density[i as usize] += w;
        density[j as usize] += w;
    }
    let mass = cloud_mass(neighbours);
    let normalised = || weights(graph, sigma).map(|(i, j, w)| (i, j, w / (density[i as usize] * density[j as usize])));
    let energy: f64 = normalised().map(|(i, j, w)| w * squared_distance(points[i as usize], points[j as usize])).sum();
    let scale = if energy > 0.0 { 2.0 * mass.iter().sum::<f64>() / energy } else { 0.0 };
    Laplacian::from_weights(kind, mass, normalised().map(|(i, j, w)| (i, j, w * scale)))
}

fn squared_distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum()
}
