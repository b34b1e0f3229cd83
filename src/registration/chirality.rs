//! Whether a map keeps the surface's outside out: the one thing that tells left from right on a symmetric body.
//!
//! Spectra cannot tell a body from its mirror image, so a map may exchange left and right and still be smooth. Such a map turns the surface inside out. Seen
//! from outside, going round a point must go round its image in the same sense.

use faer::{Mat, Side};
use ndarray::{Array2, ArrayView2};

use crate::vector::{cross, dot};

/// Neighbourhood that a tangent plane is fitted to, in √area: half a forearm's width.
const NEAR: f64 = 0.06;
/// Neighbourhood whose centre of mass lies inside the body.
const WIDE: f64 = 0.12;

/// Unit normals (rows, 3) that point away from the middle of their neighbourhood, at `rows` of `points` (n, 3), both centred and at unit area.
/// Right on nearly all of a body; good for a vote, not for each single point.
pub(super) fn outward_normals(points: ArrayView2<f64>, rows: ArrayView2<f64>) -> Array2<f64> {
    let mut normals = Array2::zeros(rows.dim());
    for (row, mut normal) in rows.rows().into_iter().zip(normals.rows_mut()) {
        let mut wide = [0.0; 3];
        let mut near: Vec<[f64; 3]> = Vec::new();
        for point in points.rows() {
            let offset: [f64; 3] = std::array::from_fn(|c| point[c] - row[c]);
            let squared = dot(offset, offset);
            if squared < WIDE * WIDE {
                (0..3).for_each(|c| wide[c] += offset[c]);
                if squared < NEAR * NEAR {
                    near.push(offset);
                }
            }
        }
        let thinnest = thinnest_direction(&near);
        let sign = if dot(thinnest, wide) > 0.0 { -1.0 } else { 1.0 };
        (0..3).for_each(|c| normal[c] = sign * thinnest[c]);
    }
    normals
}

fn thinnest_direction(offsets: &[[f64; 3]]) -> [f64; 3] {
    let count = offsets.len().max(1) as f64;
    let mean: [f64; 3] = std::array::from_fn(|c| offsets.iter().map(|o| o[c]).sum::<f64>() / count);
    let covariance =
        Mat::from_fn(3, 3, |i, j| offsets.iter().map(|o| (o[i] - mean[i]) * (o[j] - mean[j])).sum::<f64>());
    covariance.self_adjoint_eigen(Side::Lower).map_or([0.0; 3], |eigen| std::array::from_fn(|i| eigen.U()[(i, 0)]))
}

/// From −1 (every point turned inside out) to 1 (none): the map takes `from` (rows, 3) to `images` (rows, 3), smooth positions on the other body, where the normals
/// are `image_normals`.
pub(super) fn chirality(
    from: ArrayView2<f64>,
    normals: ArrayView2<f64>,
    images: ArrayView2<f64>,
    image_normals: ArrayView2<f64>,
) -> f64 {
    let at = |table: ArrayView2<f64>, i: usize| -> [f64; 3] { std::array::from_fn(|c| table[(i, c)]) };
    let n = from.nrows();
    let mut balance = 0i64;
    for i in 0..n {
        let (x, y) = (at(from, i), at(images, i));
        let mut differential = [[0.0; 3]; 3];
        for j in 0..n {
            let d: [f64; 3] = std::array::from_fn(|c| from[(j, c)] - x[c]);
            if dot(d, d) < WIDE * WIDE {
                for (p, row) in differential.iter_mut().enumerate() {
                    (0..3).for_each(|q| row[q] += (images[(j, p)] - y[p]) * d[q]);
                }
            }
        }
        // The differential maps tangents to tangents; sending the normal to the normal completes it to three dimensions.
        let size = differential.iter().map(|row| dot(*row, *row)).sum::<f64>().sqrt();
        let (normal, image_normal) = (at(normals, i), at(image_normals, i));
        for (row, p) in differential.iter_mut().zip(image_normal) {
            // What the patch's curvature left along the normal is projected out first.
            let along = dot(*row, normal);
            (0..3).for_each(|q| row[q] += (size * p - along) * normal[q]);
        }
        balance += match dot(differential[0], cross(differential[1], differential[2])) {
            d if d > 0.0 => 1,
            d if d < 0.0 => -1,
            _ => 0,
        };
    }
    balance as f64 / n.max(1) as f64
}
