//! Triangles that can carry an area, and what the ones that stay look like together.

use super::error::ShapeError;
use super::repair::{Repair, counted};
use crate::graph::components;
use crate::vector::{cross, minus, norm};

/// Refuses a face that names a missing point.
pub(super) fn check_indices(faces: &[[u32; 3]], points: usize) -> Result<(), ShapeError> {
    for (face, corners) in faces.iter().enumerate() {
        for (corner, &index) in corners.iter().enumerate() {
            if index as usize >= points {
                return Err(ShapeError::FaceIndex { face, corner, index, points });
            }
        }
    }
    Ok(())
}

/// Whether the faces are triangle soup: every point is a corner of one face, in their order.
pub(super) fn share_no_corner(faces: &[[u32; 3]], points: usize) -> bool {
    let corners = faces.as_flattened();
    corners.len() == points && corners.iter().enumerate().all(|(i, &corner)| i == corner as usize)
}

/// Drops faces that name a point twice, and pieces that consist of faces without area, which would be surfaces of their own to a spectrum;
/// reports each kind.
///
/// A face without area that hangs on a surface stays: between a long edge and the halves of it on the other side it closes a crack, and
/// intrinsic flips and mollification take it up (the first 60 eigenvalues of a sphere with 50 of them are within 0.5 % of the clean one).
pub(super) fn drop_degenerate(
    points: &[[f64; 3]],
    first_at_place: &[u32],
    faces: &mut Vec<[u32; 3]>,
    repairs: &mut Vec<Repair>,
) {
    let before = faces.len();
    faces.retain(|[a, b, c]| a != b && b != c && c != a);
    let repeated = before - faces.len();
    let has_area = |f: &[u32; 3]| has_area(f.map(|i| points[i as usize]));
    let flat = faces.iter().filter(|f| !has_area(f)).count();
    let mut stray = 0;
    if flat > 0 {
        let corner = |i: u32| first_at_place[i as usize];
        let edges = faces.iter().flat_map(|&[a, b, c]| [(corner(a), corner(b)), (corner(a), corner(c))]);
        let (piece, pieces) = components(points.len(), edges);
        let mut carries_area = vec![false; pieces];
        faces.iter().filter(|f| has_area(f)).for_each(|f| carries_area[piece[corner(f[0]) as usize] as usize] = true);
        let all = faces.len();
        faces.retain(|f| carries_area[piece[corner(f[0]) as usize] as usize]);
        stray = all - faces.len();
    }

    repairs.extend(Repair::counted("repeated-index-faces", repeated, || {
        format!("{} naming the same point twice left out", counted(repeated, "face", "faces"))
    }));
    repairs.extend(Repair::counted("zero-area-faces", flat - stray, || {
        format!("{} without any area kept, so that the surface stays closed", counted(flat - stray, "face", "faces"))
    }));
    repairs.extend(Repair::counted("zero-area-pieces", stray, || {
        format!("{} without any area and joined to no surface left out", counted(stray, "face", "faces"))
    }));
    repairs.extend(Repair::counted("no-faces-left", usize::from(before > 0 && faces.is_empty()), || {
        format!("none of the {before} faces is usable, so the scan is taken as a point cloud")
    }));
}

/// Whether a triangle is higher than the rounding of its own coordinates: the height over the longest edge must exceed
/// 4ε times the larger of that edge and the coordinates.
fn has_area([a, b, c]: [[f64; 3]; 3]) -> bool {
    let (u, v, w) = (minus(b, a), minus(c, a), minus(c, b));
    let edge = norm(u).max(norm(v)).max(norm(w));
    let reach = a.iter().chain(&b).chain(&c).fold(edge, |m, x| m.max(x.abs()));
    edge > 0.0 && norm(cross(u, v)) / edge > 4.0 * f64::EPSILON * reach
}

/// Reports, and keeps, points of a mesh that belong to no face.
pub(super) fn notice_bare_points(points: usize, faces: &[[u32; 3]], placeless: &[u32], repairs: &mut Vec<Repair>) {
    if faces.is_empty() {
        return;
    }
    let unreferenced = used(points, faces.iter().copied()).into_iter().filter(|used| !used).count() - placeless.len();
    repairs.extend(Repair::counted("unreferenced-points", unreferenced, || {
        format!("{} to no face; kept as they are", counted(unreferenced, "point belongs", "points belong"))
    }));
}

pub(super) fn used(points: usize, faces: impl Iterator<Item = [u32; 3]>) -> Vec<bool> {
    let mut used = vec![false; points];
    faces.flatten().for_each(|i| used[i as usize] = true);
    used
}

/// Reports, and keeps, what is odd about a mesh as a whole: edges with more than two faces, neighbours that disagree about the outside, several
/// pieces.
pub(super) fn notice_topology(points: usize, faces: impl Iterator<Item = [u32; 3]> + Clone, repairs: &mut Vec<Repair>) {
    let (crowded, disagreeing) = odd_edges(faces.clone());
    repairs.extend(Repair::counted("non-manifold-edges", crowded, || {
        format!("{} by more than two faces; kept as they are", counted(crowded, "edge is shared", "edges are shared"))
    }));
    repairs.extend(Repair::counted("inconsistent-winding", disagreeing, || {
        format!(
            "along {} the two faces disagree about which side is outside; kept as they are",
            counted(disagreeing, "edge", "edges")
        )
    }));

    let pieces = pieces(points, faces);
    repairs.extend(Repair::counted("separate-pieces", if pieces > 1 { pieces } else { 0 }, || {
        format!("the mesh consists of {pieces} pieces that share no point")
    }));
}

/// Whether no two faces disagree about which side is outside.
pub(super) fn agree(faces: &[[u32; 3]]) -> bool {
    odd_edges(faces.iter().copied()).1 == 0
}

/// Edges with more than two faces, and edges whose two faces run along them in the same direction.
fn odd_edges(faces: impl Iterator<Item = [u32; 3]>) -> (usize, usize) {
    // One sortable word per side of a face: smaller end, larger end, direction (points are below 2³¹).
    let mut sides = Vec::with_capacity(3 * faces.size_hint().1.unwrap_or(0));
    for [a, b, c] in faces {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            sides.push(u64::from(i.min(j)) << 32 | u64::from(i.max(j)) << 1 | u64::from(i > j));
        }
    }
    sides.sort_unstable();
    let mut crowded = 0;
    let mut disagreeing = 0;
    for edge in sides.chunk_by(|a, b| a >> 1 == b >> 1) {
        match edge {
            [first, second] => disagreeing += usize::from(first == second),
            [_] => {}
            _ => crowded += 1,
        }
    }
    (crowded, disagreeing)
}

/// Connected components of the points in use.
fn pieces(points: usize, faces: impl Iterator<Item = [u32; 3]> + Clone) -> usize {
    let edges = faces.clone().flat_map(|[a, b, c]| [(a, b), (a, c)]);
    let (_, components) = components(points, edges);
    components - used(points, faces).into_iter().filter(|used| !used).count()
}
