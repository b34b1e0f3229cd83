//! The cotangent Laplacian and lumped mass of a triangle mesh, made safe for any triangles.

use super::intrinsic::TuftedCover;
use super::{Laplacian, LaplacianKind};

/// Cotangent weights and barycentric mass on the intrinsic Delaunay triangulation of the tufted cover.
///
/// Weights are not below −1e-6, and non-manifold edges, boundaries and needle triangles need no special
/// case. The cover is two sheets thick, so both matrices are halved. A vertex without faces has an empty row and no mass.
/// Sharp & Crane 2020; same construction and constants as the robust_laplacian package, which tests compare against.
pub fn cotangent_laplacian(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Laplacian {
    let mut cover = TuftedCover::new(points, faces);
    cover.flip_to_delaunay();
    let mut mass = vec![0.0; points.len()];
    let mut weights = Vec::with_capacity(6 * faces.len());
    for (vertices, cotangents, area) in cover.triangles() {
        for s in 0..3 {
            mass[vertices[s] as usize] += 0.5 * area / 3.0;
            weights.push((vertices[s], vertices[(s + 1) % 3], 0.25 * cotangents[s]));
        }
    }
    Laplacian::from_weights(LaplacianKind::Cotangent, mass, weights)
}
