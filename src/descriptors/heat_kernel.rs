//! The heat kernel signature (Sun, Ovsjanikov & Guibas 2009): how much heat stays where it was put.

use ndarray::{Array2, Axis};

use crate::spectrum::SpectralBasis;

/// k_t(x, x) = Σ exp(−λ_i t) φ_i(x)², each time divided by its mean over the surface, minus 1. Shape (n, times); `times` in unit².
pub fn heat_kernel_signature(basis: &SpectralBasis, times: &[f64]) -> Array2<f32> {
    let decay =
        Array2::from_shape_fn((basis.k(), times.len()), |(i, t)| (-basis.eigenvalues[i].max(0.0) * times[t]).exp());
    let squares = basis.eigenvectors.mapv(|phi| phi * phi);
    let mut signature = squares.dot(&decay);
    let area: f64 = basis.mass.sum();
    for mut column in signature.axis_iter_mut(Axis(1)) {
        let mean = column.iter().zip(&basis.mass).map(|(v, m)| v * m).sum::<f64>() / area;
        if mean > 0.0 {
            column.mapv_inplace(|v| v / mean - 1.0);
        }
    }
    signature.mapv(|v| v as f32)
}
