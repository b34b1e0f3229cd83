//! Shortest paths that stop early: at a radius, or when every target has been reached.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::EdgeGraph;

/// Dijkstra's algorithm with its working memory kept between searches.
pub struct BoundedDijkstra<'g> {
    graph: &'g EdgeGraph,
    distance: Vec<f64>,
    /// Targets not reached yet; all false between searches.
    wanted: Vec<bool>,
    touched: Vec<u32>,
    heap: BinaryHeap<Reverse<Front>>,
}

/// Distances of one search; vertices beyond the radius are at infinity.
pub struct Reached<'d> {
    distance: &'d [f64],
}

impl Reached<'_> {
    /// Length of the shortest path to `j`, or infinity. Exact up to the radius of the search.
    pub fn to(&self, j: u32) -> f64 {
        self.distance[j as usize]
    }
}

#[derive(Clone, Copy, PartialEq)]
struct Front {
    distance: f64,
    vertex: u32,
}

impl Eq for Front {}

impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance.total_cmp(&other.distance).then(self.vertex.cmp(&other.vertex))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<'g> BoundedDijkstra<'g> {
    /// Prepares searches on `graph`.
    pub fn new(graph: &'g EdgeGraph) -> Self {
        let n = graph.len();
        let (distance, wanted) = (vec![f64::INFINITY; n], vec![false; n]);
        Self { graph, distance, wanted, touched: Vec::new(), heap: BinaryHeap::new() }
    }

    /// Shortest paths from `source` as far as `radius` (same unit as the edges; infinity for the whole graph).
    pub fn search(&mut self, source: u32, radius: f64) -> Reached<'_> {
        self.search_for(&[], source, radius)
    }

    /// The same, over as soon as all `targets`, each named once, are reached: only distances to them are exact then. Without targets nothing ends it early.
    pub fn search_for(&mut self, targets: &[u32], source: u32, radius: f64) -> Reached<'_> {
        let mut left = targets.len();
        targets.iter().for_each(|&t| self.wanted[t as usize] = true);
        for &v in &self.touched {
            self.distance[v as usize] = f64::INFINITY;
        }
        self.touched.clear();
        self.heap.clear();
        self.distance[source as usize] = 0.0;
        self.touched.push(source);
        self.heap.push(Reverse(Front { distance: 0.0, vertex: source }));
        while let Some(Reverse(Front { distance, vertex })) = self.heap.pop() {
            if distance > self.distance[vertex as usize] {
                continue;
            }
            let v = vertex as usize;
            if std::mem::take(&mut self.wanted[v]) {
                left -= 1;
                if left == 0 {
                    break;
                }
            }
            for (&next, &length) in self.graph.neighbours(v).iter().zip(self.graph.lengths(v)) {
                let through = distance + length;
                let known = &mut self.distance[next as usize];
                if through < *known && through <= radius {
                    if known.is_infinite() {
                        self.touched.push(next);
                    }
                    *known = through;
                    self.heap.push(Reverse(Front { distance: through, vertex: next }));
                }
            }
        }
        targets.iter().for_each(|&t| self.wanted[t as usize] = false);
        Reached { distance: &self.distance }
    }
}
