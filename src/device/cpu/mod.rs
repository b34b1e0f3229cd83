//! The reference device: plain Rust, vectorised by the compiler.

mod matmul;
mod nearest_rows;
mod nearest_within;

use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

use super::Device;

/// Runs on the thread that calls it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

impl Device for Cpu {
    type Tensor = Array2<f32>;
    type Indices = Vec<u32>;

    fn upload(&self, matrix: ArrayView2<f32>) -> Array2<f32> {
        matrix.as_standard_layout().into_owned()
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
