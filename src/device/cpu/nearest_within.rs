//! Nearest rows that stay within their part.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView2, Axis};

use super::nearest_rows::nearest_rows;

/// As [`nearest_rows`], but a row whose label the other matrix has too finds only rows with that label; one whose label only its own matrix has
/// finds any. One search per label, so that nothing is compared in vain.
pub(super) fn nearest_rows_within(
    x: ArrayView2<f32>,
    y: ArrayView2<f32>,
    labels_x: &[u32],
    labels_y: &[u32],
) -> (Vec<u32>, Vec<u32>) {
    let (rows_x, rows_y) = (rows_by_label(labels_x), rows_by_label(labels_y));
    let (mut to_y, mut to_x) = (vec![0; x.nrows()], vec![0; y.nrows()]);
    for (label, of_x) in &rows_x {
        let Some(of_y) = rows_y.get(label) else { continue };
        let (there, back) = nearest_rows(at(x, of_x).view(), at(y, of_y).view());
        of_x.iter().zip(there).for_each(|(&i, j)| to_y[i] = of_y[j as usize] as u32);
        of_y.iter().zip(back).for_each(|(&j, i)| to_x[j] = of_x[i as usize] as u32);
    }
    let alone = |own: &BTreeMap<u32, Vec<usize>>, other: &BTreeMap<u32, Vec<usize>>| -> Vec<usize> {
        own.iter().filter(|(label, _)| !other.contains_key(label)).flat_map(|(_, rows)| rows.iter().copied()).collect()
    };
    let (alone_x, alone_y) = (alone(&rows_x, &rows_y), alone(&rows_y, &rows_x));
    if !alone_x.is_empty() {
        let (there, _) = nearest_rows(at(x, &alone_x).view(), y);
        alone_x.iter().zip(there).for_each(|(&i, j)| to_y[i] = j);
    }
    if !alone_y.is_empty() {
        let (_, back) = nearest_rows(x, at(y, &alone_y).view());
        alone_y.iter().zip(back).for_each(|(&j, i)| to_x[j] = i);
    }
    (to_y, to_x)
}

fn rows_by_label(labels: &[u32]) -> BTreeMap<u32, Vec<usize>> {
    let mut rows: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (row, &label) in labels.iter().enumerate() {
        rows.entry(label).or_default().push(row);
    }
    rows
}

fn at(matrix: ArrayView2<f32>, rows: &[usize]) -> Array2<f32> {
    matrix.select(Axis(0), rows)
}
