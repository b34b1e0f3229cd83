//! Fewer vertices by half-edge collapse, evenly spaced to a chosen size; every kept vertex is one of the given ones.
//!
//! Quadric errors after Garland, Heckbert: *Surface simplification using quadric error metrics* (1997). The order of collapses is
//! governed by the longest edge each makes, over the wanted length at that place, so the result is even; the quadric keeps the
//! form. Tried and dropped: the length of the collapsed edge, which left edges of 4 times the mean across long thin quads (now 2).

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use glam::DVec3;

use super::quadric::Quadric;

/// How much the mean squared distance to the removed planes counts beside the squared longest new edge. On the neutral body, by
/// eye: 0 wears off fingers, ears and lips, 20 the ears; 100 makes the worst triangle a third worse.
const FORM: f64 = 50.0;
/// A collapse may turn a triangle's normal by at most 60°.
const TURN: f64 = 0.5;
/// Least shape quality of a triangle (1 equilateral, 0 a line) after a collapse, unless it was worse before.
const QUALITY: f64 = 0.25;

/// Collapses edges of a closed manifold until `count` vertices are left; fewer collapses when no allowed one remains.
///
/// `size[v]` is the wanted edge length at vertex `v` up to a common factor. Returns the kept vertices in ascending order and
/// triangles that index into them.
pub fn simplify(positions: &[DVec3], triangles: &[[u32; 3]], size: &[f64], count: usize) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut mesh = Collapsing::new(positions, triangles, size);
    let mut queue: BinaryHeap<Reverse<Candidate>> = BinaryHeap::new();
    let used: BTreeSet<u32> = triangles.iter().flatten().copied().collect();
    for &v in &used {
        mesh.ring(v).into_iter().for_each(|to| queue.push(Reverse(mesh.candidate(v, to))));
    }
    let mut left = used.len();
    while left > count {
        let Some(Reverse(next)) = queue.pop() else { break };
        if !mesh.may_collapse(next.from, next.to) {
            continue;
        }
        // Its surroundings may have changed since it was queued.
        let now = mesh.candidate(next.from, next.to);
        if now.cost > next.cost {
            queue.push(Reverse(now));
            continue;
        }
        mesh.collapse(next.from, next.to);
        left -= 1;
        for v in mesh.ring(next.to) {
            queue.push(Reverse(mesh.candidate(v, next.to)));
            queue.push(Reverse(mesh.candidate(next.to, v)));
            // Its other edges may have become cheaper or allowed.
            mesh.ring(v).into_iter().filter(|&w| w != next.to).for_each(|w| {
                queue.push(Reverse(mesh.candidate(v, w)));
                queue.push(Reverse(mesh.candidate(w, v)));
            });
        }
    }
    mesh.flip_to_delaunay();
    mesh.finish()
}

/// Remove `from`, moving its triangles to `to`. Ordered by cost, then by index, so that equal costs do not depend on chance.
#[derive(PartialEq)]
struct Candidate {
    cost: f64,
    from: u32,
    to: u32,
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.cost.total_cmp(&other.cost).then_with(|| (self.from, self.to).cmp(&(other.from, other.to)))
    }
}

struct Collapsing<'a> {
    positions: &'a [DVec3],
    size: &'a [f64],
    /// `None` once collapsed away.
    triangles: Vec<Option<[u32; 3]>>,
    /// Triangles at each vertex.
    around: Vec<BTreeSet<usize>>,
    quadrics: Vec<Quadric>,
}

impl<'a> Collapsing<'a> {
    fn new(positions: &'a [DVec3], triangles: &[[u32; 3]], size: &'a [f64]) -> Self {
        let mut around = vec![BTreeSet::new(); positions.len()];
        let mut quadrics = vec![Quadric::ZERO; positions.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            let quadric = Quadric::of_triangle(triangle.map(|v| positions[v as usize]));
            for &v in triangle {
                around[v as usize].insert(t);
                quadrics[v as usize] = quadrics[v as usize].plus(quadric);
            }
        }
        let triangles = triangles.iter().copied().map(Some).collect();
        Self { positions, size, triangles, around, quadrics }
    }

    fn at(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    /// Triangles at a vertex.
    fn fan(&self, v: u32) -> impl Iterator<Item = (usize, [u32; 3])> {
        self.around[v as usize].iter().filter_map(|&t| Some((t, self.triangles[t]?)))
    }

    /// Neighbours of a vertex.
    fn ring(&self, v: u32) -> BTreeSet<u32> {
        self.fan(v).flat_map(|(_, t)| t).filter(|&w| w != v).collect()
    }

    fn candidate(&self, from: u32, to: u32) -> Candidate {
        let (f, t) = (from as usize, to as usize);
        let wanted = (self.size[f] * self.size[t]).max(f64::MIN_POSITIVE);
        let form = self.quadrics[f].plus(self.quadrics[t]).at(self.at(to));
        let longest = self.ring(from).into_iter().map(|w| self.at(w).distance_squared(self.at(to))).fold(0.0, f64::max);
        Candidate { cost: (longest + FORM * form) / wanted, from, to }
    }

    /// The surface stays a manifold (more than a tetrahedron is left), no triangle folds over, none becomes a sliver.
    fn may_collapse(&self, from: u32, to: u32) -> bool {
        let (ring, other) = (self.ring(from), self.ring(to));
        if !ring.contains(&to) || ring.intersection(&other).count() != 2 || ring.union(&other).count() == 4 {
            return false;
        }
        self.fan(from).filter(|(_, t)| !t.contains(&to)).all(|(_, t)| {
            let before = t.map(|v| self.at(v));
            let after = t.map(|v| self.at(if v == from { to } else { v }));
            allowed(before, after)
        })
    }

    fn collapse(&mut self, from: u32, to: u32) {
        for t in std::mem::take(&mut self.around[from as usize]) {
            let Some(mut triangle) = self.triangles[t] else { continue };
            if triangle.contains(&to) {
                for v in triangle {
                    self.around[v as usize].remove(&t);
                }
                self.triangles[t] = None;
            } else {
                triangle.iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
                self.triangles[t] = Some(triangle);
                self.around[to as usize].insert(t);
            }
        }
        self.quadrics[to as usize] = self.quadrics[to as usize].plus(self.quadrics[from as usize]);
    }

    /// Flips edges whose opposite angles sum to more than 180°, where the surface stays the same up to [`TURN`].
    fn flip_to_delaunay(&mut self) {
        for _ in 0..10 {
            let mut flips = 0;
            for t in 0..self.triangles.len() {
                for k in 0..3 {
                    flips += usize::from(self.triangles[t].is_some_and(|tri| self.flip(t, tri, k)));
                }
            }
            if flips == 0 {
                break;
            }
        }
    }

    /// Tries to flip the edge opposite corner `k` of triangle `t`.
    fn flip(&mut self, t: usize, triangle: [u32; 3], k: usize) -> bool {
        let (c, a, b) = (triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]);
        let twin = self.fan(a).find(|&(o, tri)| o != t && tri.contains(&b)).map(|(o, _)| o);
        let Some((o, other)) = twin.and_then(|o| Some((o, self.triangles[o]?))) else { return false };
        let Some(d) = other.into_iter().find(|&v| v != a && v != b) else { return false };
        let angle = |at: u32| (self.at(a) - self.at(at)).angle_between(self.at(b) - self.at(at));
        if angle(c) + angle(d) <= std::f64::consts::PI + 1e-6 || self.ring(c).contains(&d) {
            return false;
        }
        let points = |tri: [u32; 3]| tri.map(|v| self.at(v));
        let (new_t, new_o) = ([c, a, d], [c, d, b]);
        let olds = [points(triangle), points(other)];
        let news = [points(new_t), points(new_o)];
        if !olds.iter().all(|old| news.iter().all(|new| normal(*old).dot(normal(*new)) > TURN)) {
            return false;
        }
        self.around[b as usize].remove(&t);
        self.around[a as usize].remove(&o);
        self.around[d as usize].insert(t);
        self.around[c as usize].insert(o);
        (self.triangles[t], self.triangles[o]) = (Some(new_t), Some(new_o));
        true
    }

    fn finish(self) -> (Vec<u32>, Vec<[u32; 3]>) {
        let triangles: Vec<[u32; 3]> = self.triangles.into_iter().flatten().collect();
        let kept: Vec<u32> = triangles.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
        let mut place = vec![0; self.positions.len()];
        kept.iter().zip(0..).for_each(|(&v, new)| place[v as usize] = new);
        let triangles = triangles.into_iter().map(|t| t.map(|v| place[v as usize])).collect();
        (kept, triangles)
    }
}

fn normal([p, q, r]: [DVec3; 3]) -> DVec3 {
    (q - p).cross(r - p).normalize_or_zero()
}

/// 1 for an equilateral triangle, 0 for a line.
fn quality([p, q, r]: [DVec3; 3]) -> f64 {
    let lengths = p.distance_squared(q) + q.distance_squared(r) + r.distance_squared(p);
    2.0 * 3f64.sqrt() * (q - p).cross(r - p).length() / lengths.max(f64::MIN_POSITIVE)
}

fn allowed(before: [DVec3; 3], after: [DVec3; 3]) -> bool {
    normal(before).dot(normal(after)) > TURN && quality(after) > QUALITY.min(quality(before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::manifold::{is_closed_manifold, tests::torus};

    /// Mean and longest edge.
    fn edges(positions: &[DVec3], kept: &[u32], triangles: &[[u32; 3]]) -> (f64, f64) {
        let at = |v: u32| positions[kept[v as usize] as usize];
        let lengths =
            triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)].map(|(a, b)| at(a).distance(at(b))));
        let (sum, longest) = lengths.fold((0.0, 0f64), |(s, l), x| (s + x, l.max(x)));
        (sum / (3 * triangles.len()) as f64, longest)
    }

    #[test]
    fn a_simplified_torus_is_a_torus_with_even_edges() {
        let (positions, triangles) = torus();
        let (kept, fewer) = simplify(&positions, &triangles, &vec![1.0; positions.len()], 300);
        assert_eq!(kept.len(), 300);
        // Euler's formula for genus 1.
        assert_eq!(fewer.len(), 2 * kept.len());
        assert!(is_closed_manifold(kept.len(), &fewer));
        let (mean, longest) = edges(&positions, &kept, &fewer);
        assert!(longest < 2.2 * mean, "mean {mean}, longest {longest}");
    }

    #[test]
    fn smaller_sizes_keep_more_vertices() {
        let (positions, triangles) = torus();
        let size: Vec<f64> = positions.iter().map(|p| if p.x > 0.0 { 0.5 } else { 1.0 }).collect();
        let (kept, _) = simplify(&positions, &triangles, &size, 300);
        let fine = kept.iter().filter(|&&v| positions[v as usize].x > 0.0).count();
        assert!(fine > 200, "{fine} of 300");
    }
}
