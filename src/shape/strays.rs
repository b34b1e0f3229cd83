//! What is in a scan and is no part of the body: floating bits of surface, stray points, vertices in no face.

use std::collections::BTreeSet;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::planes::Plane;
use super::{Aside, Shape};
use crate::graph::{components, nearest_neighbours};
use crate::vector::{cross, longest_side, minus, norm};

/// A piece with less than this share of the largest piece's surface is a stray piece. Of many pieces alike none is.
const STRAY: f64 = 0.01;
/// Neighbours that tell how dense a cloud is around a point.
const AROUND: usize = 8;
/// Two points of a cloud hang together up to this many times the distance to which the one of them in the denser place has its neighbours.
const GAP: f64 = 3.0;
/// Where neighbours are this many times farther away than those of the median point a piece of a cloud must show that it is a surface.
const SPARSE: f64 = 4.0;
/// It is none where neighbours are farther away than this part of the longest side of the cloud's box: points in the air, or too few to tell.
const WIDEST: f64 = 0.1;
/// Nor where it has less than this share of the points: curtains behind a body are flat, too.
const ENOUGH: f64 = 0.015;
/// Nor where the points around one are less flat in the median: on a body of 300 points it is 0.066, where points fill space 0.12.
const FLAT: f64 = 0.075;
/// A stray piece or a vertex in no face this far (in lengths of the body's box) from the body is unmatched; a nearer one, like an eye or a nail, goes with the body.
const FAR: f64 = 0.02;
/// The same for what was set aside as a floor or the like, and may be the soles that stand on it.
const SOLES: f64 = 0.04;

/// Points of a shape that its operator does without.
pub struct Strays {
    /// Points (of those that count) that belong to the body.
    pub body: Vec<u32>,
    /// Points in strays and their copies, ascending.
    pub strays: Vec<u32>,
    /// Those of them that are far from the body.
    pub far: Vec<u32>,
    /// Number of strays.
    pub pieces: usize,
    /// Vertices of a mesh that are in no face and far from the body, ascending.
    pub far_vertices: Vec<u32>,
    /// Those that were aside before and are far from the body, with their copies, ascending.
    pub far_aside: Vec<u32>,
}

impl Strays {
    /// All points that nothing on the body can stand for, ascending.
    pub fn unmatched(&self) -> Vec<u32> {
        let mut all = [&self.far[..], &self.far_vertices[..], &self.far_aside[..]].concat();
        all.sort_unstable();
        all
    }
}

/// Parts the points that count, `surface`, into the body and strays; those `aside` do not count.
///
/// Every piece of a scan has an eigenvalue of zero and takes one of the k eigenfunctions, so sixty strays leave half a basis; and a stray far from the
/// body is the first that an even sampling picks.
pub fn set_strays_aside(shape: &Shape, surface: &[u32], aside: &Aside) -> Strays {
    let (piece, weight) = match shape.faces().is_empty() {
        true => pieces_of_cloud(&at(shape, surface)),
        false => pieces_of_mesh(shape, surface),
    };
    let largest = weight.iter().copied().fold(0.0, f64::max);
    let (mut body, mut strays, mut pieces) = (Vec::new(), Vec::new(), BTreeSet::new());
    for (&i, piece) in surface.iter().zip(piece) {
        if weight[piece as usize] < STRAY * largest {
            strays.push(i);
            pieces.insert(piece);
        } else {
            body.push(i);
        }
    }
    let first = shape.first_at_place();
    let [aside, garments] = [&aside.others, &aside.garments].map(|points| with_copies(points, first));
    let mut bare = points_in_no_face(shape, surface);
    bare.retain(|i| aside.binary_search(i).is_err() && garments.binary_search(i).is_err());
    if strays.is_empty() && bare.is_empty() && aside.is_empty() {
        return Strays { body, strays, far: Vec::new(), pieces: 0, far_vertices: Vec::new(), far_aside: Vec::new() };
    }
    let from_body = |points: &[u32], far: f64| far_from(&at(shape, &body), &at(shape, points), points, far);
    // What is in no face may be a corner of a garment that lies on another one.
    let dressed = [&body[..], &garments[..]].concat();
    let far_vertices = far_from(&at(shape, &dressed), &at(shape, &bare), &bare, FAR);
    let far_aside = from_body(&aside, SOLES);
    let far = from_body(&strays, FAR);
    let [strays, far] = [strays, far].map(|points| with_copies(&points, first));
    Strays { body, strays, far, pieces: pieces.len(), far_vertices, far_aside }
}

/// Of a mesh the points that lie where none of `surface` lies, ascending.
fn points_in_no_face(shape: &Shape, surface: &[u32]) -> Vec<u32> {
    if shape.faces().is_empty() || surface.len() == shape.points().len() {
        return Vec::new();
    }
    let first = shape.first_at_place();
    let mut bare = vec![true; first.len()];
    surface.iter().for_each(|&i| bare[first[i as usize] as usize] = false);
    (0..first.len() as u32).filter(|&i| bare[first[i as usize] as usize]).collect()
}

/// All points that lie where one of `points` lies.
fn with_copies(points: &[u32], first: &[u32]) -> Vec<u32> {
    let mut named = vec![false; first.len()];
    points.iter().for_each(|&i| named[first[i as usize] as usize] = true);
    (0..first.len() as u32).filter(|&i| named[first[i as usize] as usize]).collect()
}

fn at(shape: &Shape, points: &[u32]) -> Vec<[f64; 3]> {
    points.iter().map(|&i| shape.points()[i as usize]).collect()
}

/// Those of `names` whose places in `strays` are far from all of `body`.
fn far_from(body: &[[f64; 3]], strays: &[[f64; 3]], names: &[u32], far: f64) -> Vec<u32> {
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(body) else { return Vec::new() };
    let reach = far * longest_side(body.iter().copied());
    let squared = |p: &[f64; 3]| tree.query(p).nearest_one::<SquaredEuclidean<f64>>().execute().distance;
    strays.iter().zip(names).filter(|(p, _)| squared(p) > reach * reach).map(|(_, &name)| name).collect()
}

/// For each of `surface` its connected piece over the faces, and the area of each piece.
fn pieces_of_mesh(shape: &Shape, surface: &[u32]) -> (Vec<u32>, Vec<f64>) {
    let edges = shape.faces().iter().flat_map(|&[a, b, c]| [(a, b), (b, c)]);
    let (piece, count) = components(shape.points().len(), edges);
    let mut area = vec![0.0; count];
    for face in shape.faces() {
        let [a, b, c] = face.map(|i| shape.points()[i as usize]);
        area[piece[face[0] as usize] as usize] += norm(cross(minus(b, a), minus(c, a)));
    }
    (surface.iter().map(|&i| piece[i as usize]).collect(), area)
}

/// For each point its piece, of those that hang together at their own density, and the area of each piece; none of what is no surface.
///
/// What is sampled thinly is a piece of its own, and part of the body as long as it is a surface: its points lie near each other against the size of the scan, and
/// flat. Points that a scanner sees in the air are few, or far from each other, or fill space.
fn pieces_of_cloud(points: &[[f64; 3]]) -> (Vec<u32>, Vec<f64>) {
    let neighbours = nearest_neighbours(points, AROUND);
    let n = neighbours.len();
    let reach: Vec<f64> = (0..n).map(|i| neighbours.distances(i).last().copied().unwrap_or(0.0)).collect();
    let limit = SPARSE * median(reach.iter().copied());
    // A tenth of the points is no dirt but a part that was scanned more coarsely.
    let sparse = reach.iter().filter(|&&r| r > limit).count();
    let limit = if sparse * 10 < reach.len() { limit } else { f64::INFINITY };
    let edges = (0..n).flat_map(|i| {
        let (reach, neighbours) = (&reach, &neighbours);
        let near = neighbours.of(i).iter().zip(neighbours.distances(i));
        let hang_together = move |j: u32, d: f64| {
            let (one, other) = (reach[i], reach[j as usize]);
            let mutual = || one > limit && neighbours.of(j as usize).contains(&(i as u32));
            (one > limit) == (other > limit) && (d <= GAP * one.min(other) || mutual())
        };
        near.filter(move |&(&j, &d)| hang_together(j, d)).map(move |(&j, _)| (i as u32, j))
    });
    let (piece, count) = components(points.len(), edges);
    let mut members = vec![Vec::new(); count];
    piece.iter().zip(0..).for_each(|(&piece, i)| members[piece as usize].push(i));
    let widest = WIDEST * longest_side(points.iter().copied());
    let area = members.iter().map(|members: &Vec<u32>| {
        let thin = members.iter().any(|&i| reach[i as usize] > limit);
        let surface = || {
            let around =
                |i: u32| neighbours.of(i as usize).iter().chain([&i]).map(|&j| points[j as usize]).collect::<Vec<_>>();
            let flatness = |&i: &u32| Plane::of(&around(i)).spread_off;
            members.len() as f64 >= ENOUGH * n as f64
                && median(members.iter().map(|&i| reach[i as usize])) <= widest
                && median(members.iter().map(flatness)) <= FLAT
        };
        if !thin || surface() { members.iter().map(|&i| reach[i as usize].powi(2)).sum() } else { 0.0 }
    });
    let area = area.collect();
    (piece, area)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
