//! Fits the coefficients of confidence and overlap: logistic functions of which no fault raises the probability.

use std::ops::Range;

use faer::{Mat, Side, linalg::solvers::Solve};
use ndarray::{Array1, Array2, Axis};

use super::cues::{GENERAL, SIGNS, STEPS};
use crate::network::CUES;

/// Adds up to this much of a coefficient's square per point, so that inputs that hardly vary, or that others say as well, get no weight.
const RIDGE: f64 = 1e-6;
/// Newton's method is done long before, or never.
const ITERATIONS: usize = 30;
/// A coefficient that changes by less has been found.
const STILL: f64 = 1e-6;
/// Rows that are multiplied at once.
const BLOCK: usize = 4096;

/// What [`fit`] found, and how it went.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// A constant and one coefficient for each input.
    pub(crate) coefficients: Vec<f64>,
    /// Newton steps taken.
    pub(crate) iterations: usize,
    /// The most that the last of them changed a coefficient by.
    pub(crate) last_step: f64,
}

impl Fit {
    /// Whether the coefficients are those under which the points are likeliest.
    pub(crate) fn converged(&self) -> bool {
        self.last_step < STILL
    }
}

/// A constant and one coefficient for each input, under which `points` are likeliest: whether each is right, and what `inputs` writes of it into a row of as
/// many values as it is given. By Newton's method, undamped: from 0 on it may swing, which the report shows.
pub(crate) fn fit(points: &[bool], count: usize, inputs: impl Fn(usize, &mut [f64])) -> Fit {
    let size = 1 + count;
    let mut found = Array1::<f64>::zeros(size);
    let (mut iterations, mut last_step) = (0, f64::INFINITY);
    while iterations < ITERATIONS && last_step >= STILL {
        let ridge = RIDGE * points.len() as f64;
        let mut hessian = Array2::<f64>::eye(size) * ridge;
        let mut gradient = &found * ridge;
        for first in (0..points.len()).step_by(BLOCK) {
            let right = &points[first..(first + BLOCK).min(points.len())];
            let mut x = Array2::<f64>::ones((right.len(), size));
            for (i, mut row) in x.rows_mut().into_iter().enumerate() {
                inputs(first + i, &mut row.as_slice_mut().expect("row-major")[1..]);
            }
            let p = x.dot(&found).mapv(|odds| 1.0 / (1.0 + (-odds).exp()));
            let off = Array1::from_shape_fn(right.len(), |i| p[i] - f64::from(u8::from(right[i])));
            gradient += &x.t().dot(&off);
            let weighted = &x * &p.mapv(|p| p * (1.0 - p)).insert_axis(Axis(1));
            hessian += &x.t().dot(&weighted);
        }
        let Ok(cholesky) = Mat::from_fn(size, size, |i, j| hessian[(i, j)]).llt(Side::Lower) else { break };
        let step = cholesky.solve(&Mat::from_fn(size, 1, |i, _| gradient[i]));
        (0..size).for_each(|i| found[i] -= step[(i, 0)]);
        (iterations, last_step) = (iterations + 1, step.norm_max());
    }
    Fit { coefficients: found.to_vec(), iterations, last_step }
}

/// [`fit`] under the condition that no fault raises the probability: a fault has several inputs, such as a near and a wide average. While the coefficients of some fault sum to more than 0, that with the
/// largest sum is held at a sum of 0, so that only the differences of its inputs count, and all is fitted again; it is left out if its first input, at the place itself, would then raise the probability.
pub(crate) fn fit_of_faults(
    points: &[bool],
    count: usize,
    faults: impl Iterator<Item = Range<usize>>,
    inputs: impl Fn(usize, &mut [f64]),
) -> Fit {
    let mut free: Vec<Range<usize>> = faults.collect();
    let mut held: Vec<Range<usize>> = Vec::new();
    let mut left_out: Vec<Range<usize>> = Vec::new();
    loop {
        let mut found = fit(points, count, |i, row| {
            inputs(i, row);
            left_out.iter().for_each(|fault| row[fault.clone()].fill(0.0));
            for fault in &held {
                let [differences @ .., last] = &mut row[fault.clone()] else { continue };
                differences.iter_mut().for_each(|input| *input -= *last);
                *last = 0.0;
            }
        });
        if !found.converged() {
            return found;
        }
        let slopes = &mut found.coefficients[1..];
        for fault in &held {
            let [differences @ .., last] = &mut slopes[fault.clone()] else { continue };
            *last = -differences.iter().sum::<f64>();
        }
        let raises = |fault: &Range<usize>| slopes[fault.clone()].iter().sum::<f64>();
        let most = (0..free.len()).max_by(|&one, &other| raises(&free[one]).total_cmp(&raises(&free[other])));
        let wrong = held.iter().position(|fault| slopes[fault.start] > 0.0);
        match (wrong, most.filter(|&most| raises(&free[most]) > 0.0)) {
            (Some(wrong), _) => left_out.push(held.swap_remove(wrong)),
            (None, Some(most)) => held.push(free.swap_remove(most)),
            (None, None) => return found,
        }
    }
}

/// The inputs of each sign, of a row of so many cues: a wide average beside a near one may count the other way.
pub(crate) fn signs(count: usize) -> impl Iterator<Item = Range<usize>> {
    let (near_and_wide, with_point) = (STEPS.len(), 1 + STEPS.len());
    let general = (0..SIGNS).map(move |sign| near_and_wide * sign..near_and_wide * (sign + 1));
    let learned = (GENERAL..CUES.min(count)).step_by(with_point).map(move |first| first..first + with_point);
    general.chain(learned)
}

#[cfg(test)]
mod tests {
    use super::super::calibration::probability;
    use super::*;

    #[test]
    fn a_fit_finds_the_probabilities_that_points_were_drawn_by() {
        let truth: [f64; 1 + GENERAL] = std::array::from_fn(|c| [1.0, -3.0, 2.0, 0.0][c.min(3)]);
        // Every value of two cues, right as often as they say.
        let mut points = Vec::new();
        for step in 0..400 {
            let mut cues = [0.0; GENERAL];
            (cues[0], cues[1]) = (f64::from(step % 20) / 20.0, f64::from(step / 20) / 20.0);
            let share = (100.0 * probability(&truth, cues.iter().copied())).round() as usize;
            points.extend((0..100).map(|i| (cues, i < share)));
        }
        let right: Vec<bool> = points.iter().map(|&(_, right)| right).collect();
        let found = fit(&right, GENERAL, |i, row| row.copy_from_slice(&points[i].0));
        for (found, wanted) in found.coefficients.iter().zip(truth) {
            assert!((found - wanted).abs() < 0.1, "{found} {wanted}");
        }
    }

    #[test]
    fn a_fit_says_whether_it_converged() {
        let of = |inputs: &[[f64; 2]], right: &[bool]| fit(right, 2, |i, row| row.copy_from_slice(&inputs[i]));
        // Right once in four, and three times in four.
        let ordinary = of(
            &[[0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0]],
            &[true, false, false, false, true, true, true, false],
        );
        assert!(ordinary.converged() && ordinary.iterations < 10, "{ordinary:?}");
        assert!((ordinary.coefficients[1] - 9.0_f64.ln()).abs() < 1e-3, "{ordinary:?}");
        // Points that a line separates ask for endless coefficients: the ridge holds these back, if the steps do not swing beyond it.
        let separable = of(&[[0.0; 2], [0.0; 2], [1.0, 0.0], [1.0, 0.0]], &[false, false, true, true]);
        assert!(separable.converged(), "{separable:?}");
        let swinging = of(&[[1.0, 0.0], [5.0, 0.0], [2.0, 5.0], [3.0, -2.0]], &[false, true, false, true]);
        assert!(!swinging.converged() && swinging.last_step > 1.0, "{swinging:?}");
        assert_eq!(swinging.iterations, ITERATIONS);
        let poisoned = of(&[[f64::NAN; 2], [1.0, 0.0]], &[true, false]);
        assert!(!poisoned.converged(), "{poisoned:?}");
    }

    #[test]
    fn a_sign_that_would_raise_confidence_counts_only_by_how_it_differs_near_and_wide() {
        // The second sign rises with the first, near as wide, and pays back what that costs; the third means something; the fourth only where it is worse at the point than wide.
        let mut points = Vec::new();
        for step in 0..400 {
            let (first, third) = (f64::from(step % 20) / 20.0, f64::from(step / 20) / 20.0);
            let [at_point, wide] = [7, 3].map(|many| f64::from(step % many) / f64::from(many));
            let odds = 2.0 - 6.0 * first + 2.0 * first * first - 3.0 * third - 2.0 * at_point + 3.0 * wide;
            let share = (100.0 / (1.0 + (-odds).exp())).round() as usize;
            let square = first * first;
            let cues = [first, 0.0, square, square, third, 0.0, at_point, 0.0, wide];
            points.extend((0..100).map(|i| (cues, i < share)));
        }
        let right: Vec<bool> = points.iter().map(|&(_, right)| right).collect();
        let inputs = |i: usize, row: &mut [f64]| row.copy_from_slice(&points[i].0);
        let [free, held] =
            [fit(&right, 9, inputs), fit_of_faults(&right, 9, signs(9), inputs)].map(|fit| fit.coefficients);
        assert!(free[3] + free[4] > 0.5, "{free:?}");
        assert!(held[3] + held[4] == 0.0 && held[1] < -2.0 && (held[5] + 3.0).abs() < 0.3, "{held:?}");
        assert!(free[7] + free[9] > 0.5 && held[7] + held[8] + held[9] == 0.0 && held[7] < -1.0, "{free:?} {held:?}");
        assert_eq!(signs(GENERAL).collect::<Vec<_>>(), [0..2, 2..4, 4..6]);
        assert_eq!(signs(CUES + 8).collect::<Vec<_>>(), [0..2, 2..4, 4..6, 6..9, 9..12]);
    }

    #[test]
    fn a_sign_that_would_raise_confidence_at_the_place_itself_is_left_out() {
        // Near it raises, wide it costs less than that: neither its sum nor its difference may count.
        let mut points = Vec::new();
        for step in 0..400 {
            let cues = [f64::from(step % 20) / 20.0, f64::from(step / 20) / 20.0];
            let share = (100.0 / (1.0 + (-1.0 - 3.0 * cues[0] + cues[1]).exp())).round() as usize;
            points.extend((0..100).map(|i| (cues, i < share)));
        }
        let right: Vec<bool> = points.iter().map(|&(_, right)| right).collect();
        let inputs = |i: usize, row: &mut [f64]| row.copy_from_slice(&points[i].0);
        let free = fit(&right, 2, inputs).coefficients;
        assert!(free[1] > 2.0 && free[2] < -0.5, "{free:?}");
        let found = fit_of_faults(&right, 2, std::iter::once(0..2), inputs).coefficients;
        assert!(found[1..] == [0.0, 0.0] && found[0] > 1.0, "{found:?}");
    }
}
