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
        Self { graph: EdgeGraph::of_mesh(mesh), root_area: mesh.surface_area().sqrt() }
    }
}

/// How far predictions are looked for at first, in √area.
const NEAR: f64 = 0.05;

/// Mean distance from predicted to true points, divided by √area, times 100 (paper Sec. 4.2; distances by Dijkstra on mesh edges).
/// `pairs` holds (predicted, true) indices on the mesh; a prediction out of range or in another piece counts as infinite.
pub fn mean_error(distances: &EdgeDistances, pairs: &[(u32, u32)]) -> f64 {
    let mut by_truth = pairs.to_vec();
    by_truth.sort_unstable_by_key(|&(predicted, truth)| (truth, predicted));
    let mut search = BoundedDijkstra::new(&distances.graph);
    let mut sum = 0.0;
    for row in by_truth.chunk_by(|x, y| x.1 == y.1) {
        // Most predictions are near: look no farther than it takes.
        let mut radius = NEAR * distances.root_area;
        sum += loop {
            let reached = search.search(row[0].1, radius);
            let inside = |predicted: u32| (predicted as usize) < distances.graph.len();
            let to =
                |&(predicted, _): &(u32, u32)| if inside(predicted) { reached.to(predicted) } else { f64::INFINITY };
            let lengths: f64 = row.iter().map(to).sum();
            if lengths.is_finite() || radius.is_infinite() {
                break lengths;
            }
            radius = if radius < distances.root_area { 4.0 * radius } else { f64::INFINITY };
        };
    }
    100.0 * sum / pairs.len().max(1) as f64 / distances.root_area
}
