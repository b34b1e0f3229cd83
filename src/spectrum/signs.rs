//! One of the two signs of an eigenfunction, chosen by a rule that does not depend on the order of the points.

use faer::MatMut;
use faer::prelude::{Reborrow, ReborrowMut};

/// Turns every column so that its third moment Σ m φ³ is positive, or, where the function is as much positive as
/// negative, so that its first entry of largest magnitude is.
pub(super) fn make_canonical(mut eigenvectors: MatMut<'_, f64>, mass: &[f64]) {
    for column in eigenvectors.rb_mut().col_iter_mut() {
        let (mut cubes, mut magnitude): (f64, f64) = (0.0, 0.0);
        let mut largest: f64 = 0.0;
        for (&phi, &m) in column.rb().iter().zip(mass) {
            cubes += m * phi * phi * phi;
            magnitude += m * (phi * phi * phi).abs();
            // A margin lets rounding not decide between entries that are equal by symmetry.
            if phi.abs() > largest.abs() * (1.0 + 1e-6) {
                largest = phi;
            }
        }
        let leaning = if cubes.abs() > 1e-6 * magnitude { cubes } else { largest };
        if leaning < 0.0 {
            column.iter_mut().for_each(|phi| *phi = -*phi);
        }
    }
}
