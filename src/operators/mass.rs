//! How much surface each point of a cloud stands for.

use crate::graph::Neighbours;

/// Area per point from its k nearest neighbours, in unit².
///
/// The disc out to the k-th neighbour holds the point itself, k − 1 neighbours and half of the k-th, so it is shared by
/// k + ½ points. Coincident points share one disc among all its copies the same way.
pub fn cloud_mass(neighbours: &Neighbours) -> Vec<f64> {
    let k = neighbours.k();
    let share = |r: f64| std::f64::consts::PI * r * r / (k as f64 + 0.5);
    let areas: Vec<f64> =
        (0..neighbours.len()).map(|i| share(neighbours.distances(i).last().copied().unwrap_or(0.0))).collect();
    // A point buried under more than k copies of itself has an empty disc; it still needs some mass to have a spectrum.
    let floor = 1e-6 * areas.iter().sum::<f64>() / areas.len().max(1) as f64;
    areas.into_iter().map(|a| a.max(floor)).collect()
}
