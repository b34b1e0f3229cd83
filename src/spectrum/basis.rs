//! The first eigenfunctions of a Laplacian as a basis for functions on a shape.

use ndarray::{Array1, Array2, ArrayView2, Axis, s};

/// Eigenvalues whose mean λ_j/4πj says how an operator scales.
const WEYL: std::ops::Range<usize> = 16..64;

/// Φ (n, k) with ΦᵀMΦ = I, eigenvalues λ (k) ascending in 1/unit², and the mass M (n) in unit².
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralBasis {
    /// λ (k), ascending.
    pub eigenvalues: Array1<f64>,
    /// Φ (n, k): one eigenfunction per column.
    pub eigenvectors: Array2<f64>,
    /// Diagonal of M (n).
    pub mass: Array1<f64>,
}

impl SpectralBasis {
    /// Number of points n.
    pub fn len(&self) -> usize {
        self.eigenvectors.nrows()
    }

    /// True without points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of eigenpairs k.
    pub fn k(&self) -> usize {
        self.eigenvectors.ncols()
    }

    /// The first k pairs only.
    pub fn truncated(&self, k: usize) -> Self {
        Self {
            eigenvalues: self.eigenvalues.slice(s![..k]).to_owned(),
            eigenvectors: self.eigenvectors.slice(s![.., ..k]).to_owned(),
            mass: self.mass.clone(),
        }
    }

    /// Mean of λ_j/4πj, by Weyl's law 1 for a smooth closed surface of unit area. What an operator on a cloud gets wrong in scale shows here; eigenvalues of two
    /// shapes are compared after each is divided by its own.
    pub(crate) fn weyl_factor(&self) -> f64 {
        let range = WEYL.start.min(self.k() / 2)..WEYL.end.min(self.k());
        let ratios: Vec<f64> =
            range.map(|j| self.eigenvalues[j] / (4.0 * std::f64::consts::PI * j.max(1) as f64)).collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
        if mean > 0.0 && mean.is_finite() { mean } else { 1.0 }
    }

    /// Coefficients of point functions: ΦᵀMf. Shapes: (n, c) → (k, c). Mass-weighted, so that projecting a
    /// reconstruction gives the coefficients back.
    pub fn project(&self, functions: ArrayView2<f64>) -> Array2<f64> {
        let weighted = &functions * &self.mass.view().insert_axis(Axis(1));
        self.eigenvectors.t().dot(&weighted)
    }

    /// Point functions from coefficients: Φx. Shapes: (k, c) → (n, c).
    pub fn reconstruct(&self, coefficients: ArrayView2<f64>) -> Array2<f64> {
        self.eigenvectors.dot(&coefficients)
    }
}
