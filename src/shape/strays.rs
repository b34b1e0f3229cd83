//! What is in a scan and is no part of the body: floating bits of surface, stray points, vertices in no face.

use std::collections::BTreeSet;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::outliers::{AROUND, without_outliers};
use super::planes::Plane;
use super::{Aside, LeftOut, Proposal, Shape};
use crate::graph::components;
use crate::vector::{cross, longest_side, minus, norm};

/// A piece with less than this share of the largest piece's surface is a stray piece. Of many pieces alike none is.
const STRAY: f64 = 0.01;
/// Two points of a cloud hang together up to this many times the distance to which the one of them in the denser place has its neighbours.
const GAP: f64 = 3.0;
/// Where neighbours are this many times farther away than those of the median point a piece of a cloud must show that it is a surface.
const SPARSE: f64 = 4.0;
/// It is none where neighbours are farther away than this part of the longest side of the cloud's box: points in the air, or too few to tell.
const WIDEST: f64 = 0.1;
/// Nor where it has less than this share of the points: curtains behind a body are flat, too.
const ENOUGH: f64 = 0.015;
/// What was taken for no surface and has this share of the area may be a limb all the same: a network can tell.
const LIMB: f64 = 0.02;
/// Nor where the points around one are less flat in the median: on a body of 300 points it is 0.066, where points fill space 0.12.
const FLAT: f64 = 0.075;
/// A stray piece or a vertex in no face this far (in lengths of the body's box) from the body is unmatched; a nearer one, like an eye or a nail, goes with the body.
const FAR: f64 = 0.02;
/// The same for what was set aside as a floor or the like, and may be the soles that stand on it.
const SOLES: f64 = 0.04;
/// The same for a garment.
const HANGS: f64 = 0.25;

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
    /// Those that were aside before and are far from the body, with their copies.
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
        true => {
            let kept: Vec<bool> = surface.iter().map(|i| aside.thin_parts.binary_search(i).is_ok()).collect();
            let pieces = PiecesOfCloud::of(&at(shape, surface), &kept);
            (pieces.piece, pieces.area)
        }
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
    if strays.is_empty() && bare.is_empty() && aside.is_empty() && garments.is_empty() {
        return Strays { body, strays, far: Vec::new(), pieces: 0, far_vertices: Vec::new(), far_aside: Vec::new() };
    }
    let from_body = |points: &[u32], far: f64| far_from(&at(shape, &body), &at(shape, points), points, far);
    // What is in no face may be a corner of a garment that lies on another one.
    let dressed = [&body[..], &garments[..]].concat();
    let far_vertices = far_from(&at(shape, &dressed), &at(shape, &bare), &bare, FAR);
    let mut far_aside = from_body(&aside, SOLES);
    far_aside.extend(from_body(&garments, HANGS));
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
    // The nearest of points that are all far away takes long to find; in the cells around lies nothing then.
    let cell = |p: &[f64; 3]| p.map(|x| (x / reach).floor() as i64);
    let filled: BTreeSet<[i64; 3]> = body.iter().map(cell).collect();
    let near_by = |[x, y, z]: [i64; 3]| {
        let steps = || -1..=1;
        let around = steps().flat_map(|dx| steps().flat_map(move |dy| steps().map(move |dz| (dx, dy, dz))));
        around
            .into_iter()
            .any(|(dx, dy, dz)| filled.contains(&[x.saturating_add(dx), y.saturating_add(dy), z.saturating_add(dz)]))
    };
    let squared = |p: &[f64; 3]| tree.query(p).nearest_one::<SquaredEuclidean<f64>>().execute().distance;
    let is_far = |p: &[f64; 3]| !near_by(cell(p)) || squared(p) > reach * reach;
    strays.iter().zip(names).filter(|(p, _)| is_far(p)).map(|(_, &name)| name).collect()
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

/// Points of a cloud in pieces that hang together at their own density.
///
/// What is sampled thinly is a piece of its own, and part of the body as long as it is a surface: its points lie near each other against the size of the scan, and
/// flat. Points that a scanner sees in the air are few, or far from each other, or fill space.
struct PiecesOfCloud {
    /// For each point its piece.
    piece: Vec<u32>,
    /// The area of each piece; none of what is no surface.
    area: Vec<f64>,
    /// The area of those pieces that have none here and may have one all the same.
    thin: Vec<f64>,
}

impl PiecesOfCloud {
    /// Pieces with points that are `kept` are surface all the same.
    fn of(all: &[[f64; 3]], kept: &[bool]) -> Self {
        let (on_surface, neighbours) = without_outliers(all);
        let points: Vec<[f64; 3]> = on_surface.iter().map(|&i| all[i as usize]).collect();
        let kept: Vec<bool> = on_surface.iter().map(|&i| kept[i as usize]).collect();
        let n = neighbours.len();
        let reach: Vec<f64> = (0..n).map(|i| neighbours.distances(i).last().copied().unwrap_or(0.0)).collect();
        let limit = SPARSE * median(reach.iter().copied());
        let around =
            |i: u32| neighbours.of(i as usize).iter().chain([&i]).map(|&j| points[j as usize]).collect::<Vec<_>>();
        let flatness = |&i: &u32| Plane::of(&around(i)).spread_off;
        // A tenth of the points is no dirt but a part that was scanned more coarsely, unless it fills space.
        let sparse: Vec<u32> = (0..n as u32).filter(|&i| reach[i as usize] > limit).collect();
        let dirt = sparse.len() * 10 < n || median(sparse.iter().map(flatness)) > FLAT;
        let limit = if dirt { limit } else { f64::INFINITY };
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
        let (mut area, mut thin) = (vec![0.0; count], vec![0.0; count]);
        for (number, members) in members.iter().enumerate() {
            let spread: f64 = members.iter().map(|&i: &u32| reach[i as usize].powi(2)).sum();
            let near = || median(members.iter().map(|&i| reach[i as usize])) <= widest;
            let surface =
                || members.len() as f64 >= ENOUGH * n as f64 && near() && median(members.iter().map(flatness)) <= FLAT;
            let dense = !members.iter().any(|&i| reach[i as usize] > limit);
            if dense || members.iter().any(|&i| kept[i as usize]) || surface() {
                area[number] = spread;
            } else if members.len() > AROUND && near() {
                thin[number] = spread;
            }
        }
        // Every outlier is a piece of its own.
        let mut of_all: Vec<u32> = (count as u32..).take(all.len()).collect();
        on_surface.iter().zip(piece).for_each(|(&i, piece)| of_all[i as usize] = piece);
        area.resize(count + all.len(), 0.0);
        thin.resize(count + all.len(), 0.0);
        Self { piece: of_all, area, thin }
    }
}

/// Pieces of a cloud, of those not `aside`, that are sampled so thinly that they are taken for strays, and may be limbs.
pub fn thin_parts(shape: &Shape, aside: &Aside) -> Option<Proposal> {
    let first = shape.first_at_place();
    let is_first = |i: &u32| first[*i as usize] == *i && shape.placeless().binary_search(i).is_err();
    let surface: Vec<u32> = (0..first.len() as u32).filter(is_first).filter(|&i| aside.leaves(i)).collect();
    let surface = &surface[..];
    let PiecesOfCloud { piece, area, thin } = PiecesOfCloud::of(&at(shape, surface), &vec![false; surface.len()]);
    let all: f64 = area.iter().chain(&thin).sum();
    let is_limb = |piece: u32| thin[piece as usize] > 0.0 && thin[piece as usize] >= LIMB * all;
    let points: Vec<u32> = surface.iter().zip(&piece).filter(|(_, piece)| is_limb(**piece)).map(|(&i, _)| i).collect();
    let share = thin.iter().filter(|&&thin| thin >= LIMB * all).sum::<f64>() / all;
    (!points.is_empty()).then_some(Proposal { what: LeftOut::NoThinParts, points, share })
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
