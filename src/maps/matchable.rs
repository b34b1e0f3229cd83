//! One side of a pair, as the matching steps see it.

use std::sync::Arc;

use ndarray::{Array2, ArrayView1, s};

use crate::descriptors::SampledSurface;
use crate::network::{Category, PointEmbedding};
use crate::spectrum::SpectralBasis;

/// A shape at unit area, ready to be matched: p points used.
#[derive(Clone, Debug)]
pub struct Matchable {
    /// Basis at unit area: Σ mass = 1.
    pub basis: SpectralBasis,
    /// Positions (p, 3), centred, in units of √area.
    pub points: Array2<f64>,
    /// Descriptors (p, c) that do not depend on the pose in space.
    pub features: Array2<f32>,
    /// What a network says of how far each point can be trusted, where one was asked.
    pub learned: Option<LearnedCues>,
    /// Rows of an even sampling, coarsest first: every prefix is a sampling too.
    pub coarse: Vec<u32>,
    /// The surface around that sampling.
    pub surface: SampledSurface,
    /// The share of the body's surface that is there, 1 of a whole body: lengths are in √area of that.
    pub share: f64,
}

/// Cues of confidence that a network gives; p points.
#[derive(Clone, Debug)]
pub struct LearnedCues {
    /// How unsure it is of each point's part: 1 less the probability of the likeliest (p).
    pub unsure: Vec<f32>,
    /// What it says of each point, of unit length (p, f).
    pub features: Arc<Array2<f32>>,
    /// Probability of each group of parts that is a cue of its category (p, g).
    pub limbs: Array2<f64>,
    /// How far the place of a point on the body speaks for its match (p, 2), in log-odds beside other cues: between meshes, and where one is a cloud.
    pub prior: Option<Array2<f32>>,
    /// The category, which has the coefficients of these cues.
    pub category: Arc<Category>,
}

impl LearnedCues {
    /// From probabilities of parts.
    pub fn new(embedding: &PointEmbedding, prior: Option<Array2<f32>>) -> Self {
        let category = embedding.category.clone();
        let mut limbs = Array2::zeros((embedding.parts.nrows(), category.cues.len()));
        for (mut column, parts) in limbs.columns_mut().into_iter().zip(&category.cues) {
            for &part in parts {
                column.zip_mut_with(&embedding.parts.column(part), |sum, &p| *sum += f64::from(p));
            }
        }
        let likeliest = |row: ArrayView1<f32>| row.iter().copied().fold(0.0, f32::max);
        let unsure = embedding.parts.rows().into_iter().map(|row| 1.0 - likeliest(row)).collect();
        let mut features = embedding.features.clone();
        for mut row in features.rows_mut() {
            let length = row.dot(&row).sqrt().max(f32::MIN_POSITIVE);
            row /= length;
        }
        Self { unsure, features: Arc::new(features), limbs, prior, category }
    }

    /// How differently the network speaks of point `i` here and point `j` of another body: the distance of their unit features, 0 to 2.
    pub(crate) fn difference(&self, i: usize, other: &Self, j: usize) -> f64 {
        let (x, y) = (self.features.row(i), other.features.row(j));
        x.iter().zip(y).map(|(x, y)| f64::from(x - y).powi(2)).sum::<f64>().sqrt()
    }
}

impl Matchable {
    /// Points used, p.
    pub fn len(&self) -> usize {
        self.points.nrows()
    }

    /// Whether all that describes it are numbers.
    pub(crate) fn is_finite(&self) -> bool {
        let basis = &self.basis;
        let wide = basis.eigenvalues.iter().chain(&basis.mass).chain(&basis.eigenvectors).chain(&self.points);
        let normals = self.surface.normals.as_flattened();
        let prior = self.learned.iter().flat_map(|learned| learned.prior.iter().flatten());
        let single = self.features.iter().chain(prior);
        wide.chain(normals).all(|v| v.is_finite()) && single.into_iter().all(|v| v.is_finite())
    }

    /// True without points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The first `k` eigenfunctions as f32: (p, k).
    pub(crate) fn phi(&self, k: usize) -> Array2<f32> {
        self.basis.eigenvectors.slice(s![.., ..k]).mapv(|v| v as f32)
    }

    /// Φ at the given rows, first `k` columns, as f32: (rows, k).
    pub(crate) fn phi_at(&self, rows: &[u32], k: usize) -> Array2<f32> {
        let mut phi = Array2::zeros((rows.len(), k));
        for (mut out, &i) in phi.rows_mut().into_iter().zip(rows) {
            out.zip_mut_with(&self.basis.eigenvectors.slice(s![i as usize, ..k]), |o, &v| *o = v as f32);
        }
        phi
    }
}
