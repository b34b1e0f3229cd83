//! The first eigenfunctions of a Laplacian as a basis for functions on a shape.

use ndarray::{Array1, Array2, ArrayView2, Axis, s};

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
