//! Pairs of points that a user knows to correspond, as descriptors.

use ndarray::Array2;

use crate::spectrum::SpectralBasis;

/// Diffusion times at unit area: a hand and a torso wide.
const TIMES: [f64; 2] = [0.003, 0.02];

/// Heat spread from each landmark row, one column per landmark and time, each of unit norm. Shape (k, 2·landmarks), coefficients in `basis`.
pub fn landmark_functions(basis: &SpectralBasis, rows: &[u32]) -> Array2<f64> {
    let mut coefficients = Array2::zeros((basis.k(), TIMES.len() * rows.len()));
    for (l, &row) in rows.iter().enumerate() {
        for (t, &time) in TIMES.iter().enumerate() {
            let mut column = coefficients.column_mut(l * TIMES.len() + t);
            for j in 0..basis.k() {
                column[j] = (-time * basis.eigenvalues[j]).exp() * basis.eigenvectors[(row as usize, j)];
            }
            let norm = column.dot(&column).sqrt().max(f64::MIN_POSITIVE);
            column /= norm;
        }
    }
    coefficients
}
