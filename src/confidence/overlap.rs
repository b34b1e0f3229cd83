//! Which points have no partner, where the other scan is a piece.

use super::cues::{Cues, STEPS};

/// A neighbourhood is not on the other scan where the way there and back ends so far away from it, or where it lies so far from the other surface when it is laid onto it;
/// in √area.
const BACK: f64 = 0.08;
const OFF: f64 = 0.05;

/// Whether each point has none.
pub(crate) fn alone(cues: &Cues) -> Vec<bool> {
    let sign = |row: usize, sign: usize| cues.table[(row, STEPS.len() * sign)].powi(2);
    (0..cues.table.nrows()).map(|row| sign(row, 0) > BACK || cues.registered && sign(row, 2) > OFF).collect()
}
