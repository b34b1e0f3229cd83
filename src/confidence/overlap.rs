//! Which points have a partner, where the other scan is a piece.

use super::calibration::{Situation, probability};
use super::cues::{Cues, GENERAL};
use crate::network::SITUATIONS;

/// A constant and one coefficient per general cue of a logistic function, as those of confidence: rows are situations. A point without a partner does not come back to
/// where it was, and the map strains around it.
///
/// Fitted by maximum likelihood to whether the points of held-out pieces have a partner, together with confidence (`src/bin/calibrate.rs`), so that no cue raises it; those that have one and are matched
/// elsewhere are left out, as they look alone and say nothing of those that are. Area under curve on themselves 0.88, and 0.98 to 0.99 after registration.
#[rustfmt::skip]
const COEFFICIENTS: [[f64; 1 + GENERAL]; SITUATIONS] = [
    [4.99, -10.82, -16.02, -12.06, 0.00, 0.00, 0.00],
    [9.24, -4.64, -26.92, -39.29, 0.00, 0.00, 0.00],
    [9.75, -22.99, -16.97, 0.00, -10.72, -5.33, -9.34],
    [10.18, -24.80, -23.23, 0.00, -21.58, 0.00, 0.00],
];

/// On a cloud that looks whole the odds of a partner are better by this. Those fitted are of bodies that look like pieces, where one point in two is alone; on 35 own clouds that look whole no point of a
/// piece is. Of 140 pairs of `faust_pieces` as clouds, pieces onto wholes end at 5.7 instead of 6.8 (a point left alone counts as far off as can be), and of points alone 68 % are said to be instead
/// of 73 %, when a scan looked whole from 85 % of a body on. A mesh without borders lacks nothing, and of one with borders nothing better is known.
const LOOKS_WHOLE: f64 = 10.0;

/// The probability (p) that each point has a partner on the other body, which may be a cloud that looks whole.
pub(crate) fn overlap(cues: &Cues, looks_whole: bool) -> Vec<f32> {
    let mut coefficients = COEFFICIENTS[Situation::of(cues).row()];
    coefficients[0] += if looks_whole { LOOKS_WHOLE.ln() } else { 0.0 };
    let rows = cues.table.rows().into_iter();
    rows.map(|row| probability(&coefficients, row.iter().take(GENERAL).copied()) as f32).collect()
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::super::cues::{Cues, GENERAL, STEPS};
    use super::{COEFFICIENTS, overlap};

    #[test]
    fn points_that_do_not_come_back_or_around_which_the_map_strains_are_alone() {
        // Signs are kept as roots: the way there and back first, then strain and, once registered, residual; near and wide.
        let mut table = Array2::zeros((3, GENERAL));
        for wide in 0..STEPS.len() {
            table[(1, wide)] = 0.5_f64.sqrt();
            table[(2, STEPS.len() + wide)] = 0.3_f64.sqrt();
            table[(2, 2 * STEPS.len() + wide)] = 0.3_f64.sqrt();
        }
        for meshes in [false, true] {
            for registered in [false, true] {
                let cues = Cues { table: table.clone(), registered, meshes, pieces: true, category: None };
                let found = overlap(&cues, false);
                let odds = |looks_whole: bool| overlap(&cues, looks_whole).into_iter().map(|p| p / (1.0 - p));
                assert!(odds(true).zip(odds(false)).all(|(whole, piece)| (whole / piece / 10.0 - 1.0).abs() < 0.01));
                let expected =
                    matches!(found[..], [has, strays, strained] if has > 0.6 && strays < 0.5 && strained < 0.5);
                assert!(expected, "{meshes} {registered} {found:?}");
            }
        }
        assert!(
            COEFFICIENTS.iter().flat_map(|row| &row[1..]).all(|&slope| slope <= 0.0),
            "no cue speaks for a partner"
        );
    }
}
