//! k nearest neighbours in space.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::curve::along_curve;

/// The `k` nearest other points of each point, nearest first; equal distances in order of index.
#[derive(Clone, Debug)]
pub struct Neighbours {
    k: usize,
    indices: Vec<u32>,
    distances: Vec<f64>,
    order: Vec<u32>,
}

impl Neighbours {
    /// All points, such that near ones follow each other: to be visited in this order by whatever looks at neighbours.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Neighbours per point: the `k` asked for, or n − 1 where there are not so many points.
    pub fn k(&self) -> usize {
        self.k
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.indices.len().checked_div(self.k).unwrap_or(0)
    }

    /// True when there are no neighbours at all.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Indices of the neighbours of point `i`.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.indices[i * self.k..(i + 1) * self.k]
    }

    /// Euclidean distances to the neighbours of point `i`, in the unit of the points.
    pub fn distances(&self, i: usize) -> &[f64] {
        &self.distances[i * self.k..(i + 1) * self.k]
    }

    /// Mean distance from point `i` to its neighbours.
    pub fn mean_distance_from(&self, i: usize) -> f64 {
        self.distances(i).iter().sum::<f64>() / self.k.max(1) as f64
    }

    /// Mean distance over all points and all their neighbours: the paper's scale σ (Sec. 3.2).
    pub fn mean_distance(&self) -> f64 {
        self.distances.iter().sum::<f64>() / self.distances.len().max(1) as f64
    }
}

/// Finds the `k` nearest other points of every point. Distances are Euclidean.
pub fn nearest_neighbours(points: &[[f64; 3]], k: usize) -> Neighbours {
    let k = k.min(points.len().saturating_sub(1));
    // One more than asked for: a point is its own nearest neighbour.
    let tree = ImmutableKdTree::<f64, 3>::new_from_slice(points);
    let (1.., Some(with_self), Ok(tree)) = (k, NonZero::new(k + 1), tree) else {
        return Neighbours { k: 0, indices: vec![], distances: vec![], order: vec![] };
    };
    let (mut indices, mut distances) = (vec![0; points.len() * k], vec![0.0; points.len() * k]);
    let order = along_curve(points);
    let mut row: Vec<(f64, u32)> = Vec::with_capacity(k + 1);
    for i in order.iter().map(|&i| i as usize) {
        let found = tree.query(&points[i]).nearest_n::<SquaredEuclidean<f64>>(with_self).execute();
        row.clear();
        row.extend(found.iter().map(|item| (item.distance, item.item)).filter(|&(_, j)| j as usize != i));
        row.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Among more than k copies of one point the tree may return only other copies.
        row.truncate(k);
        for (slot, &(d, j)) in (i * k..).zip(&row) {
            indices[slot] = j;
            distances[slot] = d.sqrt();
        }
    }
    Neighbours { k, indices, distances, order }
}

impl Neighbours {
    /// The plain k-NN graph: an edge wherever one point is among the neighbours of the other.
    pub fn graph(&self) -> super::EdgeGraph {
        let mut edges = Vec::with_capacity(self.indices.len());
        for i in self.order.iter().map(|&i| i as usize) {
            edges.extend(self.of(i).iter().zip(self.distances(i)).map(|(&j, &d)| (i as u32, j, d)));
        }
        super::EdgeGraph::from_edges(self.len(), edges)
    }
}
