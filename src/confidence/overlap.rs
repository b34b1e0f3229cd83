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

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::super::cues::{Cues, GENERAL, STEPS};
    use super::alone;

    #[test]
    fn points_that_do_not_come_back_or_lie_off_the_other_surface_are_alone() {
        // Signs are kept as roots: the way there and back first, how far the surfaces are apart third.
        let mut table = Array2::zeros((4, GENERAL));
        table[(1, 0)] = 0.09_f64.sqrt();
        table[(2, 2 * STEPS.len())] = 0.06_f64.sqrt();
        (table[(3, 0)], table[(3, 2 * STEPS.len())]) = (0.07_f64.sqrt(), 0.04_f64.sqrt());
        let cues = |registered| Cues { table: table.clone(), registered, meshes: true, category: None };
        assert_eq!(alone(&cues(true)), [false, true, true, false]);
        assert_eq!(alone(&cues(false)), [false, true, false, false]);
    }
}
