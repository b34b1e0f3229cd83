//! Where a posed body touches itself, and where it passes through itself.
//!
//! Some two thousand spots spread over the skin. Two spots that are far apart along the neutral body and near each other in space are in contact if they face
//! each other, and inside each other if each lies behind the other's tangent plane.

use glam::DVec3;

use super::cloud::farthest_points;
use crate::graph::{BoundedDijkstra, EdgeGraph};

/// Spots on the body: their mean distance is 3 cm on an adult.
const SPOTS: usize = 2000;
/// Closer along the neutral body than this (m), two spots are neighbours and never in contact: the crease of an elbow is none.
const APART: f64 = 0.15;
/// Spots farther away in space than this (m, as all below for a body of [`AREA`]) do not count.
const NEAR: f64 = 0.06;
/// Widest gap of a contact (m).
const GAP: f64 = 0.015;
/// Deeper than this is passing through (m).
const DEEP: f64 = 0.015;
/// The same inside a bent knee or elbow, where flesh is pressed together (m).
const CREASE: f64 = 0.03;
/// Surface of an adult in m².
const AREA: f64 = 1.8;

/// Spots and which of them are far apart along the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// Template vertex of each spot.
    pub spots: Vec<u32>,
    /// Place of each spot on the neutral body: metres, feet at y = 0, hips over the origin.
    pub neutral: Vec<DVec3>,
    /// Part label of each spot.
    pub parts: Vec<u32>,
    /// Bit j of row i: spots i and j are neighbours along the surface.
    neighbours: Vec<u64>,
}

/// What a pose does to the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Share of the spots that face a far-away part within the gap of a contact, or lie inside it.
    pub touching: f64,
    /// Share of the spots that lie deep inside another part.
    pub through: f64,
}

impl Reach {
    /// For a template whose vertices lie at `neutral` (metres) on the neutral body and belong to the parts `labels`.
    pub fn new(neutral: &[DVec3], triangles: &[[u32; 3]], labels: &[u32]) -> Self {
        let spots: Vec<u32> = farthest_points(neutral, SPOTS).into_iter().map(|i| i as u32).collect();
        let mut row_of = vec![usize::MAX; neutral.len()];
        spots.iter().enumerate().for_each(|(row, &v)| row_of[v as usize] = row);
        let edges = triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let length = |(a, b): (u32, u32)| (a, b, neutral[a as usize].distance(neutral[b as usize]));
        let graph = EdgeGraph::from_edges(neutral.len(), edges.map(length));
        let mut search = BoundedDijkstra::new(&graph);
        let words = spots.len().div_ceil(64);
        let mut neighbours = vec![0; spots.len() * words];
        for (row, &spot) in spots.iter().enumerate() {
            let reached = search.search(spot, APART);
            for (other, &vertex) in spots.iter().enumerate() {
                if reached.to(vertex) <= APART {
                    neighbours[row * words + other / 64] |= 1 << (other % 64);
                }
            }
        }
        let parts = spots.iter().map(|&v| labels[v as usize]).collect();
        Self { parts, neutral: spots.iter().map(|&v| neutral[v as usize]).collect(), spots, neighbours }
    }

    fn are_neighbours(&self, i: usize, j: usize) -> bool {
        self.neighbours[i * self.spots.len().div_ceil(64) + j / 64] >> (j % 64) & 1 == 1
    }

    /// Places and outward unit normals of the spots on a posed body, whose template vertices lie at `posed` (metres).
    pub fn frames(&self, posed: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<DVec3>) {
        let mut normals = vec![DVec3::ZERO; posed.len()];
        for t in triangles {
            let [p, q, r] = t.map(|v| posed[v as usize]);
            let normal = (q - p).cross(r - p);
            t.iter().for_each(|&v| normals[v as usize] += normal);
        }
        let place = |table: &[DVec3]| -> Vec<DVec3> { self.spots.iter().map(|&v| table[v as usize]).collect() };
        (place(posed), place(&normals).into_iter().map(DVec3::normalize_or_zero).collect())
    }

    /// Contact of a posed body, whose template vertices lie at `posed` (metres).
    pub fn contact(&self, posed: &[DVec3], triangles: &[[u32; 3]]) -> Contact {
        let scale = scale(posed, triangles);
        let (mut touching, mut through) = (0, 0);
        for (spot, nearest) in self.facing(posed, triangles, scale).into_iter().enumerate() {
            let Some((depth, other)) = nearest else { continue };
            let deep = if is_crease(self.parts[spot], self.parts[other]) { CREASE } else { DEEP };
            touching += usize::from(depth > -GAP * scale);
            through += usize::from(depth > deep * scale);
        }
        let share = |count: usize| count as f64 / self.spots.len().max(1) as f64;
        Contact { touching: share(touching), through: share(through) }
    }

    /// Places of the spots that touch another part, or lie inside it.
    pub fn touching(&self, posed: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
        let scale = scale(posed, triangles);
        let facing = self.facing(posed, triangles, scale);
        let touches = facing.iter().map(|nearest| nearest.is_some_and(|(depth, _)| depth > -GAP * scale));
        self.spots.iter().zip(touches).filter(|(_, touches)| *touches).map(|(&v, _)| posed[v as usize]).collect()
    }

    fn facing(&self, posed: &[DVec3], triangles: &[[u32; 3]], scale: f64) -> Vec<Option<(f64, usize)>> {
        let (places, normals) = self.frames(posed, triangles);
        self.depths(&places, &normals, NEAR * scale)
    }

    /// For each spot how deep it lies behind the tangent plane of the nearest spot that is no neighbour and faces it (negative: before it), and which it is, if
    /// there is one within `near`.
    fn depths(&self, places: &[DVec3], normals: &[DVec3], near: f64) -> Vec<Option<(f64, usize)>> {
        // Along x, so that only a slab of the body is compared with each spot.
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by(|&a, &b| places[a].x.total_cmp(&places[b].x));
        let mut nearest = vec![(near * near, None); places.len()];
        for (rank, &i) in order.iter().enumerate() {
            for &j in &order[rank + 1..] {
                let between = places[i] - places[j];
                if -between.x > near {
                    break;
                }
                let squared = between.length_squared();
                if squared >= nearest[i].0.max(nearest[j].0)
                    || normals[i].dot(normals[j]) > -0.1
                    || self.are_neighbours(i, j)
                {
                    continue;
                }
                if squared < nearest[i].0 {
                    nearest[i] = (squared, Some((-between.dot(normals[j]), j)));
                }
                if squared < nearest[j].0 {
                    nearest[j] = (squared, Some((between.dot(normals[i]), i)));
                }
            }
        }
        nearest.into_iter().map(|(_, depth)| depth).collect()
    }
}

/// Lengths of this body over those of one of [`AREA`].
fn scale(posed: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let area: f64 = triangles
        .iter()
        .map(|t| {
            let [p, q, r] = t.map(|v| posed[v as usize]);
            0.5 * (q - p).cross(r - p).length()
        })
        .sum();
    (area / AREA).sqrt()
}

/// Whether two parts are thigh and shank of one leg or upper arm and forearm of one arm.
fn is_crease(a: u32, b: u32) -> bool {
    a.abs_diff(b) == 2 && matches!(a.min(b), 2 | 3 | 8 | 9)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sheets 40 cm wide that face each other, the second `shift` above the first.
    fn sheets(shift: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (n, mut points, mut triangles) = (21u32, Vec::new(), Vec::new());
        for (height, up) in [(0.0, true), (shift, false)] {
            let first = points.len() as u32;
            for i in 0..n * n {
                points.push(DVec3::new(f64::from(i / n) * 0.02, height, f64::from(i % n) * 0.02));
            }
            for i in 0..n - 1 {
                for j in 0..n - 1 {
                    let at = |a: u32, b: u32| first + (i + a) * n + j + b;
                    let both = [[at(0, 0), at(0, 1), at(1, 0)], [at(1, 0), at(0, 1), at(1, 1)]];
                    triangles.extend(both.map(|[a, b, c]| if up { [a, b, c] } else { [a, c, b] }));
                }
            }
        }
        (points, triangles)
    }

    fn contact(shift: f64) -> Contact {
        let (neutral, triangles) = sheets(1.0);
        // A real body's surface is larger than the sheets': the scale of the thresholds goes with it.
        let scale = (AREA / (2.0 * 0.16)).sqrt();
        let large = |points: Vec<DVec3>| points.into_iter().map(|p| p * scale).collect::<Vec<_>>();
        Reach::new(&large(neutral), &triangles, &[1; 2 * 441]).contact(&large(sheets(shift).0), &triangles)
    }

    #[test]
    fn touching_is_told_from_passing_through() {
        assert_eq!(contact(0.1), Contact::default());
        let touching = contact(0.003);
        assert!(touching.touching > 0.4 && touching.through == 0.0, "{touching:?}");
        let through = contact(-0.009);
        assert!(through.through > 0.4, "{through:?}");
    }
}
