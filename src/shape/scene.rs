//! What else is in a scan beside the body: floors, walls, furniture, other bodies.
//!
//! Geometry alone cannot tell a box that somebody sits on from the head of a box-headed figure. So it only proposes what the body may be without; who knows what
//! bodies look like chooses.

use std::collections::{BTreeMap, BTreeSet};

use super::planes::{Patch, flat_patches};
use super::{Shape, resampled};
use crate::graph::{Forest, Neighbours, components, nearest_neighbours};
use crate::vector::{middle_side, squared_distance};

/// Points that the scene is looked at with, roughly.
const PROBES: f64 = 4000.0;
/// Points of a cloud that tell their spacing.
const ENOUGH: usize = 50_000;
/// No edge of a mesh is longer there, in their spacing.
const LONGEST_EDGE: f64 = 1.2;
const AROUND: usize = 10;
/// Points hang together up to this distance, in the spacing.
const TOGETHER: f64 = 1.4;
/// Of those a plane lies under or behind, this share lies on one side.
const ONE_SIDE: f64 = 0.95;
/// What lies on a plane that is no floor or wall has another side that is flat, too: all patches together have at least this share.
const FURNITURE: f64 = 0.08;
/// Furniture is flat to this part of the spacing; the part of a back that fits between two planes fills the space between them, and is rougher.
const CRISP: f64 = 0.15;
/// A floor with less than this share of the points must be as flat.
const WIDE: f64 = 0.15;
/// So much of the rim of a floor, at most, is a border to what stands on it.
const FREE: f64 = 0.5;
/// Points that are off a plane by chance are so by no more than this many standard deviations.
const BY_CHANCE: f64 = 3.0;
/// Points this near to a patch and to its plane go with it, in the spacing: edges, where no normal tells.
const BESIDE: f64 = 1.6;
/// A piece of a mesh of which more than this share goes, goes as a whole; one of which less than the rest goes, stays.
const MOSTLY: f64 = 0.7;
/// Things that count have at least this share of the area of the largest.
const THING: f64 = 0.05;
/// And the body alone this share of the area of all together: a leg of a scan that lacks the torso looks like a small body.
const BODY: f64 = 0.25;
/// Things of which each is tried as the body.
const TRIED: usize = 3;

/// Something that the body may be without.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// What is left out.
    pub what: LeftOut,
    /// Points to leave out, ascending; copies of them are not named.
    pub points: Vec<u32>,
    /// Their share of the area.
    pub share: f64,
}

/// What operators do without, and what they keep against the rule for strays: points, ascending; copies of them need not be named.
#[derive(Clone, Debug, Default)]
pub struct Aside {
    /// Those of other things: matched with nothing, but where they touch the body.
    pub others: Vec<u32>,
    /// Those of garments: matched like the part of the body that they hang around.
    pub garments: Vec<u32>,
    /// Kept: those of parts that are sampled so thinly that they would be taken for strays.
    pub thin_parts: Vec<u32>,
}

impl Aside {
    /// Also without what is proposed.
    pub fn and(&self, proposal: &Proposal) -> Self {
        let mut both = self.clone();
        let points = match proposal.what {
            LeftOut::Garment => &mut both.garments,
            LeftOut::NoThinParts => &mut both.thin_parts,
            LeftOut::Floor | LeftOut::Furniture | LeftOut::OtherThings | LeftOut::Piece => &mut both.others,
        };
        points.extend(&proposal.points);
        points.sort_unstable();
        points.dedup();
        both
    }

    /// Whether a point is not among them.
    pub fn leaves(&self, point: u32) -> bool {
        [&self.others, &self.garments].iter().all(|points| points.binary_search(&point).is_err())
    }
}

/// What a proposal leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// A plane that all else lies on one side of, with whatever is beyond.
    Floor,
    /// Flat patches that hang together, as of a box or a chair.
    Furniture,
    /// All but one of the things that do not touch.
    OtherThings,
    /// A shell around the body, as a skirt is.
    Garment,
    /// A piece beside the body that touches it, as a sword or somebody whose hand is held.
    Piece,
    /// Nothing: parts that are sampled so thinly that they were taken for strays are the body's.
    NoThinParts,
}

/// What a welded mesh or a cloud, without the points `aside`, may be without. Proposals of one kind exclude each other; each has another body.
pub fn proposals(shape: &Shape, aside: &Aside) -> Vec<Proposal> {
    let scene = Scene::new(shape, aside);
    let mut found = scene.without_planes();
    found.extend(scene.things_alone());
    found.retain(|proposal| !proposal.points.is_empty());
    found
}

/// A place on the surface, and the uploaded point that stands for it.
type Sample = ([f64; 3], u32);

/// Evenly spread points of a scan.
struct Scene<'s> {
    uploaded: &'s [[f64; 3]],
    places: Vec<[f64; 3]>,
    neighbours: Neighbours,
    spacing: f64,
    /// For each uploaded point that counts the probe that stands for it.
    probe_of: Vec<(u32, u32)>,
    /// For each of these its piece of the mesh; all of a cloud are one.
    piece: Vec<u32>,
}

impl<'s> Scene<'s> {
    fn new(shape: &'s Shape, aside: &Aside) -> Self {
        let kept = |i: u32| aside.leaves(i);
        let n = shape.points().len();
        let (spacing, piece): (f64, Vec<u32>);
        let all: Vec<Sample>;
        if shape.faces().is_empty() {
            let points: Vec<u32> = (0..n as u32)
                .filter(|&i| kept(i) && shape.first_at_place()[i as usize] == i)
                .filter(|i| shape.placeless().binary_search(i).is_err())
                .collect();
            all = points.iter().map(|&i| (shape.points()[i as usize], i)).collect();
            spacing = spacing_of(&all);
            piece = vec![0; n];
        } else {
            let faces: Vec<[u32; 3]> =
                shape.faces().iter().copied().filter(|face| face.iter().all(|&i| kept(i))).collect();
            let mesh = Shape::already_valid(shape.points().to_vec(), faces, None);
            spacing = (mesh.surface_area() / PROBES).sqrt();
            let fine = resampled(&mesh, LONGEST_EDGE * spacing);
            let on_surface = fine.shape.points_in_faces();
            all = on_surface.into_iter().map(|i| (fine.shape.points()[i as usize], fine.uploaded(i))).collect();
            let edges = mesh.faces().iter().flat_map(|&[a, b, c]| [(a, b), (a, c)]);
            piece = components(n, edges).0;
        }
        let (places, probe_of) = one_per_cell(&all, spacing);
        let neighbours = nearest_neighbours(&places, AROUND);
        Self { uploaded: shape.points(), places, neighbours, spacing, probe_of, piece }
    }

    /// Proposals to leave out flat patches.
    fn without_planes(&self) -> Vec<Proposal> {
        let mut patches = flat_patches(&self.places, &self.neighbours, self.spacing);
        let mut found = Vec::new();
        let wide = |patch: &Patch| patch.points.len() as f64 >= WIDE * self.places.len() as f64;
        let flat = |patch: &Patch| patch.roughness <= CRISP * self.spacing;
        let floor = patches
            .iter()
            .filter(|patch| wide(patch) || flat(patch))
            .filter_map(|patch| Some((patch, self.side_of_the_rest(patch)?)))
            .find(|&(patch, side)| self.lies_free(patch, side));
        let floors = usize::from(floor.is_some());
        if let Some((patch, side)) = floor {
            let gone = self.beside(std::slice::from_ref(patch));
            let beyond = |i: usize| side * patch.height(self.places[i]) < self.spacing * 0.5;
            let gone: Vec<bool> =
                gone.iter().enumerate().map(|(i, &gone)| gone || beyond(i) && self.near(patch, i)).collect();
            let coarse = self.probe_of.len() > 2 * self.places.len();
            let raised = |point: [f64; 3], probe: u32| {
                coarse
                    && side * patch.height(point) > (CRISP * self.spacing).max(BY_CHANCE * patch.noise)
                    && self.neighbours.of(probe as usize).iter().any(|&j| !gone[j as usize])
            };
            found.extend(self.proposal(LeftOut::Floor, &gone, &raised));
        }
        patches.retain(flat);
        let share = patches.iter().map(|patch| patch.points.len()).sum::<usize>() as f64 / self.places.len() as f64;
        if share >= FURNITURE && patches.len() > floors {
            let mut gone = self.beside(&patches);
            // Legs and rims that hang on nothing any more go, too.
            let (things, largest) = self.things(&gone);
            gone.iter_mut().zip(things).for_each(|(gone, thing)| *gone |= thing != largest);
            found.extend(self.proposal(LeftOut::Furniture, &gone, &|_, _| false));
        }
        found
    }

    /// The side of a plane, 1 or −1, on which nearly all that is not on it lies.
    fn side_of_the_rest(&self, patch: &Patch) -> Option<f64> {
        let thick = self.spacing.max(BY_CHANCE * patch.noise);
        let heights = self.places.iter().map(|&place| patch.height(place)).filter(|h| h.abs() > thick);
        let (above, all) =
            heights.fold((0, 0), |(above, all): (usize, usize), h| (above + usize::from(h > 0.0), all + 1));
        let share = above as f64 / all.max(1) as f64;
        if share >= ONE_SIDE {
            Some(1.0)
        } else if share <= 1.0 - ONE_SIDE {
            Some(-1.0)
        } else {
            None
        }
    }

    /// Whether most of the rim of a patch is no border to what lies on a side of it: a body stands on a floor, and is bounded by a side of itself.
    fn lies_free(&self, patch: &Patch, side: f64) -> bool {
        let on: BTreeSet<u32> = patch.points.iter().copied().collect();
        let touches = |&&i: &&u32| {
            let height = |j: u32| side * patch.height(self.places[j as usize]);
            let leaves = |&j: &u32| !on.contains(&j) && height(j) > BY_CHANCE * patch.noise;
            self.neighbours.of(i as usize).iter().any(leaves)
        };
        let touching = patch.points.iter().filter(touches).count() as f64;
        // Around a square there are four times the root of its points; neighbours reach two points far.
        touching < FREE * 8.0 * (patch.points.len() as f64).sqrt()
    }

    /// Whether a probe lies below or beside a patch and not somewhere else behind its plane.
    fn near(&self, patch: &Patch, i: usize) -> bool {
        let reach = (20.0 * self.spacing).powi(2);
        let place = self.places[i];
        patch.height(place).abs() <= self.spacing
            || patch.points.iter().step_by(7).any(|&j| squared_distance(self.places[j as usize], place) <= reach)
    }

    /// Probes on patches, and those beside one that lie on its plane.
    fn beside(&self, patches: &[Patch]) -> Vec<bool> {
        let mut gone = vec![false; self.places.len()];
        let reach = (BESIDE * self.spacing).powi(2);
        for patch in patches {
            let mut front = patch.points.clone();
            front.iter().for_each(|&i| gone[i as usize] = true);
            // A patch grows by one step only, and along its plane.
            front.retain(|&i| self.neighbours.of(i as usize).iter().any(|&j| !gone[j as usize]));
            for i in front {
                for &j in self.neighbours.of(i as usize) {
                    let (p, q) = (self.places[i as usize], self.places[j as usize]);
                    let thick = (0.5 * self.spacing).max(BY_CHANCE * patch.noise);
                    if squared_distance(p, q) <= reach && patch.height(q).abs() <= thick {
                        gone[j as usize] = true;
                    }
                }
            }
        }
        gone
    }

    /// For each probe the thing it belongs to, of those that are left, and the largest of these.
    fn things(&self, gone: &[bool]) -> (Vec<u32>, u32) {
        let mut forest = Forest::new(self.places.len());
        let reach = TOGETHER * self.spacing;
        for i in (0..self.places.len()).filter(|&i| !gone[i]) {
            for (&j, &d) in self.neighbours.of(i).iter().zip(self.neighbours.distances(i)) {
                let mutual = || self.neighbours.of(j as usize).contains(&(i as u32));
                if !gone[j as usize] && (d <= reach || mutual()) {
                    forest.join(i as u32, j);
                }
            }
        }
        let thing: Vec<u32> = (0..self.places.len() as u32).map(|i| forest.root(i)).collect();
        let mut sizes = vec![0_usize; self.places.len()];
        thing.iter().zip(gone).filter(|(_, gone)| !**gone).for_each(|(&thing, _)| sizes[thing as usize] += 1);
        let largest = (0..sizes.len()).max_by_key(|&i| (sizes[i], std::cmp::Reverse(i))).unwrap_or(0);
        (thing, largest as u32)
    }

    /// Proposals to take one thing alone, of several that do not touch: the largest first.
    fn things_alone(&self) -> Vec<Proposal> {
        let none = vec![false; self.places.len()];
        let (thing, _) = self.things(&none);
        let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
        thing.iter().for_each(|&thing| *sizes.entry(thing).or_default() += 1);
        let mut by_size: Vec<(usize, u32)> = sizes.into_iter().map(|(thing, size)| (size, thing)).collect();
        by_size.sort_by_key(|&(size, thing)| (std::cmp::Reverse(size), thing));
        let least = THING * by_size.first().map_or(0.0, |&(size, _)| size as f64);
        by_size.retain(|&(size, _)| size as f64 >= least);
        if by_size.len() < 2 {
            return Vec::new();
        }
        let alone = |&(_, body): &(usize, u32)| {
            let gone: Vec<bool> = thing.iter().map(|&thing| thing != body).collect();
            self.proposal(LeftOut::OtherThings, &gone, &|_, _| false)
        };
        let body = |&&(size, _): &&(usize, u32)| size as f64 >= BODY * self.places.len() as f64;
        by_size.iter().filter(body).take(TRIED).filter_map(alone).collect()
    }

    /// In uploaded points. Pieces of a mesh stay whole where it is clear that they go or stay; elsewhere points stay of which, and of their probe, `stays` says so:
    /// where probes are far fewer than points, one stands for soles and the floor below them.
    fn proposal(&self, what: LeftOut, gone: &[bool], stays: &dyn Fn([f64; 3], u32) -> bool) -> Option<Proposal> {
        let mut of_piece: BTreeMap<u32, (usize, usize)> = BTreeMap::new();
        let piece = |i: u32| self.piece[i as usize];
        for &(i, probe) in &self.probe_of {
            let (go, all) = of_piece.entry(piece(i)).or_default();
            (*go, *all) = (*go + usize::from(gone[probe as usize]), *all + 1);
        }
        let goes = |&(i, probe): &(u32, u32)| {
            let (go, all) = of_piece[&piece(i)];
            let share = go as f64 / all as f64;
            if of_piece.len() > 1 && share > MOSTLY {
                true
            } else if of_piece.len() > 1 && share < 1.0 - MOSTLY {
                false
            } else {
                gone[probe as usize] && !stays(self.uploaded[i as usize], probe)
            }
        };
        let mut points: Vec<u32> = self.probe_of.iter().filter(|&pair| goes(pair)).map(|&(i, _)| i).collect();
        points.dedup();
        let share = gone.iter().filter(|&&gone| gone).count() as f64 / gone.len().max(1) as f64;
        (share < 1.0).then_some(Proposal { what, points, share })
    }
}

/// The spacing at which some thousand points would cover a cloud: by the cells of a grid that it fills. Of many points an even share tells as much.
fn spacing_of(points: &[Sample]) -> f64 {
    let some: Vec<Sample> = points.iter().step_by(points.len().div_ceil(ENOUGH).max(1)).copied().collect();
    // A single stray far away is not what cells are measured by.
    let mut spacing = middle_side(some.iter().map(|&(place, _)| place)) / 16.0;
    // A surface fills four times as many cells of half the size.
    for _ in 0..8 {
        let filled = one_per_cell(&some, spacing).0.len() as f64;
        if filled >= PROBES.min(0.5 * some.len() as f64) {
            break;
        }
        spacing *= (filled / PROBES).sqrt().clamp(0.5, 0.95);
    }
    spacing
}

/// The first point in each cell of a grid, and for every point, ascending, the one in its cell.
fn one_per_cell(points: &[Sample], side: f64) -> (Vec<[f64; 3]>, Vec<(u32, u32)>) {
    let mut cells: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut places = Vec::new();
    let mut of: Vec<(u32, u32)> = points
        .iter()
        .map(|&(place, i)| {
            let probe = *cells.entry(place.map(|c| (c / side).floor() as i64)).or_insert_with(|| {
                places.push(place);
                places.len() as u32 - 1
            });
            (i, probe)
        })
        .collect();
    of.sort_unstable();
    of.dedup();
    (places, of)
}
