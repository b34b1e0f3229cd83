//! One step of Loop subdivision, kept as fixed combinations of the coarse vertices, so that it follows any shape and pose.
//!
//! Loop: *Smooth subdivision surfaces based on triangles* (1987), with Warren's simpler weights for the old vertices.

use std::collections::BTreeMap;

use glam::DVec3;

/// A closed triangle mesh, four times as fine as the one it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// Triangles over the fine vertices, wound as before.
    pub triangles: Vec<[u32; 3]>,
    /// For each fine vertex the coarse vertices it is a mean of, with weights that sum to 1. A moved old vertex names itself first.
    pub stencils: Vec<Vec<(u32, f64)>>,
}

impl Refined {
    /// Refines a closed mesh. Coarse vertices that no triangle uses get no fine vertex.
    pub fn of_mesh(triangles: &[[u32; 3]]) -> Self {
        // For each edge the vertices opposite to it, and for each vertex its neighbours.
        let mut opposite: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
        let mut rings: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[a, b, c] in triangles {
            for (a, b, c) in [(a, b, c), (b, c, a), (c, a, b)] {
                opposite.entry(ordered(a, b)).or_default().push(c);
                rings.entry(a).or_default().push(b);
            }
        }
        let mut stencils = Vec::with_capacity(rings.len() + opposite.len());
        let mut places = BTreeMap::new();
        for (&v, ring) in &rings {
            let n = ring.len() as f64;
            let share = if ring.len() == 3 { 3.0 / 16.0 } else { 3.0 / (8.0 * n) };
            places.insert((v, v), stencils.len() as u32);
            stencils.push(std::iter::once((v, 1.0 - n * share)).chain(ring.iter().map(|&w| (w, share))).collect());
        }
        for (&(a, b), others) in &opposite {
            places.insert((a, b), stencils.len() as u32);
            let far = others.iter().map(|&c| (c, 0.25 / others.len() as f64));
            stencils.push([(a, 0.375), (b, 0.375)].into_iter().chain(far).collect());
        }
        let split = |&[a, b, c]: &[u32; 3]| {
            let at = |v, w| places[&ordered(v, w)];
            let (ab, bc, ca) = (at(a, b), at(b, c), at(c, a));
            [[at(a, a), ab, ca], [at(b, b), bc, ab], [at(c, c), ca, bc], [ab, bc, ca]]
        };
        Self { triangles: triangles.iter().flat_map(split).collect(), stencils }
    }

    /// Positions of the fine vertices where the coarse ones are at `coarse`.
    pub fn positions(&self, coarse: &[DVec3]) -> Vec<DVec3> {
        let mean = |stencil: &Vec<(u32, f64)>| stencil.iter().map(|&(v, w)| w * coarse[v as usize]).sum();
        self.stencils.iter().map(mean).collect()
    }
}

fn ordered(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::manifold::is_closed_manifold;

    /// Triangles of an octahedron over ±x, ±y, ±z in this order.
    const OCTAHEDRON: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

    #[test]
    fn a_refined_octahedron_is_closed_and_rounder() {
        let fine = Refined::of_mesh(&OCTAHEDRON);
        assert_eq!((fine.stencils.len(), fine.triangles.len()), (18, 32));
        assert!(is_closed_manifold(18, &fine.triangles));
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let radii: Vec<f64> = fine.positions(&axes).iter().map(|p| p.length()).collect();
        // Old vertices 1 − 4·3/32, new ones |(3/8, 3/8, 0)| (their opposite corners cancel).
        assert!(radii[..6].iter().all(|r| (r - 0.625).abs() < 1e-15));
        assert!(radii[6..].iter().all(|r| (r - 0.375 * 2f64.sqrt()).abs() < 1e-15));
    }
}
