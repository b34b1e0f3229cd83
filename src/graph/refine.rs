//! Algorithm 1, steps 1 and 2: a graph that grows from k₀ to k neighbours and leaves out candidates that it knows for shortcuts.
//!
//! It knows them by its own distances, so where one of the first k₀ neighbours lies across a gap, those beside it pass: shortcuts grow fewer and do not
//! end. What is left of them the default operator weakens (`operators/quadrics.rs`).

use super::components::Forest;
use super::{BoundedDijkstra, EdgeGraph, Neighbours};

/// Parameters of Algorithm 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefineParams {
    /// k₀: neighbours in the sparse graph that geodesics start from.
    pub initial_neighbours: usize,
    /// τ: a candidate edge is kept while geodesic / Euclidean distance < τ.
    pub ratio: f64,
    /// T: iterations.
    pub iterations: usize,
}

impl Default for RefineParams {
    /// As printed in Algorithm 1: k₀ = 5, τ = 3.0, T = 3.
    fn default() -> Self {
        Self { initial_neighbours: 5, ratio: 3.0, iterations: 3 }
    }
}

/// 𝒢^(T): the kept edges with their geodesic lengths.
///
/// A kept edge is a straight line, the shortest path there is, so d_g^(T) on 𝒢^(T) equals its Euclidean length.
#[derive(Clone, Debug)]
pub struct GeodesicGraph {
    /// Kept edges, undirected: an edge is kept when it was a candidate of either end and passed.
    pub edges: EdgeGraph,
    /// What happened.
    pub report: RefineReport,
}

/// What the refinement kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefineReport {
    /// Candidate edges (undirected).
    pub candidates: usize,
    /// Candidates left out of 𝒢^(T).
    pub pruned: usize,
    /// Rejected candidates taken back because leaving them out would have cut a piece in two.
    pub bridges: usize,
}

/// Grows 𝒢^(0) (k₀-NN) to 𝒢^(T) (k-NN less candidates that fail the ratio). `neighbours` holds the k candidates of each point.
///
/// Where the paper is silent: the graph is undirected (either end's candidate counts); coincident points keep their
/// edge (the ratio 0/0 is 1); d_g = ∞ rejects, but the shortest rejected candidates are taken back where the k-NN
/// graph is connected and 𝒢^(T) would not be. An edge once kept has d_g equal to its own length, so it stays, and only
/// points that still have rejected candidates are searched again, no farther than τ times the longest of them.
/// Paper Sec. 3.2, Algorithm 1.
pub fn refine(neighbours: &Neighbours, params: &RefineParams) -> GeodesicGraph {
    let n = neighbours.len();
    let initial = params.initial_neighbours.min(neighbours.k());
    // Points are numbered in the order they are visited in until the end, so that searches read memory from one end to the other.
    let order = neighbours.order();
    let mut place = vec![0; n];
    order.iter().zip(0..).for_each(|(&i, at)| place[i as usize] = at);
    let mut kept: Vec<(u32, u32, f64)> = Vec::with_capacity(n * initial);
    let mut rejected: Vec<(u32, u32, f64)> = Vec::with_capacity(n * (neighbours.k() - initial));
    let mut candidates = 0;
    for (&i, at) in order.iter().zip(0..) {
        let of = neighbours.of(i as usize);
        for (slot, (&j, &d)) in of.iter().zip(neighbours.distances(i as usize)).enumerate() {
            let edge = (at, place[j as usize], d);
            if slot < initial || d == 0.0 {
                kept.push(edge)
            } else {
                rejected.push(edge)
            }
            candidates += usize::from(i < j || !neighbours.of(j as usize).contains(&i));
        }
    }
    let mut graph = EdgeGraph::from_edges(n, kept);
    for _ in 0..params.iterations {
        let mut search = BoundedDijkstra::new(&graph);
        let (mut passed, mut still_rejected) = (Vec::with_capacity(rejected.len()), Vec::new());
        let mut targets: Vec<u32> = Vec::new();
        // `rejected` stays grouped by source, so each source is searched once.
        for row in rejected.chunk_by(|a, b| a.0 == b.0) {
            let (source, farthest) = (row[0].0, row.iter().fold(0.0, |m: f64, e| m.max(e.2)));
            targets.clear();
            targets.extend(row.iter().map(|edge| edge.1));
            let reached = search.search_for(&targets, source, params.ratio * farthest);
            for &edge in row {
                let passes = reached.to(edge.1) < params.ratio * edge.2;
                if passes { passed.push(edge) } else { still_rejected.push(edge) }
            }
        }
        rejected = still_rejected;
        if passed.is_empty() {
            break;
        }
        graph = graph.with(passed);
        if rejected.is_empty() {
            break;
        }
    }
    let bridges = bridges(&graph, &rejected, order);
    let report_bridges = bridges.len();
    if !bridges.is_empty() {
        graph = graph.with(bridges);
    }
    let edges = graph.renumbered(order, &place);
    let pruned = candidates - edges.edge_count();
    GeodesicGraph { edges, report: RefineReport { candidates, pruned, bridges: report_bridges } }
}

/// The shortest rejected edges that join pieces the kept edges leave apart (Kruskal); equally long ones as `order` names
/// their ends.
fn bridges(kept: &EdgeGraph, rejected: &[(u32, u32, f64)], order: &[u32]) -> Vec<(u32, u32, f64)> {
    if rejected.is_empty() {
        return Vec::new();
    }
    let mut forest = Forest::new(kept.len());
    for (i, j, _) in kept.edges() {
        forest.join(i, j);
    }
    let mut by_length = rejected.to_vec();
    let ends = |edge: &(u32, u32, f64)| (order[edge.0 as usize], order[edge.1 as usize]);
    by_length.sort_by(|a, b| a.2.total_cmp(&b.2).then(ends(a).cmp(&ends(b))));
    by_length.retain(|&(i, j, _)| forest.join(i, j));
    by_length
}
