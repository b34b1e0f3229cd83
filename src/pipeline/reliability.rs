//! How far a scan can be relied on, before it is matched: confidence is of matches between scans that say where the surface is.

use super::PreparedShape;
use super::geometry::Carriers;
use crate::shape::{Repair, coarse_steps};
use crate::vector::longest_side;

/// A cloud is too thin where a point's eighth neighbour is farther away than this part of the longest side of its box, or, as for a piece, of √area of the whole body where that is longer.
const THIN: f64 = 0.05;
const NEIGHBOUR: usize = 8;
/// Less of the area than this is too thin on most scans.
const USUAL: f64 = 0.05;
/// What is left of confidence where a scan says least.
const LEAST: f64 = 0.3;

/// A factor for the confidence of matches with a scan, 1 where there is no doubt, and what is to be said.
pub(super) fn reliability(prepared: &PreparedShape, carriers: &Carriers, mass: &[f64]) -> (f64, Option<Repair>) {
    let steps = coarse_steps(prepared.shape.points()).map_or(1.0, |(step, spacing)| (0.1 * spacing / step).max(LEAST));
    let thin = thin_share(carriers, mass, prepared.info.scale);
    let repair = (thin > USUAL).then(|| {
        let percent = (100.0 * thin).round();
        let message = format!("{percent} % of the surface has so few points that its shape can only be guessed there");
        Repair::noted("thinly-sampled", carriers.shape.points().len(), message)
    });
    let of_thin = if thin > USUAL { (1.0 - 2.0 * thin).max(LEAST) } else { 1.0 };
    (steps * of_thin, repair)
}

/// The share of the area of a cloud, of a body of this scale, that is sampled too thinly.
fn thin_share(Carriers { shape, neighbourhood }: &Carriers, mass: &[f64], scale: f64) -> f64 {
    if !shape.faces().is_empty() {
        return 0.0;
    }
    let points = shape.points();
    let limit = THIN * longest_side(points.iter().copied()).max(scale);
    let neighbours = neighbourhood.neighbours();
    let far = |i: usize| neighbours.distances(i).get(NEIGHBOUR - 1).is_some_and(|&d| d > limit);
    let thin: f64 = (0..points.len()).filter(|&i| far(i)).map(|i| mass[i]).sum();
    thin / mass.iter().sum::<f64>()
}
