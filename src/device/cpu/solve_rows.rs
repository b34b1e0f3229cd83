//! Many small positive definite systems that differ in their diagonal.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use ndarray::{Array2, ArrayView2};

/// Keeps directions that no descriptor sees and the mask allows at zero; relative to the mean diagonal of the Gram matrix.
const RIDGE: f64 = 1e-6;

/// In f64 inside. A row whose system is not positive definite (its Gram matrix holds NaN) is zero.
pub(crate) fn solve_rows(gram: ArrayView2<f32>, right: ArrayView2<f32>, mask: ArrayView2<f32>) -> Array2<f32> {
    let (m, k) = right.dim();
    let ridge = RIDGE * gram.diag().iter().map(|&v| f64::from(v)).sum::<f64>() / k.max(1) as f64;
    let mut out = Array2::zeros((m, k));
    for i in 0..m {
        let system = Mat::from_fn(k, k, |p, q| {
            let own = if p == q { f64::from(mask[(i, p)]) + ridge } else { 0.0 };
            f64::from(gram[(p, q)]) + own
        });
        let rhs = Mat::from_fn(k, 1, |p, _| f64::from(right[(i, p)]));
        if let Ok(cholesky) = system.llt(Side::Lower) {
            let row = cholesky.solve(&rhs);
            (0..k).for_each(|p| out[(i, p)] = row[(p, 0)] as f32);
        }
    }
    out
}
