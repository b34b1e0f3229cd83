//! Attention over tiles of queries, so that only a tile of the scores exists at a time.

use ndarray::{Array2, ArrayView2, s};

use super::matmul::matmul;
use super::pointwise::exp;
use crate::device::Mask;

/// Queries whose scores are held together.
const TILE: usize = 128;
/// Probability of sharing a part below which a key is softly masked no more strongly.
const LEAST_SHARED: f32 = 1e-6;
/// Keys handled side by side: each place has a maximum and a sum of its own.
const LANES: usize = 16;

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
    let least = match mask {
        Mask::Soft => LEAST_SHARED,
        Mask::Hard => 0.0,
    };
    for start in (0..n).step_by(TILE) {
        let tile = s![start..n.min(start + TILE), ..];
        let mut scores = matmul(query.slice(tile), key.t());
        scores *= scale;
        let shared = matmul(query_parts.slice(tile), key_parts.t());
        pulp::Arch::new().dispatch(Masked { scores: &mut scores, shared: shared.view(), least });
        out.slice_mut(tile).assign(&matmul(scores.view(), value.view()));
    }
    out
}

/// For the trainer: softmax over every row of scores + ln shared, exactly 0 where nothing is shared; a row that shares nothing is zero.
#[cfg(feature = "train")]
pub(crate) fn softmax_within(scores: ArrayView2<f32>, shared: ArrayView2<f32>) -> Array2<f32> {
    let mut out = scores.as_standard_layout().into_owned();
    pulp::Arch::new().dispatch(Masked { scores: &mut out, shared, least: 0.0 });
    out
}

/// The softmax over every row as pulp wants it: a closure would not be inlined, and so be compiled for the plain instruction set.
struct Masked<'a> {
    scores: &'a mut Array2<f32>,
    shared: ArrayView2<'a, f32>,
    least: f32,
}

impl pulp::WithSimd for Masked<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let shared = self.shared.as_standard_layout();
        for (mut row, shared) in self.scores.rows_mut().into_iter().zip(shared.rows()) {
            let (row, shared) = (row.as_slice_mut(), shared.to_slice());
            masked_softmax(row.expect("row-major"), shared.expect("row-major"), self.least);
        }
    }
}

/// In place: softmax of scores + ln (shared + least), as eˢ (shared + least) over its sum, which needs no logarithm. Zeros if nothing is shared at all.
#[inline(always)]
fn masked_softmax(scores: &mut [f32], shared: &[f32], least: f32) {
    assert_eq!(scores.len(), shared.len(), "a score and a probability per key");
    let seen = |score: f32, shared: f32| if shared + least > 0.0 { score } else { f32::NEG_INFINITY };
    let larger = |x: f32, y: f32| if x > y { x } else { y };
    let (blocks, rest) = scores.as_chunks_mut::<LANES>();
    let (shared_blocks, shared_rest) = shared.as_chunks::<LANES>();

    let mut most = [f32::NEG_INFINITY; LANES];
    for (block, shared) in blocks.iter().zip(shared_blocks) {
        for l in 0..LANES {
            most[l] = larger(seen(block[l], shared[l]), most[l]);
        }
    }
    let of_rest = rest.iter().zip(shared_rest).map(|(&score, &shared)| seen(score, shared));
    let most = of_rest.chain(most).fold(f32::NEG_INFINITY, |x, y| larger(y, x));

    let weight = |score: f32, shared: f32| exp(score - most) * (shared + least);
    let mut total = [0.0; LANES];
    for (block, shared) in blocks.iter_mut().zip(shared_blocks) {
        for l in 0..LANES {
            block[l] = weight(block[l], shared[l]);
            total[l] += block[l];
        }
    }
    for (score, &shared) in rest.iter_mut().zip(shared_rest) {
        *score = weight(*score, shared);
        total[0] += *score;
    }
    let total: f32 = total.iter().sum();
    // What is not a number stays so and is noticed.
    if total != 0.0 {
        let scale = total.recip();
        scores.iter_mut().for_each(|v| *v *= scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_the_logarithm_whatever_the_length_and_the_scores() {
        for (keys, spread) in [(1, 1.0), (LANES, 3.0), (3 * LANES + 5, 60.0)] {
            let score = |k: usize| spread * (1.7 * k as f32).sin();
            let shared = |k: usize| [0.0, 1.0, 1e-7, 0.3][(k + 1) % 4];
            for least in [0.0, LEAST_SHARED] {
                let mut row: Vec<f32> = (0..keys).map(score).collect();
                masked_softmax(&mut row, &(0..keys).map(shared).collect::<Vec<_>>(), least);
                let exact = |k: usize| f64::from(score(k)).exp() * f64::from(shared(k) + least);
                let total: f64 = (0..keys).map(exact).sum();
                for (k, &weight) in row.iter().enumerate() {
                    let wanted = exact(k) / total;
                    assert!((f64::from(weight) - wanted).abs() < 1e-6, "{k} of {keys}: {weight} {wanted}");
                    assert!(least > 0.0 || shared(k) > 0.0 || weight == 0.0, "exactly nothing where nothing is shared");
                }
            }
        }
    }

    #[test]
    fn a_row_that_shares_nothing_is_zero_and_what_is_no_number_stays_none() {
        let mut row = [5.0, -1.0, 200.0];
        masked_softmax(&mut row, &[0.0; 3], 0.0);
        assert_eq!(row, [0.0; 3]);
        let mut row = [200.0, 1.0, -300.0];
        masked_softmax(&mut row, &[0.0, 0.5, 0.5], 0.0);
        assert!(row[0] == 0.0 && row[1] == 1.0 && row[2] < 1e-30, "keys out of sight have no say: {row:?}");
        for all in [[f32::NAN; 3], [0.0, f32::NAN, 0.0]] {
            let mut row = all;
            masked_softmax(&mut row, &[1.0; 3], 0.0);
            assert!(row.iter().any(|v| v.is_nan()));
        }
    }
}
