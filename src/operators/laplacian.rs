//! The pair every spectral step needs: a positive semi-definite matrix and the mass of each point.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use sprs::CsMat;

/// Ways to discretise the Laplace–Beltrami operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum LaplacianKind {
    /// Algorithm 1's graph with density-normalised weights: the default on clouds.
    Geodesic,
    /// Algorithm 1 as printed: L̃ = D̃ − W′, unit mass.
    GeodesicLiteral,
    /// Density-normalised weights on the plain k-NN graph: the baseline.
    Euclidean,
    /// The paper's traditional L = D − W on the plain k-NN graph, W = exp(−d²/2σ²), unit mass: what its ablation compares with.
    Gaussian,
    /// Cotangents on the intrinsic Delaunay triangulation: the default on meshes.
    Cotangent,
}

impl LaplacianKind {
    /// All kinds, in the order they are offered to users.
    pub const ALL: [LaplacianKind; 5] =
        [Self::Geodesic, Self::GeodesicLiteral, Self::Euclidean, Self::Gaussian, Self::Cotangent];

    /// Whether every point has mass 1 unless told otherwise, because the paper prints the eigenproblem without a mass matrix (Lφ = λφ). The unit of the
    /// eigenvalues is then that of the weights, none, and they grow neither with the area nor as those of the surface: only their ratios compare.
    pub fn has_unit_mass(self) -> bool {
        matches!(self, Self::GeodesicLiteral | Self::Gaussian)
    }

    /// The name users write.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geodesic => "geodesic",
            Self::GeodesicLiteral => "geodesic-literal",
            Self::Euclidean => "euclidean",
            Self::Gaussian => "gaussian",
            Self::Cotangent => "cotangent",
        }
    }
}

impl fmt::Display for LaplacianKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for LaplacianKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|kind| kind.name()).collect();
            format!("\"{name}\" is not a Laplacian: choose one of {}", names.join(", "))
        })
    }
}

/// L (n, n): symmetric, positive semi-definite, rows summing to zero; and the lumped mass M (n).
///
/// −M⁻¹L approximates the Laplace–Beltrami operator in 1/unit², and the mass sums to the surface area, for every kind
/// but the two printed in the paper ([`LaplacianKind::has_unit_mass`]).
#[derive(Clone, Debug)]
pub struct Laplacian {
    /// How it was built.
    pub kind: LaplacianKind,
    /// L, both triangles and the diagonal stored, columns ascending.
    pub matrix: CsMat<f64>,
    /// Diagonal of M, in unit².
    pub mass: Vec<f64>,
}

impl Laplacian {
    /// L = D − W from weights `(i, j, w)` of undirected edges; several of one edge add up.
    pub fn from_weights(
        kind: LaplacianKind,
        mass: Vec<f64>,
        weights: impl IntoIterator<Item = (u32, u32, f64)>,
    ) -> Self {
        let n = mass.len();
        // Added up before they are entered, in one order, so that both triangles have the same bits.
        let edges = added_up(n, weights.into_iter().filter(|(i, j, _)| i != j));
        let mut degree = vec![0.0; n];
        let mut indptr = vec![0; n + 1];
        for &(i, j, w) in &edges {
            for end in [i as usize, j as usize] {
                degree[end] += w;
                indptr[end + 1] += 1;
            }
        }
        for i in 0..n {
            indptr[i + 1] += indptr[i] + 1;
        }
        let (mut columns, mut values) = (vec![0; indptr[n]], vec![0.0; indptr[n]]);
        let mut next = indptr.clone();
        let mut enter = |row: usize, column: usize, value: f64| {
            columns[next[row]] = column;
            values[next[row]] = value;
            next[row] += 1;
        };
        // Edges come in order of their lower end and then of their upper one, so every row is filled in order: left of
        // the diagonal, it, right of it.
        edges.iter().for_each(|&(i, j, w)| enter(j as usize, i as usize, -w));
        degree.iter().enumerate().for_each(|(i, &d)| enter(i, i, d));
        edges.iter().for_each(|&(i, j, w)| enter(i as usize, j as usize, -w));
        Self { kind, matrix: CsMat::new((n, n), indptr, columns, values), mass }
    }

    /// Whether every point has a weight to another one above 0.
    pub(super) fn ties_every_point(&self) -> bool {
        self.matrix.outer_iterator().enumerate().all(|(i, row)| row.get(i).is_some_and(|&degree| degree > 0.0))
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// True without points.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Total mass: the surface area in unit², for every kind without unit mass.
    pub fn area(&self) -> f64 {
        self.mass.iter().sum()
    }
}

/// Edges `(i, j, w)` with i < j in order, those of one pair added up in the order they come in.
fn added_up(n: usize, weights: impl Iterator<Item = (u32, u32, f64)>) -> Vec<(u32, u32, f64)> {
    let weights: Vec<(u32, u32, f64)> = weights.map(|(i, j, w)| (i.min(j), i.max(j), w)).collect();
    // As the edges of a graph come.
    if weights.is_sorted_by(|a, b| (a.0, a.1) < (b.0, b.1)) {
        return weights;
    }
    // Into rows by counting, so that only short rows are sorted.
    let mut start = vec![0; n + 1];
    weights.iter().for_each(|&(i, ..)| start[i as usize + 1] += 1);
    for i in 0..n {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut edges = vec![(0, 0, 0.0); weights.len()];
    for edge in weights {
        let at = &mut next[edge.0 as usize];
        edges[*at] = edge;
        *at += 1;
    }
    for row in start.windows(2) {
        edges[row[0]..row[1]].sort_by_key(|&(_, j, _)| j);
    }
    edges.dedup_by(|next, sum| {
        let same = (next.0, next.1) == (sum.0, sum.1);
        sum.2 += if same { next.2 } else { 0.0 };
        same
    });
    edges
}
