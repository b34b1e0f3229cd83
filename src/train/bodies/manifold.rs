//! Whether triangles make a closed surface.

use std::collections::BTreeMap;

/// Whether every edge has exactly two triangles, in opposite directions, and the triangles at every vertex form one fan.
pub fn is_closed_manifold(vertices: usize, triangles: &[[u32; 3]]) -> bool {
    let mut next = vec![BTreeMap::new(); vertices];
    for &[a, b, c] in triangles {
        for (at, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            if at == from || next[at as usize].insert(from, to).is_some() {
                return false;
            }
        }
    }
    next.iter().all(|fan| {
        let Some((&first, _)) = fan.first_key_value() else { return false };
        fan_length(fan, first) == fan.len()
    })
}

/// Steps until the fan comes back to `first`, at most one more than it has.
fn fan_length(fan: &BTreeMap<u32, u32>, first: u32) -> usize {
    let (mut at, mut steps) = (first, 0);
    loop {
        steps += 1;
        match fan.get(&at) {
            Some(&to) if to != first && steps <= fan.len() => at = to,
            _ => return steps,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::f64::consts::TAU;

    use glam::DVec3;

    use super::*;

    /// A torus of 40 × 20 vertices, about 0.3 apart along both circles of its outer rim.
    pub fn torus() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (n, m) = (40, 20);
        let at = |i: u32, j: u32| (i % n) * m + j % m;
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..n {
            for j in 0..m {
                let (u, v) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
                positions.push(DVec3::new((2.0 + v.cos()) * u.cos(), v.sin(), (2.0 + v.cos()) * u.sin()));
                triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
                triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
            }
        }
        (positions, triangles)
    }

    #[test]
    fn broken_surfaces_are_told_from_closed_ones() {
        let (positions, mut triangles) = torus();
        assert!(is_closed_manifold(positions.len(), &triangles));
        assert!(!is_closed_manifold(positions.len() + 1, &triangles), "a vertex without triangles");
        triangles[5].swap(0, 1);
        assert!(!is_closed_manifold(positions.len(), &triangles), "a turned triangle");
        triangles.remove(5);
        assert!(!is_closed_manifold(positions.len(), &triangles), "a hole");
        // Two tetrahedra that touch in vertex 0.
        let tetrahedron = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let both: Vec<_> =
            tetrahedron.into_iter().chain(tetrahedron.map(|t| t.map(|v| if v == 0 { 0 } else { v + 3 }))).collect();
        assert!(is_closed_manifold(4, &tetrahedron));
        assert!(!is_closed_manifold(7, &both));
    }
}
