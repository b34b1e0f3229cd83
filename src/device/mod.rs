//! Where the dense per-point work runs. One trait, one implementation per device; the CPU is the reference.
//!
//! Operations are coarse, values stay on the device between them, and the only thing to wait for is a download.

mod cpu;
mod fallback;
#[cfg(feature = "gpu")]
mod gpu;

pub use cpu::Cpu;
#[cfg(feature = "train")]
pub(crate) use cpu::{
    EPSILON, SHORTEST, cross_pairs, exp, layer_norm, normalize_rows, softmax_rows, softmax_within, solve_rows, tanh,
};
pub(crate) use cpu::{solve_rows_wide, solve_symmetric};
pub use fallback::Fallback;
pub(crate) use fallback::{Interrupted, still_well};
#[cfg(feature = "gpu")]
pub use gpu::{Agreement, Gpu, GpuCounters, GpuIndices, GpuInfo, GpuOptions, GpuTensor, PoolSize};
use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};

/// How attention keeps queries to the keys of their own part. p_q and p_k are probabilities of parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mask {
    /// ln(p_q · p_k + 1e-6) is added to the score: every key is seen, those of other parts a million times more faintly.
    #[default]
    Soft,
    /// ln(p_q · p_k) is: −∞ where nothing is shared, so that with given labels (rows of ones and noughts) it is the paper's mask of 0 and −∞ (Sec. 3.3), and
    /// a query does not depend at all on keys of other parts. A query that shares its part with no key sees nothing: its row is zero.
    Hard,
}

/// Dense f32 work on row-major matrices (one row per point).
///
/// Shapes that do not fit are a bug of the caller and panic; whatever a user can cause is checked before.
#[allow(async_fn_in_trait)] // Used through generics only, on one thread: no Send bound to promise.
pub trait Device {
    /// A matrix on the device.
    type Tensor;
    /// One row index per row on the device.
    type Indices;

    /// What went wrong on the device, if anything did: then nothing that was downloaded since can be used, and the work has to be repeated on another.
    fn failure(&self) -> Option<String> {
        None
    }
    /// Copies a matrix to the device.
    fn upload(&self, matrix: ArrayView2<f32>) -> Self::Tensor;
    /// Copies row indices to the device.
    fn upload_indices(&self, indices: &[u32]) -> Self::Indices;
    /// Copies a matrix back.
    async fn download(&self, tensor: &Self::Tensor) -> Array2<f32>;
    /// Copies row indices back.
    async fn download_indices(&self, indices: &Self::Indices) -> Vec<u32>;

    /// a b: (n, k) × (k, m) → (n, m).
    fn matmul(&self, a: &Self::Tensor, b: &Self::Tensor) -> Self::Tensor;
    /// aᵀ b: (n, k)ᵀ × (n, m) → (k, m). The product of projections.
    fn matmul_tn(&self, a: &Self::Tensor, b: &Self::Tensor) -> Self::Tensor;
    /// The first `count` columns: (n, k) → (n, count).
    fn leading_columns(&self, a: &Self::Tensor, count: usize) -> Self::Tensor;
    /// a bᵀ: (n, k) × (m, k)ᵀ → (n, m).
    fn matmul_nt(&self, a: &Self::Tensor, b: &Self::Tensor) -> Self::Tensor;
    /// x w + b for every row of x: (n, c) × (c, d) + (1, d) → (n, d).
    fn linear(&self, x: &Self::Tensor, weight: &Self::Tensor, bias: &Self::Tensor) -> Self::Tensor;
    /// Every row shifted and scaled to mean 0 and variance 1, then times `gain` (1, c) plus `bias` (1, c).
    fn layer_norm(&self, x: &Self::Tensor, gain: &Self::Tensor, bias: &Self::Tensor) -> Self::Tensor;
    /// Every column shifted by `mean` (1, c) and divided by the root of `variance` (1, c) and a little, then times `gain` (1, c) plus `bias` (1, c).
    fn batch_norm(
        &self,
        x: &Self::Tensor,
        statistics: (&Self::Tensor, &Self::Tensor),
        gain: &Self::Tensor,
        bias: &Self::Tensor,
    ) -> Self::Tensor;
    /// a ⊙ b, of equal shape.
    fn multiply(&self, a: &Self::Tensor, b: &Self::Tensor) -> Self::Tensor;
    /// max(x, 0).
    fn relu(&self, x: &Self::Tensor) -> Self::Tensor;
    /// tanh x.
    fn tanh(&self, x: &Self::Tensor) -> Self::Tensor;
    /// Heat spreads on coefficients: row i, column c of (k, c) times exp(−λ_i t_c). `lambda` (k, 1), `log_times` (1, c) the logarithms of t, so
    /// that learned times stay positive.
    fn diffuse(&self, x: &Self::Tensor, lambda: &Self::Tensor, log_times: &Self::Tensor) -> Self::Tensor;
    /// Cross products g_i × g_j of all pairs of rows i < j, in lexicographic order: (q, 3) → (q(q−1)/2, 3).
    fn cross_pairs(&self, g: &Self::Tensor) -> Self::Tensor;
    /// Every row divided by its length; rows shorter than 1e-6 are divided by that.
    fn normalize_rows(&self, x: &Self::Tensor) -> Self::Tensor;
    /// Softmax over every row.
    fn softmax_rows(&self, x: &Self::Tensor) -> Self::Tensor;
    /// Masked attention: softmax over the keys of q kᵀ/√d + [`mask`](Mask), times v. `query` (n, d), `key` (m, d), `value` (m, e); `query_parts` (n, c) and
    /// `key_parts` (m, c) are probabilities of parts, so the mask is the logarithm of the probability that a query and a key share a part.
    /// Never holds (n, m).
    fn attend(
        &self,
        query: (&Self::Tensor, &Self::Tensor),
        key: (&Self::Tensor, &Self::Tensor),
        value: &Self::Tensor,
        mask: Mask,
    ) -> Self::Tensor;
    /// Rows c_i of a functional map, each its own solve: (S + diag(mask_i)) c_i = r_i. `gram` S (k, k) symmetric positive semi-definite, `right` (m, k),
    /// `mask` (m, k) ≥ 0 → (m, k). A row without a solution is NaN: one whose system is not finite, or, on a device that computes in f32, not positive definite.
    fn solve_rows(&self, gram: &Self::Tensor, right: &Self::Tensor, mask: &Self::Tensor) -> Self::Tensor;
    /// Matrices of equal row count side by side, each times its weight.
    fn concat(&self, parts: &[(&Self::Tensor, f32)]) -> Self::Tensor;
    /// a + weight·b, of equal shape.
    fn add(&self, a: &Self::Tensor, b: &Self::Tensor, weight: f32) -> Self::Tensor;
    /// Rows of `a` in the order of `rows`: (n, k) → (rows, k).
    fn gather(&self, a: &Self::Tensor, rows: &Self::Indices) -> Self::Tensor;
    /// For each row of `x` (n, d) the nearest row of `y` (m, d), and for each row of `y` the nearest of `x`; Euclidean, ties to the lower
    /// index. Never holds the (n, m) distances. `parts` are labels of the rows of `x` and of `y`: a row finds only rows of its own label, unless
    /// the other matrix has none of that label.
    fn nearest_rows(
        &self,
        x: &Self::Tensor,
        y: &Self::Tensor,
        parts: Option<(&[u32], &[u32])>,
    ) -> (Self::Indices, Self::Indices);
}
