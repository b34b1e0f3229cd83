//! Which of some sources is nearest along a graph: Voronoi cells on a surface.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::EdgeGraph;

/// For each vertex the row in `sources` of the one nearest along the edges, ties to the lower row; `u32::MAX` where no path leads to any.
pub fn nearest_sources(graph: &EdgeGraph, sources: &[u32]) -> Vec<u32> {
    let mut settled = vec![u32::MAX; graph.len()];
    let mut distance = vec![f64::INFINITY; graph.len()];
    let mut fronts: BinaryHeap<Reverse<Front>> = BinaryHeap::new();
    for (row, &vertex) in sources.iter().enumerate() {
        fronts.push(Reverse(Front { distance: 0.0, row: row as u32, vertex }));
    }
    while let Some(Reverse(Front { distance: reached, row, vertex })) = fronts.pop() {
        let v = vertex as usize;
        if settled[v] != u32::MAX {
            continue;
        }
        settled[v] = row;
        for (&next, &length) in graph.neighbours(v).iter().zip(graph.lengths(v)) {
            let through = reached + length;
            if settled[next as usize] == u32::MAX && through < distance[next as usize] {
                distance[next as usize] = through;
                fronts.push(Reverse(Front { distance: through, row, vertex: next }));
            }
        }
    }
    settled
}

#[derive(Clone, Copy, PartialEq)]
struct Front {
    distance: f64,
    row: u32,
    vertex: u32,
}

impl Eq for Front {}

impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        let rest = (self.row, self.vertex).cmp(&(other.row, other.vertex));
        self.distance.total_cmp(&other.distance).then(rest)
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
