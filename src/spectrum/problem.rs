//! The eigenproblem as it is solved: checked, without points that take no part, in a scale near 1.

use sprs::CsMat;

use super::SpectrumError;

/// Points that take part: all but those with neither mass nor entries.
pub(super) fn active_points(matrix: &CsMat<f64>, mass: &[f64]) -> Result<Vec<usize>, SpectrumError> {
    if matrix.rows() != mass.len() || matrix.cols() != mass.len() || !matrix.is_csr() {
        return Err(SpectrumError::InvalidMatrix {
            reason: format!("{} × {} for {} masses", matrix.rows(), matrix.cols(), mass.len()),
        });
    }
    check_entries(matrix)?;
    let mut active = Vec::with_capacity(mass.len());
    for (index, row) in matrix.outer_iterator().enumerate() {
        let empty = row.iter().all(|(_, &value)| value == 0.0);
        let mass = mass[index];
        match mass {
            m if m > 0.0 && m.is_finite() => active.push(index),
            0.0 if empty => {}
            _ => return Err(SpectrumError::InvalidMass { index, mass }),
        }
    }
    Ok(active)
}

/// Refuses entries that are not finite, and two of a pair that differ by more than rounding.
fn check_entries(matrix: &CsMat<f64>) -> Result<(), SpectrumError> {
    let invalid = |reason| Err(SpectrumError::InvalidMatrix { reason });
    if let Some((value, (i, j))) = matrix.iter().find(|(value, _)| !value.is_finite()) {
        return invalid(format!("entry ({i}, {j}) is {value}"));
    }
    let largest = matrix.data().iter().fold(0.0, |m: f64, value| m.max(value.abs()));
    let difference = matrix - &matrix.transpose_view().to_csr();
    match difference.iter().find(|(value, _)| value.abs() > 1e-9 * largest) {
        Some((value, (i, j))) => invalid(format!("entries ({i}, {j}) and ({j}, {i}) differ by {value:e}")),
        None => Ok(()),
    }
}

/// Powers of two that bring L, and the root of M, near 1, so that the unit of the scan meets no threshold on the way: with masses
/// of 1e-12 the dense eigensolver of the projected problem loses five digits. Division by them rounds nothing.
pub(super) fn scales(matrix: &CsMat<f64>, mass: &[f64]) -> (f64, f64) {
    let n = mass.len() as f64;
    let weight = matrix.diag_iter().map(|d| d.map_or(0.0, |d| d.abs())).sum::<f64>() / n;
    let root_mass = (mass.iter().sum::<f64>() / n).sqrt();
    // All bits but those of the exponent dropped; 0 and what overflowed stay as they are.
    let power = |x: f64| if x.is_normal() { f64::from_bits(x.to_bits() & f64::INFINITY.to_bits()) } else { 1.0 };
    (power(weight), power(root_mass))
}

/// Rows and columns of the active points, with every diagonal entry present.
pub(super) fn restrict(matrix: &CsMat<f64>, mass: &[f64], active: &[usize]) -> (CsMat<f64>, Vec<f64>) {
    let mut row_of = vec![usize::MAX; mass.len()];
    for (row, &i) in active.iter().enumerate() {
        row_of[i] = row;
    }
    let (mut indptr, mut indices, mut data) =
        (vec![0], Vec::with_capacity(matrix.nnz()), Vec::with_capacity(matrix.nnz()));
    for (row, &i) in active.iter().enumerate() {
        let mut diagonal = false;
        if let Some(entries) = matrix.outer_view(i) {
            for (j, &value) in entries.iter().filter(|&(j, _)| row_of[j] != usize::MAX) {
                if !diagonal && row_of[j] >= row {
                    diagonal = true;
                    if row_of[j] > row {
                        indices.push(row);
                        data.push(0.0);
                    }
                }
                indices.push(row_of[j]);
                data.push(value);
            }
        }
        if !diagonal {
            indices.push(row);
            data.push(0.0);
        }
        indptr.push(indices.len());
    }
    let size = active.len();
    (CsMat::new((size, size), indptr, indices, data), active.iter().map(|&i| mass[i]).collect())
}
