//! An undirected graph with edge lengths, in compressed rows.

use crate::vector::{Vector, squared_distance};

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
            row.sort_unstable_by_key(|&(j, _)| j);
            for copies in row.chunk_by(|a, b| a.0 == b.0) {
                indices.push(copies[0].0);
                lengths.push(copies.iter().fold(f64::INFINITY, |least, copy| least.min(copy.1)));
            }
            indptr[i + 1] = indices.len();
        }
        Self { indptr, indices, lengths }
    }

    /// These edges and others, given as to [`from_edges`](Self::from_edges).
    pub fn with(&self, edges: impl IntoIterator<Item = (u32, u32, f64)>) -> Self {
        let others = Self::from_edges(self.len(), edges);
        let room = self.indices.len() + others.indices.len();
        let mut both = Self {
            indptr: Vec::with_capacity(self.indptr.len()),
            indices: Vec::with_capacity(room),
            lengths: Vec::with_capacity(room),
        };
        both.indptr.push(0);
        for i in 0..self.len() {
            let mut others = others.neighbours(i).iter().zip(others.lengths(i)).peekable();
            for (&j, &length) in self.neighbours(i).iter().zip(self.lengths(i)) {
                while let Some((&other, &length)) = others.next_if(|&(&other, _)| other < j) {
                    both.enter(other, length);
                }
                let known = others.next_if(|&(&other, _)| other == j);
                both.enter(j, known.map_or(length, |(_, other)| length.min(*other)));
            }
            others.for_each(|(&j, &length)| both.enter(j, length));
            both.indptr.push(both.indices.len());
        }
        both
    }

    /// The same with vertex v called `name[v]`; `vertex` is the inverse of that.
    pub(super) fn renumbered(&self, name: &[u32], vertex: &[u32]) -> Self {
        let mut renumbered = Self {
            indptr: Vec::with_capacity(self.indptr.len()),
            indices: Vec::with_capacity(self.indices.len()),
            lengths: Vec::with_capacity(self.lengths.len()),
        };
        renumbered.indptr.push(0);
        let mut row: Vec<(u32, f64)> = Vec::new();
        for v in vertex.iter().map(|&v| v as usize) {
            row.clear();
            row.extend(self.neighbours(v).iter().map(|&j| name[j as usize]).zip(self.lengths(v).iter().copied()));
            row.sort_unstable_by_key(|&(j, _)| j);
            row.iter().for_each(|&(j, length)| renumbered.enter(j, length));
            renumbered.indptr.push(renumbered.indices.len());
        }
        renumbered
    }

    fn enter(&mut self, j: u32, length: f64) {
        self.indices.push(j);
        self.lengths.push(length);
    }

    /// The edges of triangles over `points` with their lengths; none without triangles.
    pub fn of_faces(points: &[Vector], faces: &[[u32; 3]]) -> Self {
        let length = |i: u32, j: u32| squared_distance(points[i as usize], points[j as usize]).sqrt();
        let edges = faces.iter().flat_map(|f| (0..3).map(move |s| (f[s], f[(s + 1) % 3])));
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
