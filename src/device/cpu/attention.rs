//! Attention over tiles of queries, so that only a tile of the scores exists at a time.

use ndarray::{Array2, ArrayView2, s};

use super::matmul::matmul;
use super::pointwise::exp;
use super::rows::softmax;
use crate::device::Mask;

/// Queries whose scores are held together.
const TILE: usize = 128;
/// Probability of sharing a part below which a key is softly masked no more strongly.
const LEAST_SHARED: f32 = 1e-6;

pub(super) fn attend(
    (query, query_parts): (&Array2<f32>, &Array2<f32>),
    (key, key_parts): (&Array2<f32>, &Array2<f32>),
    value: &Array2<f32>,
    mask: Mask,
) -> Array2<f32> {
    assert_eq!(query.ncols(), key.ncols(), "queries and keys have one length");
    let n = query.nrows();
    let mut out = Array2::zeros((n, value.ncols()));
    let scale = (query.ncols() as f32).sqrt().recip();
    for start in (0..n).step_by(TILE) {
        let tile = s![start..n.min(start + TILE), ..];
        let mut scores = matmul(query.slice(tile), key.t());
        let shared = matmul(query_parts.slice(tile), key_parts.t());
        match mask {
            Mask::Soft => {
                scores.zip_mut_with(&shared, |score, &p| *score = *score * scale + (p + LEAST_SHARED).ln());
                for mut row in scores.rows_mut() {
                    softmax(row.as_slice_mut().expect("freshly made, row-major"));
                }
            }
            Mask::Hard => {
                scores *= scale;
                scores = softmax_within(scores.view(), shared.view());
            }
        }
        out.slice_mut(tile).assign(&matmul(scores.view(), value.view()));
    }
    out
}

/// Softmax over every row of scores + ln shared, exactly 0 where nothing is shared; a row that shares nothing is zero.
pub(crate) fn softmax_within(scores: ArrayView2<f32>, shared: ArrayView2<f32>) -> Array2<f32> {
    let mut out = scores.as_standard_layout().into_owned();
    for (mut row, shared) in out.rows_mut().into_iter().zip(shared.rows()) {
        row.zip_mut_with(&shared, |score, &p| *score = if p > 0.0 { *score + p.ln() } else { f32::NEG_INFINITY });
        let most = row.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        row.mapv_inplace(|v| if v > f32::NEG_INFINITY { exp(v - most) } else { 0.0 });
        let total = row.sum();
        if total > 0.0 {
            row *= total.recip();
        }
    }
    out
}
