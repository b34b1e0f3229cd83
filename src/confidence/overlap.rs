//! Which points have a partner, where the other scan is a piece.

use super::alone::SIGNS;
use super::calibration::{Situation, probability};
use super::cues::Cues;
use crate::network::SITUATIONS;

/// A constant and one coefficient per sign of a logistic function; rows are situations, as those of confidence.
///
/// Fitted by maximum likelihood to whether the points of held-out pieces have a partner, together with confidence (`src/bin/calibrate.rs`).
#[rustfmt::skip]
const COEFFICIENTS: [[f64; 1 + SIGNS]; SITUATIONS] = [
    [0.33, -0.57, 0.00, -1.19, -0.01],
    [0.49, -0.55, 0.00, -1.81, 0.02],
    [2.00, -5.24, 0.06, -1.81, -0.20],
    [2.65, -7.65, 3.35, -3.10, -0.34],
];

/// The probability (p) that each point has a partner.
pub(crate) fn overlap(cues: &Cues) -> Vec<f32> {
    let coefficients = &COEFFICIENTS[Situation::of(cues).row()];
    cues.alone.rows().into_iter().map(|row| probability(coefficients, row.iter().copied()) as f32).collect()
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::super::alone::SIGNS;
    use super::super::cues::Cues;
    use super::overlap;

    #[test]
    fn points_that_do_not_come_back_from_a_border_are_alone() {
        // Signs of a point like most, of one beyond a border, and of one that only lies near it.
        let signs = [[0.0, 0.1, 0.15, 0.7], [0.4, 0.3, 0.6, 2.0], [0.1, 0.1, 0.4, 0.7]];
        let alone = Array2::from_shape_fn((3, SIGNS), |(i, sign)| signs[i][sign]);
        for meshes in [false, true] {
            for registered in [false, true] {
                let table = Array2::zeros((3, 0));
                let found =
                    overlap(&Cues { table, alone: alone.clone(), registered, meshes, pieces: true, category: None });
                let expected = matches!(found[..], [has, beyond, near]
                    if has > 0.6 && near < has && near > 0.5 && (beyond < 0.5 || !registered));
                assert!(expected, "{found:?}");
            }
        }
    }
}
