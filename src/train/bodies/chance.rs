//! Draws from the distributions that people, poses and scans are made of.

use std::ops::Range;

use glam::{DQuat, DVec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Uniform in the range.
pub fn uniform(rng: &mut ChaCha8Rng, range: Range<f64>) -> f64 {
    range.start + (range.end - range.start) * rng.random::<f64>()
}

/// True with the given probability.
pub fn happens(rng: &mut ChaCha8Rng, probability: f64) -> bool {
    rng.random::<f64>() < probability
}

/// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Three independent normals.
pub fn normal_vector(rng: &mut ChaCha8Rng) -> DVec3 {
    DVec3::new(normal(rng), normal(rng), normal(rng))
}

/// One of a list that is not empty.
pub fn pick<'a, T>(rng: &mut ChaCha8Rng, from: &'a [T]) -> &'a T {
    &from[((rng.random::<f64>() * from.len() as f64) as usize).min(from.len() - 1)]
}

/// One of a list, each with its share; the shares need not sum to 1.
pub fn pick_by<T: Copy>(rng: &mut ChaCha8Rng, from: &[(f64, T)]) -> T {
    let mut at = rng.random::<f64>() * from.iter().map(|f| f.0).sum::<f64>();
    for &(share, value) in from {
        at -= share;
        if at < 0.0 {
            return value;
        }
    }
    from[from.len() - 1].1
}

/// A rotation, evenly over all of them.
pub fn rotation(rng: &mut ChaCha8Rng) -> DQuat {
    let v = normal_vector(rng);
    DQuat::from_xyzw(v.x, v.y, v.z, normal(rng)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn normals_have_mean_zero_and_variance_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let drawn: Vec<f64> = (0..20_000).map(|_| normal(&mut rng)).collect();
        let mean = drawn.iter().sum::<f64>() / 20_000.0;
        let variance = drawn.iter().map(|x| x * x).sum::<f64>() / 20_000.0;
        // Standard errors 0.007 and 0.01.
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.04, "{mean} {variance}");
    }

    #[test]
    fn shares_decide_how_often_each_is_picked() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let heads = (0..10_000).filter(|_| pick_by(&mut rng, &[(3.0, true), (1.0, false)])).count();
        assert!((7300..7700).contains(&heads), "{heads}");
    }
}
