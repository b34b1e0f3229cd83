//! Random rotations of whole shapes, to see what a method owes to the frame its data came in.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::random::SplitMix64;
use super::selection::fnv1a_64;
use crate::shape::Axis;
use crate::vector::{Vector, cross};

/// Which rotations shapes get.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rotate {
    /// None: files as they stand.
    #[default]
    None,
    /// By any angle about the axis that points up, as scans of standing bodies differ.
    Up,
    /// Any rotation, all equally likely.
    So3,
}

impl Rotate {
    /// The points of shape `name` turned about the origin. The rotation depends on seed and name alone, so that a shape
    /// is turned alike whichever pairs are measured.
    pub(super) fn turn(self, points: &[Vector], name: &str, seed: u64, up: Axis) -> Vec<Vector> {
        let mut random = SplitMix64::new(seed ^ fnv1a_64(name.as_bytes()));
        let quaternion = match self {
            Rotate::None => return points.to_vec(),
            Rotate::Up => {
                let (sin, cos) = (0.5 * TAU * random.unit()).sin_cos();
                let mut q = [cos, 0.0, 0.0, 0.0];
                q[1 + up as usize] = sin;
                q
            }
            // Shoemake 1992, "Uniform random rotations".
            Rotate::So3 => {
                let (share, first, second) = (random.unit(), TAU * random.unit(), TAU * random.unit());
                let (p, q) = ((1.0 - share).sqrt(), share.sqrt());
                [p * first.sin(), p * first.cos(), q * second.sin(), q * second.cos()]
            }
        };
        points.iter().map(|&point| turned(point, quaternion)).collect()
    }
}

/// A vector turned by a unit quaternion (w, x, y, z): v + 2u × (u × v + w v).
fn turned(v: Vector, [w, x, y, z]: [f64; 4]) -> Vector {
    let u = [x, y, z];
    let inner = cross(u, v);
    let outer = cross(u, std::array::from_fn(|c| inner[c] + w * v[c]));
    std::array::from_fn(|c| v[c] + 2.0 * outer[c])
}

#[cfg(test)]
mod tests {
    use super::{Rotate, Vector};
    use crate::shape::Axis;
    use crate::vector::{cross, dot, minus};

    const FRAME: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn turned(rotate: Rotate, name: &str, seed: u64) -> [Vector; 3] {
        rotate.turn(&FRAME, name, seed, Axis::Y).try_into().expect("three")
    }

    #[test]
    fn shapes_are_turned_rigidly_each_by_its_own_name_and_the_seed() {
        for rotate in [Rotate::Up, Rotate::So3] {
            for name in ["a", "b", "c"] {
                let [x, y, z] = turned(rotate, name, 7);
                assert!((dot(x, x) - 1.0).abs() < 1e-12 && dot(x, y).abs() < 1e-12);
                assert!(minus(cross(x, y), z).iter().all(|c| c.abs() < 1e-12), "no reflection");
                assert_eq!(y == FRAME[1], rotate == Rotate::Up, "up stays up");
            }
            assert_ne!(turned(rotate, "a", 7), turned(rotate, "b", 7));
            assert_ne!(turned(rotate, "a", 7), turned(rotate, "a", 8));
            assert_eq!(turned(rotate, "a", 7), turned(rotate, "a", 7));
        }
        assert_eq!(turned(Rotate::None, "a", 7), FRAME);
    }

    #[test]
    fn all_rotations_are_equally_likely() {
        // E[R] = 0 and E[tr²R] = 1 for Haar measure on SO(3).
        let count = 20_000;
        let (mut mean, mut squared_trace) = ([0.0; 9], 0.0);
        for seed in 0..count {
            let r = turned(Rotate::So3, "a", seed);
            r.as_flattened().iter().zip(&mut mean).for_each(|(v, m)| *m += v / count as f64);
            squared_trace += (r[0][0] + r[1][1] + r[2][2]).powi(2) / count as f64;
        }
        assert!(mean.iter().all(|m| m.abs() < 0.02), "{mean:?}");
        assert!((squared_trace - 1.0).abs() < 0.05, "{squared_trace}");
    }
}
