//! Dual quaternion skinning: the skin follows the bones without collapsing at twisted or bent joints.
//!
//! Kavan, Collins, Žára, O'Sullivan: *Geometric skinning with approximate dual quaternion blending* (2008).

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
            row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        }
        Ok(Self { rows })
    }

    /// One row per vertex: (bone, weight), heaviest first.
    pub fn rows(&self) -> &[Vec<(usize, f64)>] {
        &self.rows
    }
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
