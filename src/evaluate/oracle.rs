//! The best that two bases can do: the functional map of the true match itself. It judges bases, independent of any
//! feature.

use faer::linalg::solvers::SvdError;
use faer::{Mat, MatRef};
use ndarray::ArrayView2;

/// Rows of A compared at a time, so that distances stay in cache.
const TILE: usize = 256;

/// The match A → B by the map M that solves Φ_B\[v_B\]·M ≈ Φ_A\[v_A\], unweighted least squares over all `lines` (v_A,
/// v_B): to point i of A belongs the row of Φ_B·M nearest to row i of Φ_A. Φ_A (n_a, k_a) and Φ_B (n_b, k_b) are at all
/// points.
///
/// In f64, and of the smallest norm where the lines leave M open, as when only a piece of B is named.
pub(super) fn oracle(
    phi_a: ArrayView2<f64>,
    phi_b: ArrayView2<f64>,
    lines: &[(u32, u32)],
) -> Result<Vec<u32>, SvdError> {
    let at_a = Mat::from_fn(lines.len(), phi_a.ncols(), |line, j| phi_a[(lines[line].0 as usize, j)]);
    let at_b = Mat::from_fn(lines.len(), phi_b.ncols(), |line, j| phi_b[(lines[line].1 as usize, j)]);
    let m = at_b.thin_svd()?.pseudoinverse() * at_a;
    let whole = |phi: ArrayView2<f64>| Mat::from_fn(phi.nrows(), phi.ncols(), |i, j| phi[(i, j)]);
    Ok(nearest_rows(whole(phi_a).as_ref(), (whole(phi_b) * m).as_ref()))
}

/// For each row of `x` (n, d) the nearest row of `y` (m, d); ties go to the lower index.
fn nearest_rows(x: MatRef<f64>, y: MatRef<f64>) -> Vec<u32> {
    let squares: Vec<f64> = (0..y.nrows()).map(|j| y.row(j).squared_norm_l2()).collect();
    let mut nearest = Vec::with_capacity(x.nrows());
    for first in (0..x.nrows()).step_by(TILE) {
        // A column per row of x.
        let products = y * x.subrows(first, TILE.min(x.nrows() - first)).transpose();
        for column in products.col_iter() {
            // ‖x − y‖² without ‖x‖², which is the same for all.
            let distance = |j: usize| squares[j] - 2.0 * column[j];
            let best = (1..y.nrows()).fold((distance(0), 0), |best, j| match distance(j) {
                d if d < best.0 => (d, j),
                _ => best,
            });
            nearest.push(best.1 as u32);
        }
    }
    nearest
}
