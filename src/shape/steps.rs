//! How coarsely coordinates are written: single precision far from the origin, or too few digits, leave steps that the surface drowns in.

use super::repair::Repair;
use crate::vector::extents;

/// The code of the repair that tells of it.
pub const COARSE_NUMBERS: &str = "coarse-numbers";
/// Points that a scan is matched by, at most: what is fine enough for these loses nothing.
const USED: usize = 5000;
/// Steps up to this part of the spacing of the points used do no harm.
const HARMLESS: f64 = 0.1;
/// A grid of points has steps about as wide as its spacing, and loses nothing by it.
const OF_A_GRID: std::ops::Range<f64> = 0.7..1.5;
/// Steps are alike within this part, and a step is a power of ten.
const ALIKE: f64 = 0.05;
const ROUND: f64 = 1e-3;
/// Of the gaps between numbers that come in steps so many are at least half as wide as the middle one.
const EVEN: f64 = 0.9;
/// Points looked at, evenly taken from all: fewer of them show a step as well.
const LOOKED_AT: usize = 20_000;

/// The step between coordinates over the spacing of the points used, where it is so wide that it costs the scan its shape.
pub fn coarse_steps(points: &[[f64; 3]]) -> Option<(f64, f64)> {
    let side = extents(points.iter().copied());
    // A body fills some three quarters of the sides of its box, seen from three directions.
    let area = 0.75 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]);
    let spacing = |count: usize| (area / count as f64).sqrt();
    let (own, spacing) = (spacing(points.len()), spacing(points.len().min(USED)));
    let steps: [f64; 3] = std::array::from_fn(|c| step(points, c));
    let coarse: Vec<usize> = (0..3).filter(|&c| steps[c] > HARMLESS * spacing).collect();
    let widest = coarse.iter().map(|&c| steps[c]).fold(0.0, f64::max);
    if coarse.is_empty() {
        return None;
    }
    let alike = coarse.iter().all(|&c| steps[c] >= (1.0 - ALIKE) * widest);
    let grid = alike && OF_A_GRID.contains(&(widest / own));
    // Digits end at a power of ten, at the same along every axis.
    let digit = 10.0_f64.powf(widest.log10().round());
    let of_digits = coarse.iter().all(|&c| (steps[c] / digit - 1.0).abs() < ROUND);
    // The step of single precision at the far end of an axis.
    let of_precision = coarse.iter().any(|&c| {
        let reach = points.iter().fold(0.0_f64, |most, p| most.max(p[c].abs())) as f32;
        let ulp = f64::from(f32::from_bits(reach.to_bits() + 1)) - f64::from(reach);
        steps[c] <= 2.0 * ulp
    });
    // It differs from axis to axis: what is fine along one lies in sheets along another. A box of squares has steps along all three.
    let sheets = coarse.len() < 3;
    (of_precision || !grid && (of_digits || sheets)).then_some((widest, spacing))
}

/// The step in which coordinates come along an axis; 0 where they do not come in steps.
fn step(points: &[[f64; 3]], axis: usize) -> f64 {
    let mut along: Vec<f64> = points.iter().step_by(points.len().div_ceil(LOOKED_AT)).map(|p| p[axis]).collect();
    let looked_at = along.len();
    along.sort_unstable_by(f64::total_cmp);
    // Coordinates that were written with digits differ by rounding where they are the same.
    let reach = along.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    along.dedup_by(|next, last| *next - *last <= 8.0 * f64::EPSILON * reach);
    let mut gaps: Vec<f64> = along.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // On a plane there is no gap, and nothing lost; nor where hardly two points share a coordinate.
    if gaps.is_empty() || 2 * along.len() > looked_at {
        return 0.0;
    }
    let middle = gaps.len() / 2;
    let middle = *gaps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let wide = gaps.iter().filter(|&&gap| gap >= 0.5 * middle).count();
    if wide as f64 >= EVEN * gaps.len() as f64 { middle } else { 0.0 }
}

/// Says so.
pub(super) fn notice(points: &[[f64; 3]]) -> Option<Repair> {
    let (step, spacing) = coarse_steps(points)?;
    let message = format!(
        "coordinates come in steps of {step:.2e} while points lie some {spacing:.2e} apart: rounding has cost the scan its shape; move it to the origin, or \
         write more digits, before saving it"
    );
    Some(Repair::noted(COARSE_NUMBERS, 1, message))
}

#[cfg(test)]
mod tests {
    use super::coarse_steps;

    /// A sphere of 2000 points, one across.
    fn sphere() -> Vec<[f64; 3]> {
        let place = |i: u32| {
            let (z, turn) = (1.0 - f64::from(2 * i + 1) / 2000.0, f64::from(i) * 2.399963);
            [(1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z].map(|x| 0.5 * x)
        };
        (0..2000).map(place).collect()
    }

    fn moved(by: [f64; 3], rounded: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
        sphere().iter().map(|p| std::array::from_fn(|c| rounded(p[c] + by[c]))).collect()
    }

    #[test]
    fn steps_of_single_precision_and_of_few_digits_are_seen_wherever_the_origin_lies() {
        let single = |x: f64| f64::from(x as f32);
        let far = [4e5, 5e6, 0.0];
        for (cloud, coarse) in [
            (sphere(), false),
            (moved([0.0; 3], single), false),
            (moved([1000.0, 0.0, 0.0], single), false),
            (moved([4e5, 0.0, 0.0], single), true),
            (moved(far, single), true),
            (moved(far, |x| x), false),
            (moved(far, |x| (x * 1000.0).round() / 1000.0), false),
            (moved(far, |x| (x * 10.0).round() / 10.0), true),
            (moved([3e5, 3e5, 100.0], |x| (single(x) * 1000.0).round() / 1000.0), true),
            (moved([4e5, 4e5, 4e5], |x| (single(x) * 1000.0).round() / 1000.0), true),
            (moved([8e5, 8e5, 5.0], |x| (x as f32).to_string().parse().expect("a number")), true),
            (moved([0.0; 3], |x| (x * 100.0).round() / 100.0), true),
            (moved([0.0; 3], |x| (x * 40.0).round() / 40.0), false),
        ] {
            assert_eq!(coarse_steps(&cloud).is_some(), coarse, "{:?}", cloud[0]);
        }
    }

    #[test]
    fn a_height_map_on_a_regular_grid_has_lost_nothing() {
        let grid = (0..2500).map(|i| {
            let (x, y) = (f64::from(i % 50), f64::from(i / 50));
            [x, y, (0.1 * x).sin() * (0.13 * y).cos() * 5.0]
        });
        assert_eq!(coarse_steps(&grid.collect::<Vec<_>>()), None);
    }

    #[test]
    fn what_is_fine_enough_for_the_points_used_has_lost_nothing() {
        let place = |i: u32| {
            let (z, turn) = (1.0 - f64::from(2 * i + 1) / 2e5, f64::from(i) * 2.399963);
            [(1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z].map(|x| 0.5 * x)
        };
        let fine: Vec<[f64; 3]> = (0..200_000).map(place).collect();
        let rounded = |step: f64| fine.iter().map(|p| p.map(|x| (x / step).round() * step)).collect::<Vec<_>>();
        // Spaced 4 mm, matched by points that are 25 mm apart.
        assert_eq!(coarse_steps(&rounded(1e-3)), None);
        assert!(coarse_steps(&rounded(1e-2)).is_some());
        let mut voxels = rounded(1e-2);
        voxels.sort_unstable_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])).then(p[2].total_cmp(&q[2])));
        voxels.dedup();
        assert!(voxels.len() > 20_000);
        assert_eq!(coarse_steps(&voxels), None);
    }
}
