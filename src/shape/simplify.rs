//! A mesh with fewer vertices, all of them vertices of the one given, and the way back.

use std::collections::BTreeSet;

use super::Shape;
use super::sample::farthest_points;
use crate::graph::{EdgeGraph, nearest_sources};
use crate::progress::Cancelled;

/// A mesh on some of the vertices of another.
pub struct Simplified {
    /// Vertex of the original behind each vertex here.
    pub vertices: Vec<u32>,
    /// Triangles over the vertices here.
    pub faces: Vec<[u32; 3]>,
    /// For every vertex of the original the vertex here that stands for it: the nearest along the surface.
    pub cell: Vec<u32>,
}

/// `count` of the vertices `allowed`, evenly spread, each drawing together the vertices nearest to it along the edges; what is left of
/// the triangles is the mesh.
///
/// Drawing cells together is a simplicial map: a closed surface stays closed and touching limbs stay apart, though a part thinner than the
/// spacing may fold flat, which the Laplacian's tufted cover (Sharp & Crane 2020) can take. There are pure-Rust decimators, but they ask for manifold
/// input or move vertices, and here every vertex must remain one of the scan.
pub fn simplify(
    shape: &Shape,
    allowed: &[u32],
    count: usize,
    heard: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Simplified, Cancelled> {
    let vertices = farthest_points(shape.points(), allowed, count, heard)?;
    let cell = cells(shape, &vertices);
    let mut seen = BTreeSet::new();
    let mut faces = Vec::new();
    for face in shape.faces() {
        let [a, b, c] = face.map(|v| cell[v as usize]);
        let least = a.min(b).min(c);
        // From its lowest corner on, so that the two sides of a fold differ and repetitions do not.
        let drawn = if a == least {
            [a, b, c]
        } else if b == least {
            [b, c, a]
        } else {
            [c, a, b]
        };
        if a != b && b != c && c != a && seen.insert(drawn) {
            faces.push(drawn);
        }
    }
    Ok(Simplified { vertices, faces, cell })
}

/// For every point the row of the sample nearest along the surface; in space where no edge leads to one, as on a cloud.
pub fn cells(shape: &Shape, samples: &[u32]) -> Vec<u32> {
    if shape.faces().is_empty() {
        return super::nearest_samples(shape.points(), samples);
    }
    let mut cell = nearest_sources(&EdgeGraph::of_mesh(shape), samples);
    let lost: Vec<usize> = (0..cell.len()).filter(|&i| cell[i] == u32::MAX).collect();
    if !lost.is_empty() {
        let in_space = super::nearest_samples(shape.points(), samples);
        lost.into_iter().for_each(|i| cell[i] = in_space[i]);
    }
    cell
}
