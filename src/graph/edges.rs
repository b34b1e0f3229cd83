//! An undirected graph with edge lengths, in compressed rows.

use crate::shape::Shape;
use crate::vector::squared_distance;

/// Rows of (neighbour, length), each edge stored in both rows, neighbours ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeGraph {
    indptr: Vec<usize>,
    indices: Vec<u32>,
    lengths: Vec<f64>,
}

impl EdgeGraph {
    /// From edges `(i, j, length)`, each given once in either order or several times; self-loops are left out.
    pub fn from_edges(n: usize, edges: impl IntoIterator<Item = (u32, u32, f64)>) -> Self {
        let edges: Vec<(u32, u32, f64)> = edges.into_iter().filter(|(i, j, _)| i != j).collect();
        // Into rows by counting, so that only short rows are sorted.
        let mut start = vec![0; n + 1];
        for &(i, j, _) in &edges {
            start[i as usize + 1] += 1;
            start[j as usize + 1] += 1;
        }
        for i in 0..n {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut both = vec![(0, 0.0); 2 * edges.len()];
        let mut enter = |i: u32, j: u32, length: f64| {
            both[next[i as usize]] = (j, length);
            next[i as usize] += 1;
        };
        for &(i, j, length) in &edges {
            enter(i, j, length);
            enter(j, i, length);
        }
        let mut indptr = vec![0; n + 1];
        let (mut indices, mut lengths) = (Vec::with_capacity(both.len()), Vec::with_capacity(both.len()));
        for i in 0..n {
            let row = &mut both[start[i]..start[i + 1]];
            row.sort_unstable_by(|a: &(u32, f64), b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            for (at, &(j, length)) in row.iter().enumerate() {
                if at == 0 || row[at - 1].0 != j {
                    indices.push(j);
                    lengths.push(length);
                }
            }
            indptr[i + 1] = indices.len();
        }
        Self { indptr, indices, lengths }
    }

    /// The edges of a mesh with their lengths; none for a cloud.
    pub fn of_mesh(shape: &Shape) -> Self {
        let points = shape.points();
        let length = |i: u32, j: u32| squared_distance(points[i as usize], points[j as usize]).sqrt();
        let edges = shape.faces().iter().flat_map(|f| (0..3).map(move |s| (f[s], f[(s + 1) % 3])));
        Self::from_edges(points.len(), edges.map(|(i, j)| (i, j, length(i, j))))
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.indptr.len() - 1
    }

    /// True without vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of undirected edges.
    pub fn edge_count(&self) -> usize {
        self.indices.len() / 2
    }

    /// Neighbours of `i`, ascending.
    pub fn neighbours(&self, i: usize) -> &[u32] {
        &self.indices[self.indptr[i]..self.indptr[i + 1]]
    }

    /// Lengths of the edges to [`neighbours`](Self::neighbours).
    pub fn lengths(&self, i: usize) -> &[f64] {
        &self.lengths[self.indptr[i]..self.indptr[i + 1]]
    }

    /// Whether `i` and `j` share an edge.
    pub fn contains(&self, i: usize, j: u32) -> bool {
        self.neighbours(i).binary_search(&j).is_ok()
    }

    /// Every edge once, as `(i, j, length)` with i < j.
    pub fn edges(&self) -> impl Iterator<Item = (u32, u32, f64)> + '_ {
        (0..self.len()).flat_map(move |i| {
            self.neighbours(i)
                .iter()
                .zip(self.lengths(i))
                .filter(move |&(&j, _)| (i as u32) < j)
                .map(move |(&j, &length)| (i as u32, j, length))
        })
    }
}
