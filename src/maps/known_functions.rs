//! What a user knows to correspond, pairs of points and parts, as descriptors.

use std::collections::{BTreeMap, BTreeSet};

use ndarray::Array2;

use crate::spectrum::SpectralBasis;

/// Diffusion times at unit area: a hand and a torso wide.
const TIMES: [f64; 2] = [0.003, 0.02];

/// Weight of each landmark against all invariant descriptors together, which weigh 1: one or two pairs can turn a body round.
const LANDMARK_WEIGHT: f64 = 2.0;

/// Heat spread from each landmark row, one column per landmark and time, of norm 2. Shape (k, 2·landmarks), coefficients in
/// `basis`.
pub fn landmark_functions(basis: &SpectralBasis, rows: &[u32]) -> Array2<f64> {
    let mut coefficients = Array2::zeros((basis.k(), TIMES.len() * rows.len()));
    for (l, &row) in rows.iter().enumerate() {
        for (t, &time) in TIMES.iter().enumerate() {
            let mut column = coefficients.column_mut(l * TIMES.len() + t);
            for j in 0..basis.k() {
                column[j] = (-time * basis.eigenvalues[j]).exp() * basis.eigenvectors[(row as usize, j)];
            }
            let norm = column.dot(&column).sqrt().max(f64::MIN_POSITIVE);
            column *= LANDMARK_WEIGHT / norm;
        }
    }
    coefficients
}

/// Weight of all part indicators together, against the invariant descriptors' 1 together.
const PARTS_WEIGHT: f64 = 2.0;

/// Indicator functions of the parts `shared`, one column per part, all together of norm 2. `labels` (n) are those of the shape's
/// points. Shape (k, parts), coefficients in `basis`.
pub fn part_functions(basis: &SpectralBasis, labels: &[u32], shared: &BTreeSet<u32>) -> Array2<f64> {
    let column_of: BTreeMap<u32, usize> = shared.iter().enumerate().map(|(column, &part)| (part, column)).collect();
    let mut coefficients = Array2::zeros((basis.k(), shared.len()));
    let mut masses = vec![0.0; shared.len()];
    for ((label, &mass), row) in labels.iter().zip(&basis.mass).zip(basis.eigenvectors.rows()) {
        if let Some(&column) = column_of.get(label) {
            coefficients.column_mut(column).scaled_add(mass, &row);
            masses[column] += mass;
        }
    }
    let weight = PARTS_WEIGHT / (shared.len().max(1) as f64).sqrt();
    for (mut column, mass) in coefficients.columns_mut().into_iter().zip(masses) {
        column *= weight / mass.max(f64::MIN_POSITIVE).sqrt();
    }
    coefficients
}
