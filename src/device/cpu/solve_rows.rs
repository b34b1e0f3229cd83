//! Many small positive definite systems that differ in their diagonal.

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
/// system is not positive definite (its Gram matrix holds NaN) is zero.
pub(crate) fn solve_rows_wide(
    gram: ArrayView2<f64>,
    right: ArrayView2<f64>,
    mask: ArrayView2<f64>,
    ridge: f64,
) -> Array2<f64> {
    let (m, k) = right.dim();
    let ridge = ridge * gram.diag().sum() / k.max(1) as f64;
    let mut out = Array2::zeros((m, k));
    for i in 0..m {
        let system = Mat::from_fn(k, k, |p, q| gram[(p, q)] + if p == q { mask[(i, p)] + ridge } else { 0.0 });
        let rhs = Mat::from_fn(k, 1, |p, _| right[(i, p)]);
        if let Ok(cholesky) = system.llt(Side::Lower) {
            let row = cholesky.solve(&rhs);
            (0..k).for_each(|p| out[(i, p)] = row[(p, 0)]);
        }
    }
    out
}
