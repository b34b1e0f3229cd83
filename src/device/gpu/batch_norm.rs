//! Columns shifted and scaled.

use super::params::BatchNorm;
use super::recording::grid;
use super::{Gpu, GpuTensor};

impl Gpu {
    pub(super) fn normalize_columns(
        &self,
        x: &GpuTensor,
        (mean, variance): (&GpuTensor, &GpuTensor),
        gain: &GpuTensor,
        bias: &GpuTensor,
    ) -> GpuTensor {
        let by_column = [mean, variance, gain, bias];
        assert!(by_column.iter().all(|row| row.dim() == (1, x.cols)), "a number per column");
        let out = self.tensor(x.rows, x.cols);
        let params = BatchNorm { count: x.len() as u32, cols: x.cols as u32 };
        let [mean, variance, gain, bias] = by_column.map(|row| &*row.memory);
        let bound = [&*x.memory, mean, variance, gain, bias, &out.memory];
        self.run(&self.kernels.batch_norm, params, &bound, grid(x.len().div_ceil(256)), 6 * x.len() as u64);
        out
    }
}
