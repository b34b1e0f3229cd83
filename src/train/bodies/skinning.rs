//! Dual quaternion skinning: the skin follows the bones without collapsing at twisted or bent joints.
//!
//! Kavan, Collins, Žára, O'Sullivan: *Geometric skinning with approximate dual quaternion blending* (2008).

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::skeleton::Motion;

/// Sparse skinning weights: for each vertex the bones that move it, heaviest first; weights sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    rows: Vec<Vec<(usize, f64)>>,
}

impl Weights {
    /// From (vertex, weight) lists, one per bone. Vertices beyond `vertices` (helpers) are ignored; a vertex no bone moves
    /// is an error.
    pub fn from_bones(vertices: usize, by_bone: &[Vec<(u32, f64)>]) -> Result<Self, String> {
        let mut rows = vec![Vec::new(); vertices];
        for (bone, list) in by_bone.iter().enumerate() {
            for &(vertex, weight) in list.iter().filter(|&&(v, w)| (v as usize) < vertices && w > 0.0) {
                rows[vertex as usize].push((bone, weight));
            }
        }
        for (vertex, row) in rows.iter_mut().enumerate() {
            let sum: f64 = row.iter().map(|&(_, w)| w).sum();
            if sum <= 0.0 || !sum.is_finite() {
                return Err(format!("vertex {vertex} has no weights"));
            }
            row.iter_mut().for_each(|(_, w)| *w /= sum);
            *row = heaviest_first(std::mem::take(row));
        }
        Ok(Self { rows })
    }

    /// Weights of vertices that are means of these: one stencil of (vertex, share) for each.
    pub fn refined(&self, stencils: &[Vec<(u32, f64)>]) -> Self {
        let blend = |stencil: &Vec<(u32, f64)>| {
            let mut sums = BTreeMap::new();
            for &(vertex, share) in stencil {
                for &(bone, weight) in &self.rows[vertex as usize] {
                    *sums.entry(bone).or_insert(0.0) += share * weight;
                }
            }
            heaviest_first(sums.into_iter().collect())
        };
        Self { rows: stencils.iter().map(blend).collect() }
    }

    /// One row per vertex: (bone, weight), heaviest first.
    pub fn rows(&self) -> &[Vec<(usize, f64)>] {
        &self.rows
    }
}

fn heaviest_first(mut row: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    row
}

/// Posed positions of the first `weights.rows().len()` vertices of `rest`.
pub fn skin(rest: &[DVec3], weights: &Weights, motions: &[Motion]) -> Vec<DVec3> {
    let duals: Vec<_> = motions.iter().map(dual_quaternion).collect();
    let blend = |row: &[(usize, f64)]| {
        let pivot = duals[row[0].0].0;
        let (mut real, mut dual) = (DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        for &(bone, weight) in row {
            let (r, d) = duals[bone];
            let weight = if r.dot(pivot) < 0.0 { -weight } else { weight };
            (real, dual) = (real + r * weight, dual + d * weight);
        }
        let length = real.length();
        let (real, dual) = (real * (1.0 / length), dual * (1.0 / length));
        let shift = dual * real.conjugate();
        Motion { rotation: real, translation: 2.0 * DVec3::new(shift.x, shift.y, shift.z) }
    };
    rest.iter().zip(&weights.rows).map(|(&x, row)| blend(row).apply(x)).collect()
}

/// Real and dual part of a rigid motion.
fn dual_quaternion(motion: &Motion) -> (DQuat, DQuat) {
    let t = motion.translation;
    (motion.rotation, DQuat::from_xyzw(t.x, t.y, t.z, 0.0) * motion.rotation * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of points along x, moved by two bones that meet at x = 1: the first holds x ≤ 0.5, the second x ≥ 1.5.
    fn bar() -> (Vec<DVec3>, Weights) {
        let rest: Vec<DVec3> = (0..=20).map(|i| DVec3::new(f64::from(i) / 10.0, 0.2, -0.1)).collect();
        let second = |p: &DVec3| (p.x - 0.5).clamp(0.0, 1.0);
        let column = |f: &dyn Fn(&DVec3) -> f64| rest.iter().enumerate().map(|(i, p)| (i as u32, f(p))).collect();
        let weights = Weights::from_bones(rest.len(), &[column(&|p| 1.0 - second(p)), column(&second)]);
        (rest, weights.expect("every point has a bone"))
    }

    #[test]
    fn still_bones_leave_the_skin_at_rest() {
        let (rest, weights) = bar();
        let posed = skin(&rest, &weights, &[Motion::IDENTITY; 2]);
        assert!(rest.iter().zip(&posed).all(|(a, b)| a.distance(*b) < 1e-15));
    }

    #[test]
    fn bones_that_move_together_carry_the_skin_rigidly() {
        let (rest, weights) = bar();
        let motion = Motion { rotation: DQuat::from_rotation_y(2.0), translation: DVec3::new(1.0, -2.0, 0.5) };
        // The same rotation with the other sign of its quaternion.
        let same = Motion { rotation: -motion.rotation, ..motion };
        let posed = skin(&rest, &weights, &[motion, same]);
        assert!(rest.iter().zip(&posed).all(|(a, b)| motion.apply(*a).distance(*b) < 1e-14));
    }

    #[test]
    fn a_half_turn_about_the_bar_does_not_collapse_it() {
        let (rest, weights) = bar();
        let turned = Motion { rotation: DQuat::from_rotation_x(3.1), translation: DVec3::ZERO };
        let posed = skin(&rest, &weights, &[Motion::IDENTITY, turned]);
        // Linear blending would put the middle of the bar on its axis.
        let radius = DVec3::new(0.0, 0.2, -0.1).length();
        assert!(posed.iter().all(|p| (DVec3::new(0.0, p.y, p.z).length() - radius).abs() < 1e-12));
    }

    #[test]
    fn a_vertex_without_a_bone_is_refused() {
        assert!(Weights::from_bones(2, &[vec![(0, 1.0)]]).is_err());
    }
}
