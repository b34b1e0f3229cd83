//! The masked functional-map solve (paper Sec. 3.3, "FM solver").

use faer::Mat;
use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::device::{Device, solve_rows_wide, solve_symmetric};
use crate::network::Solver;

/// C_ab: coefficients on A → coefficients on B. Shape (k_b, k_a).
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionalMap {
    /// The matrix C_ab (k_b, k_a).
    pub matrix: Array2<f64>,
}

/// Keeps directions that no descriptor sees and the mask allows at zero.
const RIDGE: f64 = 1e-9;

impl FunctionalMap {
    /// C_ab from descriptors: min ‖C G_a − G_b‖² + Σ mask_ij C_ij², the descriptors scaled so that the Gram matrix has mean diagonal 1.
    ///
    /// `g_a` (k_a, c) and `g_b` (k_b, c) are the same descriptors projected on each basis, `lambda_a` and `lambda_b` the eigenvalues at unit area.
    /// The paper solves without a mask, which lets the map couple frequencies that no near-isometry couples; the mask is the
    /// resolvent one of Ren et al. 2019 ("Structured regularization of functional map computations"), γ = ½. Each row of C is a
    /// solve of its own; where the descriptors hold anything that is no finite number, so does the map.
    pub fn solve(
        g_a: ArrayView2<f64>,
        g_b: ArrayView2<f64>,
        lambda_a: ArrayView1<f64>,
        lambda_b: ArrayView1<f64>,
    ) -> Self {
        Self::penalised(g_a, g_b, resolvent_mask(lambda_a, lambda_b))
    }

    /// C_ab from descriptors as printed (paper Sec. 3.3): min ‖C G_a − G_b‖², and of what no descriptor sees nothing. Arguments as for [`Self::solve`].
    pub fn least_squares(g_a: ArrayView2<f64>, g_b: ArrayView2<f64>) -> Self {
        Self::penalised(g_a, g_b, Array2::zeros((g_b.nrows(), g_a.nrows())))
    }

    fn penalised(g_a: ArrayView2<f64>, g_b: ArrayView2<f64>, mask: Array2<f64>) -> Self {
        let gram = g_a.dot(&g_a.t());
        let scale = gram.diag().sum() / g_a.nrows() as f64;
        let scale = if scale > 0.0 { scale } else { 1.0 };
        let right = g_b.dot(&g_a.t());
        Self { matrix: solve_rows_wide((gram / scale).view(), (right / scale).view(), mask.view(), RIDGE) }
    }
}

/// C_ab and C_ba on a device, from descriptors `g` projected on the bases of A and B (k, c) that come from features of unit length at unit area: their Gram
/// matrix has trace 1, or a little less, so that k times it has mean diagonal 1. `lambda` are the eigenvalues by Weyl's law, λ_j ≈ 4πj. The same in training
/// and in matching. Least squares keep a ridge of 1e-6 mean diagonals, above the rounding of a Gram matrix in f32.
pub fn functional_maps<D: Device>(
    device: &D,
    [g_a, g_b]: [&D::Tensor; 2],
    lambda: [&[f64]; 2],
    solve: Solver,
) -> [D::Tensor; 2] {
    let map = |from: &D::Tensor, to: &D::Tensor, lambda_from: &[f64], lambda_to: &[f64]| {
        let scaled = device.concat(&[(from, lambda_from.len() as f32)]);
        let mask = match solve {
            Solver::Masked => resolvent_mask(ArrayView1::from(lambda_from), ArrayView1::from(lambda_to)),
            Solver::LeastSquares => Array2::zeros((lambda_to.len(), lambda_from.len())),
        };
        let mask = device.upload(mask.mapv(|v| v as f32).view());
        device.solve_rows(&device.matmul_nt(from, &scaled), &device.matmul_nt(to, &scaled), &mask)
    };
    [map(g_a, g_b, lambda[0], lambda[1]), map(g_b, g_a, lambda[1], lambda[0])]
}

/// Distance between the resolvents of two operators, entry by entry: small near the (slanted) diagonal. Shape (k_b, k_a).
pub fn resolvent_mask(lambda_a: ArrayView1<f64>, lambda_b: ArrayView1<f64>) -> Array2<f64> {
    let largest = lambda_a.iter().chain(lambda_b.iter()).copied().fold(f64::MIN_POSITIVE, f64::max);
    // (λ^γ − i)⁻¹ with γ = ½, so λ^2γ = λ.
    let resolvent = |lambda: &f64| {
        let x = lambda / largest;
        [x.sqrt() / (1.0 + x), 1.0 / (1.0 + x)]
    };
    let (a, b): (Vec<_>, Vec<_>) = (lambda_a.iter().map(resolvent).collect(), lambda_b.iter().map(resolvent).collect());
    let mask =
        Array2::from_shape_fn((b.len(), a.len()), |(i, j)| (b[i][0] - a[j][0]).powi(2) + (b[i][1] - a[j][1]).powi(2));
    let norm = mask.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    mask / norm
}

/// min ‖P X − Q‖² by the normal equations: P (n, k), Q (n, m) given as PᵀP (k, k) and PᵀQ (k, m); X (k, m).
///
/// With rows at a sampling of the points this is the least-squares form of ΦᵀMf. NaN where P or Q are not finite.
pub(super) fn least_squares(gram: ArrayView2<f32>, right: ArrayView2<f32>) -> Array2<f64> {
    let (k, m) = right.dim();
    let ridge = 1e-7 * (0..k).map(|i| f64::from(gram[(i, i)])).sum::<f64>() / k.max(1) as f64;
    let system = Mat::from_fn(k, k, |i, j| f64::from(gram[(i, j)]) + if i == j { ridge } else { 0.0 });
    let rhs = Mat::from_fn(k, m, |i, j| f64::from(right[(i, j)]));
    match solve_symmetric(&system, &rhs) {
        Some(x) => Array2::from_shape_fn((k, m), |(i, j)| x[(i, j)]),
        None => Array2::from_elem((k, m), f64::NAN),
    }
}

/// Least squares for functions (rows, m) that are known only roughly: sums of the columns of Φ (rows, k) that agree with them, each row counting by its weight, while column j costs `stiffness(j)` times its
/// coefficient's square. Rows of weight 0 get what those around them have.
pub(crate) fn smoothed_where(
    phi: ArrayView2<f32>,
    functions: ArrayView2<f64>,
    weights: &[f64],
    stiffness: impl Fn(usize) -> f64,
) -> Array2<f64> {
    let weights = ndarray::ArrayView1::from(weights).insert_axis(ndarray::Axis(1));
    let phi = phi.mapv(f64::from);
    let weighed = &phi * &weights;
    let mut gram = weighed.t().dot(&phi);
    gram.diag_mut().iter_mut().enumerate().for_each(|(j, diagonal)| *diagonal += stiffness(j));
    let right = weighed.t().dot(&functions);
    phi.dot(&least_squares(gram.mapv(|v| v as f32).view(), right.mapv(|v| v as f32).view()))
}

/// Functions (rows, m) as seen through the columns of Φ (rows, k).
pub(crate) fn smoothed(phi: ArrayView2<f32>, functions: ArrayView2<f64>) -> Array2<f64> {
    let functions = functions.mapv(|v| v as f32);
    let coefficients = least_squares(phi.t().dot(&phi).view(), phi.t().dot(&functions).view());
    phi.mapv(f64::from).dot(&coefficients)
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::{smoothed, smoothed_where};

    #[test]
    fn what_nothing_is_known_of_follows_what_is_around() {
        // Cosines on a line of 100 points, and a height that is known of the first half alone.
        let phi = Array2::from_shape_fn((100, 6), |(i, j)| {
            (std::f32::consts::PI * j as f32 * (i as f32 + 0.5) / 100.0).cos()
        });
        let height = |i: usize| 1.0 + 0.5 * (std::f64::consts::PI * (i as f64 + 0.5) / 100.0).cos();
        let known = |i: usize| i < 50;
        let targets = Array2::from_shape_fn((100, 1), |(i, _)| if known(i) { height(i) } else { 90.0 });
        let weights: Vec<f64> = (0..100).map(|i| if known(i) { 1.0 } else { 0.0 }).collect();
        let found = smoothed_where(phi.view(), targets.view(), &weights, |j| 1e-3 * (j * j) as f64);
        let off = |rows: std::ops::Range<usize>| rows.map(|i| (found[(i, 0)] - height(i)).abs()).fold(0.0, f64::max);
        assert!(off(0..50) < 0.05 && off(50..100) < 0.5, "{} {}", off(0..50), off(50..100));
        // All alike, it is a projection.
        let all = smoothed_where(phi.view(), targets.view(), &[1.0; 100], |_| 0.0);
        assert!((&all - &smoothed(phi.view(), targets.view())).iter().all(|d| d.abs() < 1e-2));
    }
}
