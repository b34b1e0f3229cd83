//! Which way the surface faces at each point.

use faer::{Mat, Side};

use super::neighbourhood::Neighbourhood;
use crate::shape::Shape;
use crate::vector::{cross, dot, minus, norm, plus};

/// Where the normals of the faces around a vertex cancel to less than this share, windings contradict each other and
/// only the line that the normals lie on is taken from them.
const CANCELLED: f64 = 0.05;
/// A face with less than this part of its longest side squared as area has no direction beyond rounding.
pub(super) const LEAST_AREA: f64 = 1e-8;

/// Normals taken where nothing says otherwise.
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Unit normals (n, 3). Of a mesh they point to the side from which its faces run counter-clockwise, which is out where
/// the scan is wound as usual; of a cloud either way: those of surfaces fitted to the neighbours, which follow
/// one of two sheets that touch where principal components mix them. Where nothing is known (points without faces, points
/// that only have copies of themselves around them), +z or any other direction.
///
/// Of points in one place, all have the normal of the faces that meet there.
pub fn normals(shape: &Shape) -> Vec<[f64; 3]> {
    if shape.faces().is_empty() {
        return Neighbourhood::of(shape.points()).normals();
    }
    let at_first = mesh_normals(shape.points(), &shape.welded_faces());
    shape.first_at_place().iter().map(|&first| at_first[first as usize]).collect()
}

/// Normals (n, 3) of a mesh from the winding of its faces, each face counting with its angle at the vertex, so that how
/// a flat piece is cut into triangles does not matter (Thürmer & Wüthrich 1998). Where windings contradict each other
/// the sign means nothing.
pub(super) fn mesh_normals(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Vec<[f64; 3]> {
    let n = points.len();
    let mut sum = vec![[0.0; 3]; n];
    let mut angles = vec![0.0; n];
    let corners = || {
        faces.iter().filter_map(|face| Some((face, unit_normal(face.map(|i| points[i as usize]))?))).flat_map(
            |(face, normal)| {
                (0..3).map(move |s| {
                    let [at, next, last] = [0, 1, 2].map(|k| points[face[(s + k) % 3] as usize]);
                    let (u, v) = (minus(next, at), minus(last, at));
                    (face[s] as usize, normal, norm(cross(u, v)).atan2(dot(u, v)))
                })
            },
        )
    };
    for (i, normal, angle) in corners() {
        sum[i] = plus(sum[i], normal.map(|x| angle * x));
        angles[i] += angle;
    }
    let contradicted = |i: usize| norm(sum[i]) <= CANCELLED * angles[i] && angles[i] > 0.0;
    let mut normals: Vec<[f64; 3]> =
        sum.iter().map(|&s| if norm(s) > 0.0 { s.map(|x| x / norm(s)) } else { UP }).collect();
    let mut spread: std::collections::BTreeMap<usize, Mat<f64>> =
        (0..n).filter(|&i| contradicted(i)).map(|i| (i, Mat::zeros(3, 3))).collect();
    if !spread.is_empty() {
        for (i, normal, angle) in corners() {
            if let Some(matrix) = spread.get_mut(&i) {
                *matrix += Mat::from_fn(3, 3, |p, q| angle * normal[p] * normal[q]);
            }
        }
    }
    for (i, matrix) in spread {
        if let Ok(eigen) = matrix.self_adjoint_eigen(Side::Lower) {
            normals[i] = std::array::from_fn(|c| eigen.U()[(c, 2)]);
        }
    }
    normals
}

/// The direction a triangle faces; none where it is too thin to have one.
pub(super) fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> Option<[f64; 3]> {
    let sides = [minus(b, a), minus(c, b), minus(a, c)];
    let longest = sides.iter().map(|&s| dot(s, s)).fold(0.0, f64::max);
    let twice = cross(sides[0], sides[1]);
    let length = norm(twice);
    (length > 2.0 * LEAST_AREA * longest).then(|| twice.map(|x| x / length))
}
