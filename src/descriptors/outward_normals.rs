//! Normals that point out of each piece of a mesh, however it is wound.

use crate::graph::components;
use crate::operators::normals;
use crate::shape::Shape;
use crate::vector::{cross, dot, minus};

/// A piece whose volume is less than this part of what its faces add and take away encloses none: rounding would tell its outside.
const FLAT: f64 = 1e-9;

/// Unit normals (n, 3) of a welded mesh: those of its windings, turned round on every connected piece that is inside out. So an inner shell, as of a cavity,
/// faces out of itself too.
pub(super) fn outward_normals(welded: &Shape) -> Vec<[f64; 3]> {
    let (points, faces) = (welded.points(), welded.faces());
    let edges = faces.iter().flat_map(|&[a, b, c]| [(a, b), (a, c)]);
    let (piece, pieces) = components(points.len(), edges);
    let inside_out = inside_out_pieces(points, faces, &piece, pieces);
    let mut normals = normals(welded);
    for (normal, &first) in normals.iter_mut().zip(welded.first_at_place()) {
        if inside_out[piece[first as usize] as usize] {
            *normal = normal.map(|c| -c);
        }
    }
    normals
}

/// Whether the volume inside each piece is negative, as where faces run clockwise seen from outside. Measured from the middle of the piece's points, so
/// that holes hardly matter.
fn inside_out_pieces(points: &[[f64; 3]], faces: &[[u32; 3]], piece: &[u32], pieces: usize) -> Vec<bool> {
    let (mut middle, mut count) = (vec![[0.0; 3]; pieces], vec![0.0; pieces]);
    for (point, &piece) in points.iter().zip(piece) {
        (0..3).for_each(|c| middle[piece as usize][c] += point[c]);
        count[piece as usize] += 1.0;
    }
    middle.iter_mut().zip(&count).for_each(|(sum, count)| sum.iter_mut().for_each(|c| *c /= count));
    // Six times the volume, and how much was added and taken away for it.
    let (mut volume, mut moved) = (vec![0.0; pieces], vec![0.0; pieces]);
    for face in faces {
        let piece = piece[face[0] as usize] as usize;
        let [a, b, c] = face.map(|i| minus(points[i as usize], middle[piece]));
        let cone: f64 = dot(a, cross(b, c));
        volume[piece] += cone;
        moved[piece] += cone.abs();
    }
    volume.iter().zip(&moved).map(|(&volume, &moved)| volume < -FLAT * moved).collect()
}
