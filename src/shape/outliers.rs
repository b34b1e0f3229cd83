//! Points of a cloud that a scanner saw in the air near the body.

use super::planes::Plane;
use crate::graph::{Neighbours, nearest_neighbours};
use crate::vector::middle_side;

/// Neighbours of a point that are looked at.
pub(super) const AROUND: usize = 8;
/// The neighbour that tells how dense a cloud is at a point, and the place among all neighbours, the densest first, of the one that tells how dense it is around.
const THIRD: usize = 2;
const DENSER: usize = 2;
/// An outlier is this many times as far from its nearest neighbour as points around it from their third.
const APART: f64 = 1.5;
/// Nor is one an outlier that is nearer to others than this part of the longest side of the cloud: it goes with them whatever it is.
const NEAR: f64 = 0.015;
/// And it lies off the plane of its neighbours by this part of its distance from them: the first points where sampling becomes thin lie on it.
const OFF: f64 = 0.6;
/// And no more points than this have it among their own neighbours: where a surface is sampled thinly beside another, those around it have.
const FEW: usize = 2;
/// Outliers near each other hide each other: what is left is looked at so many times.
const ROUNDS: usize = 5;

/// The points of a cloud that are no outliers, by their numbers, ascending, and their neighbours among each other.
pub(super) fn without_outliers(points: &[[f64; 3]]) -> (Vec<u32>, Neighbours) {
    let mut kept: Vec<u32> = (0..points.len() as u32).collect();
    let mut places = points.to_vec();
    let mut neighbours = nearest_neighbours(&places, AROUND);
    let near = NEAR * middle_side(points.iter().copied());
    for _ in 0..ROUNDS {
        let mut asked_for = vec![0_usize; places.len()];
        (0..places.len()).for_each(|i| neighbours.of(i).iter().for_each(|&j| asked_for[j as usize] += 1));
        let stays = (0..places.len()).map(|i| asked_for[i] > FEW || !is_outlier(&places, &neighbours, i, near));
        let stays: Vec<bool> = stays.collect();
        if stays.iter().all(|&stays| stays) {
            break;
        }
        let mut flags = stays.iter();
        kept.retain(|_| flags.next() == Some(&true));
        places = kept.iter().map(|&i| points[i as usize]).collect();
        neighbours = nearest_neighbours(&places, AROUND);
    }
    (kept, neighbours)
}

fn is_outlier(places: &[[f64; 3]], neighbours: &Neighbours, i: usize, near: f64) -> bool {
    let nearest = neighbours.distances(i).first().copied().unwrap_or(0.0);
    if nearest <= near {
        return false;
    }
    let density = |i: usize| neighbours.distances(i).get(THIRD).copied().unwrap_or(0.0);
    let mut around: [f64; AROUND] = [f64::INFINITY; AROUND];
    around.iter_mut().zip(neighbours.of(i)).for_each(|(slot, &j)| *slot = density(j as usize));
    let (_, &mut usual, _) = around.select_nth_unstable_by(DENSER, f64::total_cmp);
    if nearest <= APART * usual {
        return false;
    }
    let near: Vec<[f64; 3]> = neighbours.of(i).iter().map(|&j| places[j as usize]).collect();
    Plane::of(&near).height(places[i]).abs() > OFF * nearest
}

#[cfg(test)]
mod tests {
    use super::without_outliers;

    /// Noise between 0 and 1 that only depends on what is given.
    fn noise(seed: u64) -> f64 {
        let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((x ^ (x >> 29)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A limb: 3000 points on a cylinder of length 1 and radius 0.08, as a scanner takes them, one in `thin` on its upper half.
    fn limb(thin: u64) -> Vec<[f64; 3]> {
        let place = |i: u64| {
            let turn = std::f64::consts::TAU * noise(3 * i);
            [0.08 * turn.cos(), noise(3 * i + 1), 0.08 * turn.sin()]
        };
        (0..3000).filter(|i| i % thin == 0 || place(*i)[1] < 0.5).map(place).collect()
    }

    #[test]
    fn points_in_the_air_are_told_from_a_surface_of_any_density() {
        for thin in [1, 4, 16, 64] {
            let surface = limb(thin);
            let (kept, _) = without_outliers(&surface);
            assert!(kept.len() as f64 >= 0.995 * surface.len() as f64, "{thin}: {} of {}", kept.len(), surface.len());
        }
        let mut points = limb(1);
        let first = points.len() as u32;
        // A spacing or more off the surface.
        let air = (0..2000).map(|i| std::array::from_fn(|c| noise(70_000 + 3 * i + c as u64)));
        let air = air.map(|[x, y, z]: [f64; 3]| [0.3 * x - 0.15, y, 0.3 * z - 0.15]);
        points.extend(air.filter(|[x, _, z]| (x.hypot(*z) - 0.08).abs() > 0.03).take(60));
        let (kept, _) = without_outliers(&points);
        let in_air = kept.iter().filter(|&&i| i >= first).count();
        // Some have only each other near by: a piece that fills space, and is told by that.
        assert!(in_air <= 15, "{in_air} of 60 left");
        assert!(kept.len() - in_air >= 2970);
    }
}
