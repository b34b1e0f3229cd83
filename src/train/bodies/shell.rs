//! Shells: pieces of surface over the skin, with fewer vertices than it has, whose borders stay where they were cut.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::chance::{happens, uniform};
use crate::progress::Cancelled;
use crate::shape::{Shape, draw_together, farthest_points};

/// Samples inside a shell keep this share of the mean spacing from those on its border.
const FROM_BORDER: f64 = 0.6;
/// Pieces smaller than this share of the triangles are crumbs.
const CRUMB: f64 = 0.02;

/// A piece of surface that was made to be seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    /// What it is: `shirt`, `left shoe`.
    pub name: String,
    /// Metres.
    pub points: Vec<DVec3>,
    /// Over `points`.
    pub triangles: Vec<[u32; 3]>,
    /// The vertex of the skin below each point.
    pub below: Vec<u32>,
    /// What it hides of the skin.
    pub covers: Vec<Cover>,
    /// Whether it has a border on purpose.
    pub open: bool,
}

/// That a shell lies over a vertex of the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// Of the skin.
    pub vertex: u32,
    /// Metres above it.
    pub height: f64,
    /// The point of the shell there; `None` where the shell hides the skin and nothing of it lies just above.
    pub point: Option<u32>,
}

/// A part of the skin, cut out: its own vertices and triangles.
pub struct Cut {
    /// Vertices of the skin.
    pub vertices: Vec<u32>,
    /// Triangles over `vertices`.
    pub triangles: Vec<[u32; 3]>,
}

impl Cut {
    /// What the triangles that `kept` says yes to make up, without crumbs.
    pub fn of(triangles: &[[u32; 3]], kept: impl Fn([u32; 3]) -> bool) -> Self {
        let chosen: Vec<[u32; 3]> = triangles.iter().copied().filter(|&t| kept(t)).collect();
        let chosen = without_crumbs(chosen);
        let vertices: Vec<u32> = chosen.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
        let local: BTreeMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
        Self { triangles: chosen.iter().map(|t| t.map(|v| local[&v])).collect(), vertices }
    }

    /// The part of `all` at its vertices.
    pub fn pick<T: Copy>(&self, all: &[T]) -> Vec<T> {
        self.vertices.iter().map(|&v| all[v as usize]).collect()
    }

    /// Each vertex of a border and the one after it.
    pub fn border(&self) -> BTreeMap<u32, u32> {
        border(&self.triangles)
    }

    /// Moves borders inwards by `gap`, towards the neighbours inside.
    pub fn draw_back(&self, places: &mut [DVec3], gap: f64) {
        let border = self.border();
        let mut inner: BTreeMap<u32, (DVec3, f64)> = BTreeMap::new();
        for t in &self.triangles {
            for &v in t.iter().filter(|v| border.contains_key(v)) {
                for &w in t.iter().filter(|w| !border.contains_key(w)) {
                    let sum = inner.entry(v).or_insert((DVec3::ZERO, 0.0));
                    *sum = (sum.0 + places[w as usize], sum.1 + 1.0);
                }
            }
        }
        for (v, (sum, count)) in inner {
            let place = &mut places[v as usize];
            let way = sum / count - *place;
            *place += way * (gap / way.length().max(1e-9)).min(0.9);
        }
    }

    /// Makes a surface smoother: each place moves towards the mean of its neighbours, on a border of those on the border alone.
    pub fn smooth(&self, places: &mut [DVec3], times: usize) {
        let border = self.border();
        for _ in 0..times {
            let mut sums = vec![(DVec3::ZERO, 0.0); places.len()];
            let mut add = |v: u32, w: u32| {
                let sum = &mut sums[v as usize];
                *sum = (sum.0 + places[w as usize], sum.1 + 1.0);
            };
            for &[a, b, c] in &self.triangles {
                for (v, w) in [(a, b), (b, c), (c, a)] {
                    if !border.contains_key(&v) {
                        add(v, w);
                    }
                }
            }
            for (&v, &w) in &border {
                add(v, w);
                add(w, v);
            }
            for (place, (sum, count)) in places.iter_mut().zip(sums) {
                if count > 0.0 {
                    *place = place.lerp(sum / count, 0.5);
                }
            }
        }
    }

    /// About `count` of the vertices with `places`, evenly spread, also along the borders.
    pub fn shell(&self, name: &str, places: &[DVec3], heights: &[f64], count: usize, rng: &mut ChaCha8Rng) -> Shell {
        let simple = {
            let spots: Vec<[f64; 3]> = places.iter().map(DVec3::to_array).collect();
            let shape = Shape::already_valid(spots, self.triangles.clone(), None);
            let samples = self.samples(places, count, rng);
            let Ok(simple) = draw_together(&shape, &samples, samples.len(), &mut unheard) else {
                unreachable!("nobody cancels")
            };
            simple
        };
        let covers = self.vertices.iter().zip(&simple.cell).zip(heights);
        Shell {
            name: name.to_owned(),
            points: simple.vertices.iter().map(|&v| places[v as usize]).collect(),
            triangles: simple.faces,
            below: simple.vertices.iter().map(|&v| self.vertices[v as usize]).collect(),
            covers: covers.map(|((&vertex, &point), &height)| Cover { vertex, height, point: Some(point) }).collect(),
            open: !self.border().is_empty(),
        }
    }

    /// Vertices that stay: along each border at the mean spacing, and inside.
    fn samples(&self, places: &[DVec3], count: usize, rng: &mut ChaCha8Rng) -> Vec<u32> {
        let at = |v: u32| places[v as usize];
        let area: f64 = self.triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).length()).sum();
        let spacing = (0.5 * area / count as f64 * 1.15).sqrt();
        let border = self.border();
        let mut samples = Vec::new();
        let mut seen = BTreeSet::new();
        for &start in border.keys() {
            let (mut v, mut way) = (start, spacing);
            while seen.insert(v) {
                if way >= spacing {
                    samples.push(v);
                    way = 0.0;
                }
                let next = border[&v];
                way += at(v).distance(at(next));
                v = next;
            }
        }
        let on_border: Vec<DVec3> = samples.iter().map(|&v| at(v)).collect();
        let inside: Vec<u32> = (0..places.len() as u32).filter(|v| !border.contains_key(v)).collect();
        // A random half of them, so that no two shells of one surface are alike.
        let half: Vec<u32> = inside.iter().copied().filter(|_| happens(rng, 0.5)).collect();
        let from = if half.len() > 2 * count { half } else { inside };
        let spots: Vec<[f64; 3]> = places.iter().map(DVec3::to_array).collect();
        let spread = farthest_points(&spots, &from, count.saturating_sub(samples.len() / 2), &mut unheard);
        let near = (FROM_BORDER * spacing).powi(2);
        let clear = |&v: &u32| on_border.iter().all(|p| p.distance_squared(at(v)) > near);
        samples.extend(spread.unwrap_or_default().into_iter().filter(clear));
        samples
    }
}

impl Shell {
    /// The other side of the cloth: a shell `thickness` below (metres) that faces inwards.
    pub fn lining(&self, thickness: f64) -> Self {
        let mut points = self.points.clone();
        let normals = super::scan::normals(&self.points, &self.triangles);
        points.iter_mut().zip(normals).for_each(|(p, n)| *p -= thickness * n);
        let triangles = self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        Self { name: format!("{} lining", self.name), points, triangles, covers: Vec::new(), ..self.clone() }
    }

    /// Every face once more, the other way round.
    pub fn double(&mut self) {
        let back: Vec<[u32; 3]> = self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        self.triangles.extend(back);
    }

    /// Turns all faces round, or a random part of them.
    pub fn confuse(&mut self, rng: &mut ChaCha8Rng) {
        let share = if happens(rng, 0.5) { 1.0 } else { uniform(rng, 0.1..0.5) };
        for t in &mut self.triangles {
            if happens(rng, share) {
                t.swap(1, 2);
            }
        }
        self.triangles.shuffle(rng);
    }
}

/// Each vertex on a border of `triangles` and the one after it.
pub fn border(triangles: &[[u32; 3]]) -> BTreeMap<u32, u32> {
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let there: BTreeSet<(u32, u32)> = edges().collect();
    edges().filter(|&(a, b)| !there.contains(&(b, a))).collect()
}

fn without_crumbs(triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let mut root: BTreeMap<u32, u32> = triangles.iter().flatten().map(|&v| (v, v)).collect();
    fn find(root: &mut BTreeMap<u32, u32>, mut v: u32) -> u32 {
        while root[&v] != v {
            let up = root[&root[&v]];
            root.insert(v, up);
            v = up;
        }
        v
    }
    for &[a, b, c] in &triangles {
        for (v, w) in [(a, b), (b, c)] {
            let (v, w) = (find(&mut root, v), find(&mut root, w));
            root.insert(v.max(w), v.min(w));
        }
    }
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    let of: Vec<u32> = triangles.iter().map(|t| find(&mut root, t[0])).collect();
    of.iter().for_each(|&piece| *sizes.entry(piece).or_default() += 1);
    let least = CRUMB * triangles.len() as f64;
    triangles.into_iter().zip(of).filter(|(_, piece)| sizes[piece] as f64 > least).map(|(t, _)| t).collect()
}

fn unheard(_: f64) -> Result<(), Cancelled> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::manifold::tests::torus;
    use rand::SeedableRng;

    #[test]
    fn half_a_torus_keeps_its_two_rims_when_it_gets_fewer_vertices() {
        let (places, triangles) = torus();
        let cut = Cut::of(&triangles, |t| t.iter().all(|&v| places[v as usize].x > 0.0));
        let all = cut.pick(&places);
        let rim = |points: &[DVec3], next: &BTreeMap<u32, u32>| -> f64 {
            next.iter().map(|(&v, &w)| points[v as usize].distance(points[w as usize])).sum()
        };
        let heights = vec![0.0; all.len()];
        let shell = cut.shell("half", &all, &heights, 150, &mut ChaCha8Rng::seed_from_u64(1));
        assert!((80..200).contains(&shell.points.len()), "{}", shell.points.len());
        let share = rim(&shell.points, &border(&shell.triangles)) / rim(&all, &cut.border());
        assert!((0.85..1.02).contains(&share), "{share}");
        assert!(shell.covers.iter().all(|c| c.point.is_some_and(|p| (p as usize) < shell.points.len())));
    }
}
