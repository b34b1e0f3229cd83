//! Work on one row at a time.

use super::kernel::Kernel;
use super::params::Rows;
use super::recording::grid;
use super::{Gpu, GpuTensor};

impl Gpu {
    /// `kernel` on every row of x, with a gain and a bias per column where it takes them; writes `cols` values per row.
    pub(super) fn by_rows(
        &self,
        kernel: &Kernel,
        x: &GpuTensor,
        affine: Option<(&GpuTensor, &GpuTensor)>,
        cols: usize,
        flops_per_value: u64,
    ) -> GpuTensor {
        let affine = affine.map(|(gain, bias)| {
            assert_eq!((gain.dim(), bias.dim()), ((1, x.cols), (1, x.cols)), "a gain and a bias per column");
            (&gain.memory, &bias.memory)
        });
        let out = self.tensor(x.rows, cols);
        if x.cols == 0 {
            return out;
        }
        let (gain, bias) = affine.unwrap_or((&x.memory, &x.memory));
        let params = Rows { rows: x.rows as u32, cols: x.cols as u32 };
        self.run(kernel, params, &[&x.memory, gain, bias, &out.memory], grid(x.rows), flops_per_value * x.len() as u64);
        out
    }
}
