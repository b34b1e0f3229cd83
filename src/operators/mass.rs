//! How much surface each point of a cloud stands for.

use std::f64::consts::PI;

use crate::graph::Neighbours;

/// Neighbours whose discs tell the total area. Fewer are too regular, more reach across thin limbs.
const NEAR: std::ops::RangeInclusive<usize> = 3..=8;

/// Area per point (n) in unit², from discs around it.
///
/// How the area is shared follows the disc out to the k-th of all neighbours, which is smooth. How much there is in all follows the growth of πr² per
/// neighbour among the nearest few: the slope is the area per point whether points are scattered at random (πr_k² ≈ k areas) or
/// evenly (k + ½ areas), and stays clear of the other side of thin limbs. Of the true area of bodies of 5000 points this finds
/// 97 to 103 %; discs out to the 20th neighbour alone find 87 to 95 %.
pub fn cloud_mass(neighbours: &Neighbours) -> Vec<f64> {
    let disc = |i: usize, k: usize| neighbours.distances(i).get(k - 1).map_or(0.0, |r| PI * r * r);
    let shares: Vec<f64> = (0..neighbours.len()).map(|i| disc(i, neighbours.k().max(1))).collect();
    let mean = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
    // A point buried under more than k copies of itself has an empty disc; it still needs some mass to have a spectrum.
    let shares: Vec<f64> = shares.into_iter().map(|share| share.max(1e-6 * mean)).collect();
    let total: f64 = (0..neighbours.len()).map(|i| slope(NEAR.map(|k| (k as f64, disc(i, k))))).sum();
    let scale = total.max(0.0) / shares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    // Where the nearest discs are all empty (every point many times over) the far ones are what there is.
    let scale = if scale > 0.0 { scale } else { 1.0 / neighbours.k().max(1) as f64 };
    shares.into_iter().map(|share| share * scale).collect()
}

/// Slope of the least-squares line through (x, y).
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let count = points.clone().count() as f64;
    let (mean_x, mean_y) = points.clone().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (covariance, variance) =
        points.fold((0.0, 0.0), |(c, v), (x, y)| (c + (x - mean_x) * (y - mean_y), v + (x - mean_x).powi(2)));
    covariance / variance
}
