//! Whether a mesh is one surface or a body put together from shells: clothes over skin, hair on a head, hands and head apart.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::{Aside, LeftOut, Proposal, Resampled, Shape, resampled};
use crate::graph::{Forest, components};
use crate::vector::{longest_side, squared_distance};

/// A shell that has at least this share of the area of what it hangs together with is the body by itself; what is left are eyes, nails and the like.
const BY_ITSELF: f64 = 0.97;
/// Shells nearly meet where points of theirs are nearer than this many times the usual spacing of the points used.
const NEARLY_MEETS: f64 = 1.5;
/// No edge of the surface that a body in shells is sampled from is longer, in the same unit.
const LONGEST_EDGE: f64 = 1.6;
/// Points that are looked at around each, of those that are left of every shell in cells of half the spacing: on the two sides of a cloth there are as many of its own.
const AROUND: NonZero<usize> = NonZero::new(24).unwrap();
/// Two shells of which this share of the points nearly meets the other are the two sides of one cloth.
const LINING: f64 = 0.8;
/// A garment hangs around the body: its middle is nearer to it than this part of the longest side of the box.
const INSIDE: f64 = 0.06;
/// What a body may be without has this share of the area of all shells.
const LOOSE: [f64; 2] = [0.02, 0.75];
/// So many are tried, the largest: a network looks at the body without each.
const TRIED: usize = 8;

/// A body put together from shells.
pub struct Shells {
    /// The surface of all of them, sampled evenly enough to be taken as a cloud.
    pub surface: Resampled,
    /// How many shells there are.
    pub count: usize,
    /// The share of the area that the largest has.
    pub largest: f64,
    /// The shell of each uploaded point.
    shell: Vec<u32>,
    /// The area of each shell.
    area: Vec<f64>,
    /// Points that nearly meet are nearer to each other than this.
    near: f64,
}

/// The surface of a welded mesh for `points` points used, if it is that of a body in shells: of those that hang together because they nearly meet the largest
/// does not nearly have the whole area. Then cotangents would see as many bodies as there are shells, and a cloud sees one.
pub fn shells(shape: &Shape, points: usize) -> Option<Shells> {
    let edges = shape.faces().iter().flat_map(|&[a, b, c]| [(a, b), (a, c)]);
    let (shell, count) = components(shape.points().len(), edges);
    let mut area = vec![0.0; count];
    shape.faces().iter().for_each(|&face| area[shell[face[0] as usize] as usize] += shape.face_area(face));
    let total: f64 = area.iter().sum();
    let largest = area.iter().copied().fold(0.0, f64::max) / total;
    if largest >= BY_ITSELF || total <= 0.0 {
        return None;
    }
    let spacing = (total / points as f64).sqrt();
    let surface = resampled(shape, LONGEST_EDGE * spacing);
    let count = area.iter().filter(|&&area| area > 0.0).count();
    let shells = Shells { surface, count, largest, shell, area, near: NEARLY_MEETS * spacing };
    let mut hang = Forest::new(shells.area.len());
    shells.near_others(|shell, others| others.iter().for_each(|&other| _ = hang.join(shell, other)));
    let mut together = vec![(0.0, 0.0_f64); shells.area.len()];
    for (shell, &area) in (0..).zip(&shells.area) {
        let (sum, most) = &mut together[hang.root(shell) as usize];
        (*sum, *most) = (*sum + area, most.max(area));
    }
    let (sum, most) = together.iter().copied().fold((0.0, 0.0), |best, one| if one.0 > best.0 { one } else { best });
    (most < BY_ITSELF * sum).then_some(shells)
}

/// Shells that a body put together from them may be without, as a skirt, a sword or another person is one, the smallest first. Geometry cannot tell them from a trunk:
/// who knows what bodies look like chooses.
pub fn loose_pieces(shape: &Shape, aside: &Aside, points: usize) -> Vec<Proposal> {
    let mut faces = shape.faces().to_vec();
    faces.retain(|face| face.iter().all(|&i| aside.leaves(i)));
    let left = Resampled::without_added(shape, faces).shape;
    shells(&left, points).map(|shells| shells.loose()).unwrap_or_default()
}

impl Shells {
    /// Added points keep the shell of the face that they lie in, and uploaded ones come first.
    fn shell_of(&self, point: u32) -> u32 {
        self.shell[self.surface.uploaded(point) as usize]
    }

    /// Tells for each point its shell and the others that have points near it.
    fn near_others(&self, mut tell: impl FnMut(u32, &BTreeSet<u32>)) {
        let shape = &self.surface.shape;
        let place = |i: u32| shape.points()[i as usize];
        let cell = 0.5 * self.near / NEARLY_MEETS;
        let mut cells = BTreeMap::new();
        for i in shape.points_in_faces() {
            cells.entry((self.shell_of(i), place(i).map(|x| (x / cell).floor() as i64))).or_insert(i);
        }
        let used: Vec<u32> = cells.into_values().collect();
        let places: Vec<[f64; 3]> = used.iter().map(|&i| place(i)).collect();
        let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return };
        for (&i, place) in used.iter().zip(&places) {
            let near = tree.query(place).nearest_n::<SquaredEuclidean<f64>>(AROUND).execute();
            let near = near.iter().filter(|near| near.distance <= self.near * self.near);
            let mut shells: BTreeSet<u32> = near.map(|near| self.shell_of(used[near.item as usize])).collect();
            shells.remove(&self.shell_of(i));
            tell(self.shell_of(i), &shells);
        }
    }

    /// Shells that the body may be without, each with its lining.
    fn loose(&self) -> Vec<Proposal> {
        let mut points = vec![0_usize; self.area.len()];
        let mut met: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        self.near_others(|shell, others| {
            points[shell as usize] += 1;
            others.iter().for_each(|&other| *met.entry((shell, other)).or_default() += 1);
        });
        let lies_on = |one: u32, other: u32| {
            met.get(&(one, other)).is_some_and(|&met| met as f64 >= LINING * points[one as usize] as f64)
        };
        let mut cloths = Forest::new(self.area.len());
        for &(one, other) in met.keys() {
            if lies_on(one, other) && lies_on(other, one) {
                cloths.join(one, other);
            }
        }
        let total: f64 = self.area.iter().sum();
        let mut share: BTreeMap<u32, f64> = BTreeMap::new();
        for (shell, area) in (0..).zip(&self.area) {
            *share.entry(cloths.root(shell)).or_default() += area / total;
        }
        let used = self.surface.shape.points_in_faces();
        let is_loose = |&(_, share): &(u32, f64)| (LOOSE[0]..LOOSE[1]).contains(&share);
        let uploaded = (0..).zip(&self.shell).filter(|(i, _)| used.binary_search(i).is_ok());
        let uploaded: Vec<(u32, u32)> = uploaded.map(|(i, &shell)| (i, cloths.root(shell))).collect();
        let place = |i: u32| self.surface.shape.points()[i as usize];
        let inside = (INSIDE * longest_side(used.iter().map(|&i| place(i)))).powi(2);
        let piece = |(cloth, share)| {
            let (own, others): (Vec<u32>, Vec<u32>) =
                used.iter().partition(|&&i| cloths.root(self.shell_of(i)) == cloth);
            let middle = std::array::from_fn(|c| own.iter().map(|&i| place(i)[c]).sum::<f64>() / own.len() as f64);
            let hangs = others.iter().any(|&i| squared_distance(place(i), middle) < inside);
            let what = if hangs { LeftOut::Garment } else { LeftOut::Piece };
            let points = uploaded.iter().filter(|(_, of)| *of == cloth).map(|&(i, _)| i);
            Proposal { what, points: points.collect(), share }
        };
        let mut loose: Vec<Proposal> = share.into_iter().filter(is_loose).map(piece).collect();
        loose.sort_unstable_by(|a, b| a.share.total_cmp(&b.share).then(a.points.cmp(&b.points)));
        loose.split_off(loose.len().saturating_sub(TRIED))
    }
}
