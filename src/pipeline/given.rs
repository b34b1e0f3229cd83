//! What is known of a pair before it is matched, landmarks and given labels, as functions that correspond.

use std::collections::{BTreeMap, BTreeSet};

use ndarray::{Array2, Axis, concatenate};

use super::{OptionError, PreparedShape};
use crate::maps::{Matchable, landmark_functions, part_functions};

/// Part labels at the points used.
pub(crate) fn labels_used(shape: &PreparedShape, scan: &str) -> Result<Vec<u32>, OptionError> {
    let labels = shape.shape.labels().ok_or_else(|| OptionError::no_labels(scan))?;
    Ok((0..shape.points_used()).map(|row| labels[shape.support.uploaded(row)]).collect())
}

/// Coefficients (k, l) of functions that correspond, on A and on B.
pub(crate) type Functions = (Array2<f64>, Array2<f64>);

/// Known pairs as functions on both sides, from uploaded indices.
pub(crate) fn landmarks(
    a: &PreparedShape,
    b: &PreparedShape,
    side_a: &Matchable,
    side_b: &Matchable,
    pairs: &[[u32; 2]],
) -> Result<Option<Functions>, OptionError> {
    if pairs.is_empty() {
        return Ok(None);
    }
    let rows = |shape: &PreparedShape, scan: &str, side: usize| -> Result<Vec<u32>, OptionError> {
        let points = shape.shape.points().len();
        let mut named = BTreeMap::new();
        for pair in pairs {
            if *named.entry(pair[side]).or_insert(pair) != pair {
                return Err(OptionError::landmark_twice(pair[side], scan));
            }
        }
        let row = |pair: &[u32; 2]| match pair[side] {
            index if (index as usize) < points => Ok(shape.support.row_of(index as usize) as u32),
            index => Err(OptionError::landmark(index, scan, points)),
        };
        pairs.iter().map(row).collect()
    };
    let (rows_a, rows_b) = (rows(a, "a", 0)?, rows(b, "b", 1)?);
    Ok(Some((landmark_functions(&side_a.basis, &rows_a), landmark_functions(&side_b.basis, &rows_b))))
}

/// The parts that both shapes have, as functions on both sides.
pub(crate) fn parts_in_common(side_a: &Matchable, of_a: &[u32], side_b: &Matchable, of_b: &[u32]) -> Functions {
    let shared = shared_labels(of_a, of_b);
    (part_functions(&side_a.basis, of_a, &shared), part_functions(&side_b.basis, of_b, &shared))
}

/// The labels that occur on both shapes.
pub(crate) fn shared_labels(of_a: &[u32], of_b: &[u32]) -> BTreeSet<u32> {
    let labels = |of: &[u32]| of.iter().copied().collect::<BTreeSet<u32>>();
    &labels(of_a) & &labels(of_b)
}

/// All columns together; `None` without any.
pub(crate) fn side_by_side(functions: impl Iterator<Item = Functions>) -> Option<Functions> {
    let join = |x: Array2<f64>, y: Array2<f64>| concatenate![Axis(1), x, y];
    functions.reduce(|(a, b), (more_a, more_b)| (join(a, more_a), join(b, more_b)))
}
