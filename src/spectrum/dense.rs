//! The whole spectrum of a small matrix, where an iteration would have no room.

use faer::{Mat, Side};
use sprs::CsMat;

/// The first `k` eigenpairs of M^−½LM^−½: eigenvalues ascending and orthonormal eigenvectors (n, k).
pub(super) fn smallest_eigenpairs(matrix: &CsMat<f64>, root_mass: &[f64], k: usize) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = root_mass.len();
    let mut dense = Mat::<f64>::zeros(n, n);
    for (i, row) in matrix.outer_iterator().enumerate() {
        for (j, &value) in row.iter() {
            dense[(i, j)] = value / (root_mass[i] * root_mass[j]);
        }
    }
    let eigen = dense.self_adjoint_eigen(Side::Lower).ok()?;
    let values = (0..k).map(|i| eigen.S()[i]).collect();
    Some((values, eigen.U().subcols(0, k).to_owned()))
}
