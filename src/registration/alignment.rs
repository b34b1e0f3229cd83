//! Rotations between bodies: principal axes to start from, least squares once a map is known. No reflections, ever:
//! a mirrored body must not match as itself.

use faer::{Mat, MatRef, Side};
use ndarray::{Array2, ArrayView2};

use crate::vector::{cross, dot};

/// A proper rotation: x ↦ R x.
pub(crate) type Rotation = [[f64; 3]; 3];

/// Principal axes of a body as rows, longest first, right-handed. `points` (n, 3) are centred, `mass` (n) weighs them.
pub(super) fn principal_axes(points: ArrayView2<f64>, mass: impl Iterator<Item = f64>) -> Rotation {
    let mut covariance = Mat::<f64>::zeros(3, 3);
    for (p, m) in points.rows().into_iter().zip(mass) {
        for i in 0..3 {
            for j in 0..3 {
                covariance[(i, j)] += m * p[i] * p[j];
            }
        }
    }
    let Ok(eigen) = covariance.self_adjoint_eigen(Side::Lower) else {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    };
    let axis = |j: usize| -> [f64; 3] { std::array::from_fn(|i| eigen.U()[(i, j)]) };
    let (first, second) = (axis(2), axis(1));
    [first, second, cross(first, second)]
}

/// The 24 ways to lay a right-handed frame of axes onto another: signed permutations with determinant 1.
pub(super) fn axis_rotations() -> Vec<Rotation> {
    let mut rotations = Vec::with_capacity(24);
    for permutation in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for signs in 0..8u8 {
            let mut r = [[0.0; 3]; 3];
            for (row, &column) in permutation.iter().enumerate() {
                r[row][column] = if signs >> row & 1 == 0 { 1.0 } else { -1.0 };
            }
            if dot(r[0], cross(r[1], r[2])) > 0.0 {
                rotations.push(r);
            }
        }
    }
    rotations
}

/// The rotation that brings the rows of `from` nearest to those of `to` (n, 3), after centring both, and the root mean square
/// distance that is left (Kabsch 1976).
pub(super) fn best_rotation(from: ArrayView2<f64>, to: ArrayView2<f64>) -> (Rotation, f64) {
    let (rotation, residual, _) = best_rotation_and_certainty(from, to);
    (rotation, residual)
}

/// [`best_rotation`], and how well it is determined, from 0 to 2: 0 where points on a line, or a patch and its mirror image, leave a turn open.
pub(crate) fn best_rotation_and_certainty(from: ArrayView2<f64>, to: ArrayView2<f64>) -> (Rotation, f64, f64) {
    let n = from.nrows().max(1) as f64;
    let mean = |x: ArrayView2<f64>| -> [f64; 3] { std::array::from_fn(|c| x.column(c).sum() / n) };
    let (mean_from, mean_to) = (mean(from), mean(to));
    let mut correlation = Mat::<f64>::zeros(3, 3);
    let mut total = 0.0;
    for (p, q) in from.rows().into_iter().zip(to.rows()) {
        let p: [f64; 3] = std::array::from_fn(|c| p[c] - mean_from[c]);
        let q: [f64; 3] = std::array::from_fn(|c| q[c] - mean_to[c]);
        total += dot(p, p) + dot(q, q);
        for i in 0..3 {
            for j in 0..3 {
                correlation[(i, j)] += q[i] * p[j];
            }
        }
    }
    let Ok(svd) = correlation.svd() else {
        return ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], (total / n).sqrt(), 0.0);
    };
    let (u, v) = (svd.U(), svd.V());
    // With a reflection as the best orthogonal matrix, the least important axis turns round.
    let handedness = (determinant(u) * determinant(v)).signum();
    let rotation: Rotation = std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).map(|c| u[(i, c)] * v[(j, c)] * if c == 2 { handedness } else { 1.0 }).sum())
    });
    let aligned = svd.S()[0] + svd.S()[1] + handedness * svd.S()[2];
    let certainty = (svd.S()[1] + handedness * svd.S()[2]) / svd.S()[0].max(f64::MIN_POSITIVE);
    (rotation, ((total - 2.0 * aligned).max(0.0) / n).sqrt(), certainty)
}

/// Every row rotated: (n, 3) → (n, 3).
pub(super) fn rotate(points: ArrayView2<f64>, r: &Rotation) -> Array2<f64> {
    let matrix = Array2::from_shape_fn((3, 3), |(i, j)| r[j][i]);
    points.dot(&matrix)
}

/// One point rotated.
pub(crate) fn turned(r: &Rotation, point: [f64; 3]) -> [f64; 3] {
    r.map(|row| dot(row, point))
}

/// r s: first s, then r.
pub(super) fn compose(r: &Rotation, s: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|c| r[i][c] * s[c][j]).sum()))
}

/// The inverse rotation.
pub(super) fn inverse(r: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| r[j][i]))
}

fn determinant(m: MatRef<'_, f64>) -> f64 {
    let row = |i: usize| -> [f64; 3] { std::array::from_fn(|j| m[(i, j)]) };
    dot(row(0), cross(row(1), row(2)))
}
