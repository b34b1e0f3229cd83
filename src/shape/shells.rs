//! Whether a mesh is one surface or a body put together from shells: clothes over skin, hair on a head, hands and head apart.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::{Resampled, Shape, resampled};
use crate::graph::{Forest, components};

/// A shell that has at least this share of the area of what it hangs together with is the body by itself; what is left are eyes, nails and the like.
const BY_ITSELF: f64 = 0.97;
/// Shells nearly meet where points of theirs are nearer than this many times the usual spacing of the points used.
const NEARLY_MEETS: f64 = 1.5;
/// No edge of the surface that a body in shells is sampled from is longer, in the same unit.
const LONGEST_EDGE: f64 = 1.6;
/// Points that are looked at around each: on the two sides of a cloth there are as many of its own.
const AROUND: NonZero<usize> = NonZero::new(12).unwrap();

/// A body put together from shells.
pub struct Shells {
    /// The surface of all of them, sampled evenly enough to be taken as a cloud.
    pub surface: Resampled,
    /// How many shells there are.
    pub count: usize,
    /// The share of the area that the largest has.
    pub largest: f64,
}

/// The surface of a welded mesh for `points` points used, if it is that of a body in shells: of those that hang together because they nearly meet the largest
/// does not nearly have the whole area. Then cotangents would see as many bodies as there are shells, and a cloud sees one.
pub fn shells(shape: &Shape, points: usize) -> Option<Shells> {
    let edges = shape.faces().iter().flat_map(|&[a, b, c]| [(a, b), (a, c)]);
    let (piece, count) = components(shape.points().len(), edges);
    let mut area = vec![0.0; count];
    shape.faces().iter().for_each(|&face| area[piece[face[0] as usize] as usize] += shape.face_area(face));
    let total: f64 = area.iter().sum();
    let most = |areas: &mut dyn Iterator<Item = f64>| areas.fold(0.0, f64::max);
    let largest = most(&mut area.iter().copied()) / total;
    if largest >= BY_ITSELF || total <= 0.0 {
        return None;
    }
    let spacing = (total / points as f64).sqrt();
    let surface = resampled(shape, LONGEST_EDGE * spacing);
    // Points keep their piece: an added one lies in a face of it, and uploaded ones come first.
    let piece_of = |i: u32| piece[surface.uploaded(i) as usize];
    let mut hang = Forest::new(count);
    for (i, j) in near_others(&surface.shape, piece_of, NEARLY_MEETS * spacing) {
        hang.join(i, j);
    }
    let mut together = vec![(0.0, 0.0_f64); count];
    for (piece, &area) in (0..).zip(&area) {
        let (sum, most) = &mut together[hang.root(piece) as usize];
        (*sum, *most) = (*sum + area, most.max(area));
    }
    let (sum, most) = together.iter().copied().fold((0.0, 0.0), |best, one| if one.0 > best.0 { one } else { best });
    let count = area.iter().filter(|&&area| area > 0.0).count();
    (most < BY_ITSELF * sum).then_some(Shells { surface, count, largest })
}

/// Pairs of shells of which points lie nearer to each other than `reach`, most of them often.
fn near_others(shape: &Shape, shell_of: impl Fn(u32) -> u32, reach: f64) -> Vec<(u32, u32)> {
    let used = shape.points_in_faces();
    let places: Vec<[f64; 3]> = used.iter().map(|&i| shape.points()[i as usize]).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return Vec::new() };
    let mut pairs = Vec::new();
    for (&i, place) in used.iter().zip(&places) {
        for near in tree.query(place).nearest_n::<SquaredEuclidean<f64>>(AROUND).execute() {
            let [one, other] = [i, used[near.item as usize]].map(&shell_of);
            if near.distance <= reach * reach && one != other {
                pairs.push((one, other));
            }
        }
    }
    pairs
}
