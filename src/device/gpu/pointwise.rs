//! Functions of single values.

use super::kernel::Kernel;
use super::params::Pointwise;
use super::pool::Memory;
use super::recording::grid;
use super::{Gpu, GpuTensor};

impl Gpu {
    /// `kernel` on every value of a, with what stands at the same place, in the same row or in the same column of `others`.
    pub(super) fn by_value(
        &self,
        kernel: &Kernel,
        a: &GpuTensor,
        others: [&Memory; 2],
        weight: f32,
        flops_per_value: u64,
    ) -> GpuTensor {
        let out = self.tensor(a.rows, a.cols);
        let params = Pointwise { count: a.len() as u32, cols: a.cols as u32, weight };
        let bound = [&*a.memory, others[0], others[1], &out.memory];
        self.run(kernel, params, &bound, grid(a.len().div_ceil(256)), flops_per_value * a.len() as u64);
        out
    }
}
