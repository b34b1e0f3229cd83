//! How wrong a correspondence is: the error everything is judged by.

use crate::graph::{BoundedDijkstra, EdgeGraph};
use crate::shape::Shape;

/// Shortest paths along the edges of a mesh, and the area they are measured against.
pub struct EdgeDistances {
    graph: EdgeGraph,
    root_area: f64,
}

impl EdgeDistances {
    /// For a mesh; a cloud has no edges, and every distance between different points is infinite.
    pub fn new(mesh: &Shape) -> Self {
        Self { graph: EdgeGraph::of_faces(mesh.points(), mesh.faces()), root_area: mesh.surface_area().sqrt() }
    }

    /// The edges, with their lengths in the unit of the mesh.
    pub fn graph(&self) -> &EdgeGraph {
        &self.graph
    }

    /// √area, in the unit of the mesh.
    pub fn root_area(&self) -> f64 {
        self.root_area
    }
}

/// Mean distance from predicted to true points, divided by √area, times 100 (paper Sec. 4.2; distances by Dijkstra on
/// mesh edges). `pairs` holds (predicted, true) indices on the mesh; a prediction out of range or in another piece
/// counts as infinite.
pub fn mean_error(distances: &EdgeDistances, pairs: &[(u32, u32)]) -> f64 {
    100.0 * point_errors(distances, pairs).iter().sum::<f64>() / pairs.len().max(1) as f64
}

/// Distance of each (predicted, true) pair, divided by √area; infinite for a prediction out of range or in another
/// piece.
pub fn point_errors(distances: &EdgeDistances, pairs: &[(u32, u32)]) -> Vec<f64> {
    let mut by_truth: Vec<usize> = (0..pairs.len()).collect();
    by_truth.sort_unstable_by_key(|&line| (pairs[line].1, pairs[line].0));
    let mut search = BoundedDijkstra::new(&distances.graph);
    let mut errors = vec![f64::INFINITY; pairs.len()];
    let mut wanted = Vec::new();
    for row in by_truth.chunk_by(|&x, &y| pairs[x].1 == pairs[y].1) {
        let on_mesh = row.iter().filter(|&&line| (pairs[line].0 as usize) < distances.graph.len());
        wanted.clear();
        wanted.extend(on_mesh.clone().map(|&line| pairs[line].0));
        wanted.dedup();
        if wanted.is_empty() {
            continue;
        }
        let reached = search.search_for(&wanted, pairs[row[0]].1, f64::INFINITY);
        for &line in on_mesh {
            errors[line] = reached.to(pairs[line].0) / distances.root_area;
        }
    }
    errors
}
