//! Which points have a partner, where the other scan is a piece.

use super::calibration::{Situation, probability};
use super::cues::{Cues, GENERAL};
use crate::network::SITUATIONS;

/// A constant and one coefficient per general cue of a logistic function, as those of confidence: rows are situations. A point without a partner does not come back to
/// where it was, and the map strains around it.
///
/// Fitted by maximum likelihood to whether the points of held-out pieces have a partner, together with confidence (`src/bin/calibrate.rs`); those that have one and are matched
/// elsewhere are left out, as they look alone and say nothing of those that are. Area under curve on themselves 0.88, and 0.98 to 0.99 after registration.
#[rustfmt::skip]
const COEFFICIENTS: [[f64; 1 + GENERAL]; SITUATIONS] = [
    [3.29, -6.52, -2.77, -7.41, -18.09, 0.00, 0.00],
    [6.66, -2.66, -11.66, -29.08, -13.87, 0.00, 0.00],
    [10.46, -22.18, -14.14, 13.17, -19.68, -10.78, -19.00],
    [10.22, -32.25, -18.52, 9.04, -29.89, 0.00, 0.00],
];

/// The probability (p) that each point has a partner.
pub(crate) fn overlap(cues: &Cues) -> Vec<f32> {
    let coefficients = &COEFFICIENTS[Situation::of(cues).row()];
    let rows = cues.table.rows().into_iter();
    rows.map(|row| probability(coefficients, row.iter().take(GENERAL).copied()) as f32).collect()
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::super::cues::{Cues, GENERAL, STEPS};
    use super::overlap;

    #[test]
    fn points_that_do_not_come_back_or_around_which_the_map_strains_are_alone() {
        // Signs are kept as roots: the way there and back first, strain second; near and wide.
        let mut table = Array2::zeros((3, GENERAL));
        for wide in 0..STEPS.len() {
            table[(1, wide)] = 0.5_f64.sqrt();
            table[(2, STEPS.len() + wide)] = 0.3_f64.sqrt();
        }
        for meshes in [false, true] {
            for registered in [false, true] {
                let found = overlap(&Cues { table: table.clone(), registered, meshes, pieces: true, category: None });
                // Once clouds are registered strain alone says little: it goes with noise as well.
                let enough = meshes || !registered;
                let expected = matches!(found[..], [has, strays, strained]
                    if has > 0.6 && strays < 0.5 && strained < has && (strained < 0.5 || !enough));
                assert!(expected, "{found:?}");
            }
        }
    }
}
