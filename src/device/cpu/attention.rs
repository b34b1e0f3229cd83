//! Attention over tiles of queries, so that only a tile of the scores exists at a time.

use ndarray::{Array2, s};

use super::matmul::matmul;
use super::rows::softmax;

/// Queries whose scores are held together.
const TILE: usize = 128;
/// Probability of sharing a part below which a key is masked no more strongly.
const LEAST_SHARED: f32 = 1e-6;

pub(super) fn attend(
    (query, query_parts): (&Array2<f32>, &Array2<f32>),
    (key, key_parts): (&Array2<f32>, &Array2<f32>),
    value: &Array2<f32>,
) -> Array2<f32> {
    assert_eq!(query.ncols(), key.ncols(), "queries and keys have one length");
    let n = query.nrows();
    let mut out = Array2::zeros((n, value.ncols()));
    let scale = (query.ncols() as f32).sqrt().recip();
    for start in (0..n).step_by(TILE) {
        let tile = s![start..n.min(start + TILE), ..];
        let mut scores = matmul(query.slice(tile), key.t());
        let shared = matmul(query_parts.slice(tile), key_parts.t());
        scores.zip_mut_with(&shared, |score, &p| *score = *score * scale + (p + LEAST_SHARED).ln());
        for mut row in scores.rows_mut() {
            softmax(row.as_slice_mut().expect("freshly made, row-major"));
        }
        out.slice_mut(tile).assign(&matmul(scores.view(), value.view()));
    }
    out
}
