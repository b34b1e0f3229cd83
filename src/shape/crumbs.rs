//! What is in a scan and is no part of the body: floating bits of surface, stray points.

use super::{Shape, nearest_samples};
use crate::graph::{components, nearest_neighbours};
use crate::vector::{cross, minus, norm, squared_distance};

/// A piece with less than this share of the surface (of a cloud: of the points) is a crumb.
const CRUMB: f64 = 0.01;
/// Neighbours that tell how dense a cloud is around a point.
const AROUND: usize = 8;
/// Two points of a cloud hang together up to this many times the distance to which the one of them in the denser place has its neighbours.
const GAP: f64 = 3.0;
/// A crumb this far (in lengths of the body's box) from the body is unmatched; a nearer one, like an eye or a nail, goes with the body.
const FAR: f64 = 0.02;

/// Points of a shape that its operator does without.
pub struct Crumbs {
    /// Points (of those that count) that belong to the body.
    pub body: Vec<u32>,
    /// Points in crumbs, ascending.
    pub crumbs: Vec<u32>,
    /// Those of them that are far from the body.
    pub far: Vec<u32>,
    /// Number of crumbs.
    pub pieces: usize,
}

/// Parts the points that count, `surface`, into the body and crumbs.
///
/// Every piece of a scan has an eigenvalue of zero and takes one of the k eigenfunctions, so sixty crumbs leave half a basis; and a stray far from the
/// body is the first that an even sampling picks.
pub fn set_crumbs_aside(shape: &Shape, surface: &[u32]) -> Crumbs {
    let (piece, weight) = if shape.faces().is_empty() { pieces_of_cloud(shape) } else { pieces_of_mesh(shape) };
    let total: f64 = weight.iter().sum();
    let is_crumb = |i: &u32| weight[piece[*i as usize] as usize] < CRUMB * total;
    let (crumbs, body): (Vec<u32>, Vec<u32>) = surface.iter().copied().partition(is_crumb);
    let mut found: Vec<u32> = crumbs.iter().map(|&i| piece[i as usize]).collect();
    found.sort_unstable();
    found.dedup();
    let reach = FAR * longest_side(shape, &body);
    let on_crumbs: Vec<[f64; 3]> = crumbs.iter().map(|&i| shape.points()[i as usize]).collect();
    let far = if crumbs.is_empty() || body.is_empty() {
        Vec::new()
    } else {
        let bodily: Vec<[f64; 3]> = body.iter().map(|&i| shape.points()[i as usize]).collect();
        let rows: Vec<u32> = (0..bodily.len() as u32).collect();
        let both = [&bodily[..], &on_crumbs[..]].concat();
        let nearest = nearest_samples(&both, &rows);
        let distance = |c: usize| squared_distance(on_crumbs[c], bodily[nearest[bodily.len() + c] as usize]).sqrt();
        (0..crumbs.len()).filter(|&c| distance(c) > reach).map(|c| crumbs[c]).collect()
    };
    Crumbs { body, crumbs, far, pieces: found.len() }
}

/// Connected pieces over the faces, and the area of each.
fn pieces_of_mesh(shape: &Shape) -> (Vec<u32>, Vec<f64>) {
    let edges = shape.faces().iter().flat_map(|&[a, b, c]| [(a, b), (b, c)]);
    let (piece, count) = components(shape.points().len(), edges);
    let mut area = vec![0.0; count];
    for face in shape.faces() {
        let [a, b, c] = face.map(|i| shape.points()[i as usize]);
        area[piece[face[0] as usize] as usize] += norm(cross(minus(b, a), minus(c, a)));
    }
    (piece, area)
}

/// Pieces that hang together at their own density, and the points in each.
fn pieces_of_cloud(shape: &Shape) -> (Vec<u32>, Vec<f64>) {
    let neighbours = nearest_neighbours(shape.points(), AROUND);
    let mut reach: Vec<f64> =
        (0..neighbours.len()).map(|i| neighbours.distances(i).last().copied().unwrap_or(0.0)).collect();
    // Many copies of one point would have no reach at all.
    let mut sorted = reach.clone();
    sorted.sort_by(f64::total_cmp);
    let floor = 0.5 * sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    reach.iter_mut().for_each(|r| *r = r.max(floor));
    let edges = (0..neighbours.len()).flat_map(|i| {
        let reach = &reach;
        let near = neighbours.of(i).iter().zip(neighbours.distances(i));
        near.filter(move |&(&j, &d)| d <= GAP * reach[i].min(reach[j as usize])).map(move |(&j, _)| (i as u32, j))
    });
    let (piece, count) = components(shape.points().len(), edges);
    let mut points = vec![0.0; count];
    piece.iter().for_each(|&p| points[p as usize] += 1.0);
    (piece, points)
}

fn longest_side(shape: &Shape, points: &[u32]) -> f64 {
    let side = |c: usize| {
        let along = points.iter().map(|&i| shape.points()[i as usize][c]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}
