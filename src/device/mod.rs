//! Where the dense per-point work runs. One trait, one implementation per device; the CPU is the reference.
//!
//! Operations are coarse, values stay on the device between them, and the only thing to wait for is a download.

mod cpu;

pub use cpu::Cpu;
use ndarray::{Array2, ArrayView2};

/// Dense f32 work on row-major matrices (one row per point).
///
/// Shapes that do not fit are a bug of the caller and panic; whatever a user can cause is checked before.
#[allow(async_fn_in_trait)] // Used through generics only, on one thread: no Send bound to promise.
pub trait Device {
    /// A matrix on the device.
    type Tensor;
    /// One row index per row on the device.
    type Indices;

    /// Copies a matrix to the device.
    fn upload(&self, matrix: ArrayView2<f32>) -> Self::Tensor;
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
