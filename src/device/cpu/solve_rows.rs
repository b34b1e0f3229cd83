//! Symmetric positive semi-definite systems: one, and many small ones that differ in their diagonal.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use ndarray::{Array2, ArrayView2};

/// Keeps directions that no descriptor sees and the mask allows at zero, above the rounding of a Gram matrix in f32; relative to its mean diagonal.
const RIDGE: f64 = 1e-6;

/// The kernel: [`solve_rows_wide`] on values in f32.
pub(crate) fn solve_rows(gram: ArrayView2<f32>, right: ArrayView2<f32>, mask: ArrayView2<f32>) -> Array2<f32> {
    let [gram, right, mask] = [gram, right, mask].map(|matrix| matrix.mapv(f64::from));
    solve_rows_wide(gram.view(), right.view(), mask.view(), RIDGE).mapv(|v| v as f32)
}

/// Row i of the result, x, solves (gram + diag mask_i) x = right_i, with `ridge` mean diagonals of the Gram matrix (k, k) on the diagonal besides. A row whose
/// system is not finite is NaN.
pub(crate) fn solve_rows_wide(
    gram: ArrayView2<f64>,
    right: ArrayView2<f64>,
    mask: ArrayView2<f64>,
    ridge: f64,
) -> Array2<f64> {
    let (m, k) = right.dim();
    let ridge = ridge * gram.diag().sum() / k.max(1) as f64;
    let mut out = Array2::from_elem((m, k), f64::NAN);
    for i in 0..m {
        let system = Mat::from_fn(k, k, |p, q| gram[(p, q)] + if p == q { mask[(i, p)] + ridge } else { 0.0 });
        let rhs = Mat::from_fn(k, 1, |p, _| right[(i, p)]);
        if let Some(row) = solve_symmetric(&system, &rhs) {
            (0..k).for_each(|p| out[(i, p)] = row[(p, 0)]);
        }
    }
    out
}

/// X of S X = R for a symmetric positive semi-definite S (k, k) and R (k, m), by Cholesky; where S is singular or rounding took its definiteness, the least X of
/// least squares by its eigenpairs. Nothing where S or R hold anything that is no finite number.
pub(crate) fn solve_symmetric(system: &Mat<f64>, right: &Mat<f64>) -> Option<Mat<f64>> {
    if !system.is_all_finite() || !right.is_all_finite() {
        return None;
    }
    if let Ok(cholesky) = system.llt(Side::Lower) {
        let solved = cholesky.solve(right);
        if solved.is_all_finite() {
            return Some(solved);
        }
    }
    let eigen = system.self_adjoint_eigen(Side::Lower).ok()?;
    let k = system.nrows();
    let value = |i: usize| eigen.S()[i];
    let least = k as f64 * f64::EPSILON * (0..k).map(value).fold(0.0, f64::max);
    let mut coefficients = eigen.U().transpose() * right;
    for i in 0..k {
        let inverse = if value(i) > least { 1.0 / value(i) } else { 0.0 };
        (0..coefficients.ncols()).for_each(|c| coefficients[(i, c)] *= inverse);
    }
    let solved = eigen.U() * &coefficients;
    solved.is_all_finite().then_some(solved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn a_system_that_is_not_positive_definite_is_solved_by_its_eigenpairs() {
        // Rank 1; and an eigenvalue that rounding made negative.
        for small in [0.0, -1e-17] {
            let system = Mat::from_fn(2, 2, |i, j| if (i, j) == (1, 1) { 1.0 + small } else { 1.0 });
            let solved = solve_symmetric(&system, &Mat::from_fn(2, 1, |_, _| 3.0)).expect("finite");
            assert!((0..2).all(|i| (solved[(i, 0)] - 1.5).abs() < 1e-6), "{solved:?}");
        }
        // As one of many, without a mask or a ridge.
        let gram = array![[1.0, 2.0], [2.0, 4.0]];
        let rows = solve_rows_wide(gram.view(), array![[1.0, 2.0]].view(), Array2::zeros((1, 2)).view(), 0.0);
        assert!((&rows - &array![[0.2, 0.4]]).iter().all(|d| d.abs() < 1e-9), "{rows}");
    }

    #[test]
    fn a_system_without_numbers_has_no_solution_rather_than_zeros() {
        let broken = Mat::from_fn(2, 2, |_, _| f64::NAN);
        assert!(solve_symmetric(&broken, &Mat::zeros(2, 1)).is_none());
        let (ones, nan) = (Array2::<f64>::ones((1, 2)), Array2::from_elem((2, 2), f64::NAN));
        assert!(solve_rows_wide(nan.view(), ones.view(), ones.view(), 0.0).iter().all(|v| v.is_nan()));
    }
}
