//! Work on one row at a time.

use ndarray::{Array2, ArrayView2};

use super::pointwise::exp;

/// Added to a variance before its root.
pub(crate) const EPSILON: f32 = 1e-5;
/// Shortest length a row is divided by.
pub(crate) const SHORTEST: f32 = 1e-6;

pub(crate) fn layer_norm(x: ArrayView2<f32>, gain: ArrayView2<f32>, bias: ArrayView2<f32>) -> Array2<f32> {
    let mut out = x.as_standard_layout().into_owned();
    let (gain, bias) = (gain.row(0), bias.row(0));
    for mut row in out.rows_mut() {
        let mean = row.sum() / row.len() as f32;
        row -= mean;
        let scale = (row.dot(&row) / row.len() as f32 + EPSILON).sqrt().recip();
        for ((v, g), b) in row.iter_mut().zip(gain).zip(bias) {
            *v = *v * scale * g + b;
        }
    }
    out
}

pub(super) fn batch_norm(
    x: ArrayView2<f32>,
    (mean, variance): (ArrayView2<f32>, ArrayView2<f32>),
    gain: ArrayView2<f32>,
    bias: ArrayView2<f32>,
) -> Array2<f32> {
    let (mean, gain, bias) = (mean.row(0), gain.row(0), bias.row(0));
    let scale = variance.row(0).mapv(|v| (v + EPSILON).sqrt().recip());
    let mut out = x.as_standard_layout().into_owned();
    for mut row in out.rows_mut() {
        for (c, v) in row.iter_mut().enumerate() {
            *v = (*v - mean[c]) * scale[c] * gain[c] + bias[c];
        }
    }
    out
}

pub(crate) fn normalize_rows(x: ArrayView2<f32>) -> Array2<f32> {
    let mut out = x.as_standard_layout().into_owned();
    for mut row in out.rows_mut() {
        row /= row.dot(&row).sqrt().max(SHORTEST);
    }
    out
}

pub(crate) fn softmax_rows(x: ArrayView2<f32>) -> Array2<f32> {
    let mut out = x.as_standard_layout().into_owned();
    for mut row in out.rows_mut() {
        let most = row.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        row.mapv_inplace(|v| exp(v - most));
        let scale = row.iter().sum::<f32>().recip();
        row *= scale;
    }
    out
}

pub(crate) fn cross_pairs(g: ArrayView2<f32>) -> Array2<f32> {
    assert_eq!(g.ncols(), 3, "cross products are of vectors in space");
    let q = g.nrows();
    let mut out = Array2::zeros((q * q.saturating_sub(1) / 2, 3));
    let mut rows = out.rows_mut().into_iter();
    for i in 0..q {
        for j in i + 1..q {
            let (a, b) = (g.row(i), g.row(j));
            let mut row = rows.next().expect("one row per pair");
            for c in 0..3 {
                let (d, e) = ((c + 1) % 3, (c + 2) % 3);
                row[c] = a[d] * b[e] - a[e] * b[d];
            }
        }
    }
    out
}
