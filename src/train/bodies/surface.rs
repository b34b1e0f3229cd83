//! The outer skin as one closed triangle mesh over body vertices: mouth cavity and eye sockets cut away.
//!
//! The base mesh's skin is a closed surface that folds in at the mouth and behind the eyes. Patches that no ray from outside
//! reaches are cut out and their rims (lips, lids) closed with the triangles of least area, so no vertex is new.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::data::BodyData;

/// A face seen along fewer than this share of the directions of its hemisphere is hidden. From 3 to 15 % the same three large
/// patches result, each a disc (mouth, both eye sockets); at 0 the mouth's has holes.
const SEEN: f64 = 0.05;
/// Rays per face.
const RAYS: usize = 48;
/// A hidden patch of fewer quads (a fold of the ear, a nostril's end) stays: cavities here have 300 and more.
const CAVITY: usize = 100;

/// Triangles (vertex indices of the base mesh) of the closed outer skin, wound outwards.
pub fn outer_skin(data: &BodyData) -> Vec<[u32; 3]> {
    let quads = data.groups.get("body").map(Vec::as_slice).unwrap_or_default();
    let head = data.bones.iter().position(|b| b.name == "head");
    let in_head = |v: u32| data.weights.rows().get(v as usize).is_some_and(|row| Some(row[0].0) == head);
    let head_quads: Vec<usize> = (0..quads.len()).filter(|&q| quads[q].iter().all(|&v| in_head(v))).collect();

    let eyes = ["helper-l-eye", "helper-r-eye"].into_iter().filter_map(|g| data.groups.get(g)).flatten();
    let walls: Vec<_> = head_quads.iter().map(|&q| &quads[q]).chain(eyes).flat_map(|q| halves(*q)).collect();
    let walls: Vec<[DVec3; 3]> = walls.iter().map(|t| t.map(|v| data.base[v as usize])).collect();
    let hidden = head_quads.into_iter().filter(|&q| is_hidden(quads[q].map(|v| data.base[v as usize]), &walls));

    let cut: BTreeSet<usize> =
        patches(quads, hidden.collect()).into_iter().filter(|p| p.len() >= CAVITY).flatten().collect();
    let kept = (0..quads.len()).filter(|q| !cut.contains(q));
    let mut triangles: Vec<[u32; 3]> = kept.flat_map(|q| halves(quads[q])).collect();
    let edges: BTreeSet<_> =
        triangles.iter().flat_map(|&[a, b, c]| [ordered(a, b), ordered(b, c), ordered(c, a)]).collect();
    for rim in rims(&triangles) {
        triangles.extend(close(&rim, &data.base, |a, b| edges.contains(&ordered(a, b))));
    }
    triangles
}

fn halves([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// Whether fewer than [`SEEN`] of the rays leaving the face's centre miss every wall.
fn is_hidden(corners: [DVec3; 4], walls: &[[DVec3; 3]]) -> bool {
    let [a, b, c, d] = corners;
    let Some(normal) = (c - a).cross(d - b).try_normalize() else { return false };
    let (u, v) = normal.any_orthonormal_pair();
    let from = (a + b + c + d) / 4.0 + 1e-3 * normal;
    let mut seen = 0;
    for k in 0..RAYS {
        // A Fibonacci spiral: evenly spread over the hemisphere.
        let height = 1.0 - (k as f64 + 0.5) / RAYS as f64;
        let (sin, cos) = (std::f64::consts::PI * (1.0 + 5f64.sqrt()) * k as f64).sin_cos();
        let to = (1.0 - height * height).sqrt() * (cos * u + sin * v) + height * normal;
        seen += usize::from(!walls.iter().any(|w| is_crossed(w, from, to)));
        if seen as f64 >= SEEN * RAYS as f64 {
            return false;
        }
    }
    true
}

/// Möller–Trumbore, either side of the triangle.
fn is_crossed([a, b, c]: &[DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let (e1, e2, s) = (b - a, c - a, from - a);
    let p = to.cross(e2);
    let det = e1.dot(p);
    let u = s.dot(p) / det;
    if !(0.0..=1.0).contains(&u) {
        return false;
    }
    let q = s.cross(e1);
    let v = to.dot(q) / det;
    v >= 0.0 && u + v <= 1.0 && e2.dot(q) / det > 1e-6
}

/// Quads grouped by shared edges.
fn patches(quads: &[[u32; 4]], mut left: BTreeSet<usize>) -> Vec<Vec<usize>> {
    let edges = |q: usize| (0..4).map(move |k| ordered(quads[q][k], quads[q][(k + 1) % 4]));
    let mut by_edge: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for &q in &left {
        edges(q).for_each(|e| by_edge.entry(e).or_default().push(q));
    }
    let mut patches = Vec::new();
    while let Some(first) = left.pop_first() {
        let mut patch = vec![first];
        let mut next = 0;
        while next < patch.len() {
            for e in edges(patch[next]) {
                patch.extend(by_edge[&e].iter().filter(|q| left.remove(q)));
            }
            next += 1;
        }
        patches.push(patch);
    }
    patches
}

fn ordered(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// Loops of boundary edges, each as vertices in the direction that continues the surface's winding across the hole.
pub fn rims(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut open: BTreeMap<u32, u32> = BTreeMap::new();
    let directed: BTreeSet<(u32, u32)> = triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    for &(a, b) in directed.iter().filter(|&&(a, b)| !directed.contains(&(b, a))) {
        open.insert(b, a);
    }
    let mut loops = Vec::new();
    while let Some((first, mut at)) = open.pop_first() {
        let mut rim = vec![first];
        while at != first {
            rim.push(at);
            match open.remove(&at) {
                Some(next) => at = next,
                None => break,
            }
        }
        loops.push(rim);
    }
    loops
}

/// Triangulates a loop with least total area (dynamic programming over its diagonals). No diagonal repeats an edge for which
/// `exists`, as that would give the edge four triangles.
pub fn close(rim: &[u32], positions: &[DVec3], exists: impl Fn(u32, u32) -> bool) -> Vec<[u32; 3]> {
    let n = rim.len();
    let at = |i: usize| positions[rim[i] as usize];
    let (mut best, mut split) = (vec![vec![0f64; n]; n], vec![vec![0; n]; n]);
    for span in 2..n {
        for i in 0..n - span {
            let k = i + span;
            let area = |j: usize| best[i][j] + best[j][k] + 0.5 * (at(j) - at(i)).cross(at(k) - at(i)).length();
            let least = (i + 1..k).map(|j| (area(j), j)).min_by(|a, b| a.0.total_cmp(&b.0));
            let (least, j) = least.unwrap_or((0.0, i + 1));
            let repeats = span + 1 < n && exists(rim[i], rim[k]);
            (best[i][k], split[i][k]) = (if repeats { f64::INFINITY } else { least }, j);
        }
    }
    let (mut triangles, mut todo) = (Vec::new(), vec![(0, n.saturating_sub(1))]);
    while let Some((i, k)) = todo.pop() {
        if k > i + 1 {
            let j = split[i][k];
            triangles.push([rim[i], rim[j], rim[k]]);
            todo.extend([(i, j), (j, k)]);
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::manifold::is_closed_manifold;

    #[test]
    fn a_cut_surface_is_closed_again_with_outward_winding() {
        // An octahedron without the four faces of its upper half, whose rim is a square.
        let lower = [[0, 3, 5], [3, 1, 5], [1, 2, 5], [2, 0, 5]];
        let ring = [DVec3::X, DVec3::NEG_X, DVec3::NEG_Z, DVec3::Z, DVec3::Y, DVec3::NEG_Y];
        let rims = rims(&lower);
        assert_eq!(rims.len(), 1);
        let mut all = lower.to_vec();
        all.extend(close(&rims[0], &ring, |a, b| (a, b) == (2, 3) || (a, b) == (3, 2)));
        assert_eq!(all.len(), 6);
        assert!(all[4..].iter().all(|t| t.contains(&0) && t.contains(&1)), "the other diagonal was forbidden");
        // Vertex 4, the cut-off top, is gone.
        let renumbered: Vec<[u32; 3]> = all.iter().map(|t| t.map(|v| if v == 5 { 4 } else { v })).collect();
        assert!(is_closed_manifold(5, &renumbered));
    }
}
