//! What is known of a pair before it is matched, landmarks and given labels, as functions that correspond.

use std::collections::{BTreeMap, BTreeSet};

use ndarray::{Array2, Axis, concatenate};

use super::{OptionError, PreparedShape};
use crate::maps::{Matchable, landmark_functions, part_functions};
use crate::registration::distinct;

/// Part labels at the points used.
pub(crate) fn labels_used(shape: &PreparedShape, scan: &str) -> Result<Vec<u32>, OptionError> {
    let labels = shape.sampled_shape().labels().ok_or_else(|| OptionError::no_labels(scan))?;
    Ok((0..shape.points_used()).map(|row| labels[shape.support.uploaded(row)]).collect())
}

/// Coefficients (k, l) of functions that correspond, on A and on B.
pub(crate) type Functions = (Array2<f64>, Array2<f64>);

/// Known pairs as rows of the points used of both, from uploaded indices. One with a point that has no place on the body, such as a far stray, says nothing of other points.
pub(crate) fn landmark_rows(
    a: &PreparedShape,
    b: &PreparedShape,
    pairs: &[[u32; 2]],
) -> Result<Vec<[u32; 2]>, OptionError> {
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
    let placed = |shape: &PreparedShape, i: u32| shape.support.unmatched.as_ref().is_none_or(|none| !none.contains(&i));
    let both = pairs.iter().zip(rows_a.into_iter().zip(rows_b));
    let on_bodies = both.filter(|&(&[i, j], _)| placed(a, i) && placed(b, j));
    Ok(distinct(on_bodies.map(|(_, (i, j))| [i, j])))
}

/// Landmarks as functions on both sides; nothing without any.
pub(crate) fn landmarks([a, b]: &[Matchable; 2], rows: &[[u32; 2]]) -> Option<Functions> {
    let of = |shape: &Matchable, side: usize| {
        landmark_functions(&shape.basis, &rows.iter().map(|pair| pair[side]).collect::<Vec<u32>>())
    };
    (!rows.is_empty()).then(|| (of(a, 0), of(b, 1)))
}

/// Labels that get a column of their own. A body has some tens of parts; of thousands of labels each is a few points, which no map in 60 eigenfunctions and no
/// attention sees.
const COLUMNS: usize = 64;

/// The [`COLUMNS`] labels of most points on both shapes together, those that both have before all others; ties go to the lower label.
fn largest_labels(of_a: &[u32], of_b: &[u32], shared_only: bool) -> BTreeSet<u32> {
    let mut counts: BTreeMap<u32, [usize; 2]> = BTreeMap::new();
    of_a.iter().for_each(|&label| counts.entry(label).or_default()[0] += 1);
    of_b.iter().for_each(|&label| counts.entry(label).or_default()[1] += 1);
    let is_shared = |count: &[usize; 2]| count[0] > 0 && count[1] > 0;
    let mut labels: Vec<_> = counts.into_iter().filter(|(_, count)| !shared_only || is_shared(count)).collect();
    labels.sort_by_key(|(label, count)| (!is_shared(count), std::cmp::Reverse(count[0] + count[1]), *label));
    labels.into_iter().take(COLUMNS).map(|(label, _)| label).collect()
}

/// Labels of points of A and of B as rows of ones and noughts (p, c), c at most [`COLUMNS`] and one: a column per label, ascending, and where there are more labels
/// than that the smaller ones share the last. What keeps a point of the map in its part are the labels themselves.
pub(super) fn indicators(of_a: &[u32], of_b: &[u32]) -> [Array2<f32>; 2] {
    let own: BTreeMap<u32, usize> = largest_labels(of_a, of_b, false).into_iter().zip(0..).collect();
    let rest = of_a.iter().chain(of_b).any(|label| !own.contains_key(label));
    [of_a, of_b].map(|labels| {
        let mut rows = Array2::zeros((labels.len(), own.len() + usize::from(rest)));
        labels.iter().enumerate().for_each(|(i, label)| rows[(i, *own.get(label).unwrap_or(&own.len()))] = 1.0);
        rows
    })
}

/// The parts that both shapes have, of thousands the [`COLUMNS`] largest, as functions on both sides.
pub(crate) fn parts_in_common(side_a: &Matchable, of_a: &[u32], side_b: &Matchable, of_b: &[u32]) -> Functions {
    let shared = largest_labels(of_a, of_b, true);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_labels_have_a_column_each() {
        let [on_a, on_b] = indicators(&[7, 2, 2], &[2, 9, 7, 7]);
        assert_eq!(on_a, ndarray::array![[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(on_b, ndarray::array![[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn thousands_of_labels_take_no_more_columns_than_some_tens() {
        // Label 4999 is a tenth of either shape, every other one is a point; 5000 and more are on one shape only.
        let labels = |first: u32| (first..first + 5000).chain([4999; 500]).collect::<Vec<u32>>();
        let (of_a, of_b) = (labels(0), labels(2500));
        let [on_a, on_b] = indicators(&of_a, &of_b);
        assert_eq!((on_a.dim(), on_b.dim()), ((5500, COLUMNS + 1), (5500, COLUMNS + 1)));
        assert!(on_a.rows().into_iter().chain(on_b.rows()).all(|row| row.sum() == 1.0));
        let rest = COLUMNS;
        // The large label keeps its column, and no label of one shape only has one.
        assert!((5000..5500).all(|i| on_a[(i, rest)] == 0.0 && on_a.row(i) == on_b.row(i)));
        assert!((0..2500).all(|i| on_a[(i, rest)] == 1.0) && (2500..5000).all(|i| on_b[(i, rest)] == 1.0));
        assert_eq!(largest_labels(&of_a, &of_b, true).len(), COLUMNS);
    }
}
