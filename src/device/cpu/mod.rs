//! The reference device: plain Rust, vectorised by the compiler.

mod attention;
mod matmul;
mod nearest_rows;
mod nearest_within;
mod pointwise;
mod rows;
mod solve_rows;

use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

use super::{Device, Mask};
#[cfg(feature = "train")]
pub(crate) use attention::softmax_within;
#[cfg(feature = "train")]
pub(crate) use pointwise::{exp, tanh};
#[cfg(feature = "train")]
pub(crate) use rows::{EPSILON, SHORTEST, cross_pairs, layer_norm, normalize_rows, softmax_rows};
#[cfg(feature = "train")]
pub(crate) use solve_rows::solve_rows;
pub(crate) use solve_rows::{solve_rows_wide, solve_symmetric};

/// Runs on the thread that calls it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

impl Device for Cpu {
    type Tensor = Array2<f32>;
    type Indices = Vec<u32>;

    fn upload(&self, matrix: ArrayView2<f32>) -> Array2<f32> {
        matrix.as_standard_layout().into_owned()
    }

    fn upload_indices(&self, indices: &[u32]) -> Vec<u32> {
        indices.to_vec()
    }

    async fn download(&self, tensor: &Array2<f32>) -> Array2<f32> {
        tensor.clone()
    }

    async fn download_indices(&self, indices: &Vec<u32>) -> Vec<u32> {
        indices.clone()
    }

    fn matmul(&self, a: &Array2<f32>, b: &Array2<f32>) -> Array2<f32> {
        matmul::matmul(a.view(), b.view())
    }

    fn matmul_tn(&self, a: &Array2<f32>, b: &Array2<f32>) -> Array2<f32> {
        matmul::matmul(a.t(), b.view())
    }

    fn matmul_nt(&self, a: &Array2<f32>, b: &Array2<f32>) -> Array2<f32> {
        matmul::matmul(a.view(), b.t())
    }

    fn linear(&self, x: &Array2<f32>, weight: &Array2<f32>, bias: &Array2<f32>) -> Array2<f32> {
        matmul::matmul(x.view(), weight.view()) + bias
    }

    fn layer_norm(&self, x: &Array2<f32>, gain: &Array2<f32>, bias: &Array2<f32>) -> Array2<f32> {
        rows::layer_norm(x.view(), gain.view(), bias.view())
    }

    fn batch_norm(
        &self,
        x: &Array2<f32>,
        (mean, variance): (&Array2<f32>, &Array2<f32>),
        gain: &Array2<f32>,
        bias: &Array2<f32>,
    ) -> Array2<f32> {
        rows::batch_norm(x.view(), (mean.view(), variance.view()), gain.view(), bias.view())
    }

    fn multiply(&self, a: &Array2<f32>, b: &Array2<f32>) -> Array2<f32> {
        a * b
    }

    fn relu(&self, x: &Array2<f32>) -> Array2<f32> {
        x.mapv(|v| v.max(0.0))
    }

    fn tanh(&self, x: &Array2<f32>) -> Array2<f32> {
        pointwise::tanh(x.view())
    }

    fn diffuse(&self, x: &Array2<f32>, lambda: &Array2<f32>, log_times: &Array2<f32>) -> Array2<f32> {
        x * &(-lambda.dot(&log_times.mapv(f32::exp))).mapv(f32::exp)
    }

    fn cross_pairs(&self, g: &Array2<f32>) -> Array2<f32> {
        rows::cross_pairs(g.view())
    }

    fn normalize_rows(&self, x: &Array2<f32>) -> Array2<f32> {
        rows::normalize_rows(x.view())
    }

    fn softmax_rows(&self, x: &Array2<f32>) -> Array2<f32> {
        rows::softmax_rows(x.view())
    }

    fn attend(
        &self,
        query: (&Array2<f32>, &Array2<f32>),
        key: (&Array2<f32>, &Array2<f32>),
        value: &Array2<f32>,
        mask: Mask,
    ) -> Array2<f32> {
        attention::attend(query, key, value, mask)
    }

    fn solve_rows(&self, gram: &Array2<f32>, right: &Array2<f32>, mask: &Array2<f32>) -> Array2<f32> {
        solve_rows::solve_rows(gram.view(), right.view(), mask.view())
    }

    fn leading_columns(&self, a: &Array2<f32>, count: usize) -> Array2<f32> {
        a.slice(s![.., ..count]).as_standard_layout().into_owned()
    }

    fn concat(&self, parts: &[(&Array2<f32>, f32)]) -> Array2<f32> {
        let scaled: Vec<Array2<f32>> = parts.iter().map(|&(part, weight)| part * weight).collect();
        let views: Vec<ArrayView2<f32>> = scaled.iter().map(|part| part.view()).collect();
        concatenate(Axis(1), &views).expect("parts have one row count")
    }

    fn add(&self, a: &Array2<f32>, b: &Array2<f32>, weight: f32) -> Array2<f32> {
        let mut sum = a.clone();
        sum.scaled_add(weight, b);
        sum
    }

    fn gather(&self, a: &Array2<f32>, rows: &Vec<u32>) -> Array2<f32> {
        let mut gathered = Array2::zeros((rows.len(), a.ncols()));
        for (mut row, &i) in gathered.rows_mut().into_iter().zip(rows) {
            row.assign(&a.row(i as usize));
        }
        gathered
    }

    fn nearest_rows(&self, x: &Array2<f32>, y: &Array2<f32>, parts: Option<(&[u32], &[u32])>) -> (Vec<u32>, Vec<u32>) {
        match parts {
            None => nearest_rows::nearest_rows(x.view(), y.view()),
            Some((of_x, of_y)) => nearest_within::nearest_rows_within(x.view(), y.view(), of_x, of_y),
        }
    }
}
