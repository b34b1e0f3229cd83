//! Many small positive definite systems that differ in their diagonal.

use super::params::SolveRows;
use super::recording::rows_per_dispatch;
use super::{Gpu, GpuTensor};

/// Systems whose factors are in memory together; with 120 unknowns they take 7 MiB.
const TOGETHER: usize = 128;

impl Gpu {
    /// In f32, with one step of refinement, where the CPU computes in f64: relative errors are about 1e-6 times the condition number.
    pub(super) fn solve_systems(&self, gram: &GpuTensor, right: &GpuTensor, mask: &GpuTensor) -> GpuTensor {
        let (m, k) = right.dim();
        assert_eq!((gram.dim(), mask.dim()), ((k, k), (m, k)), "a square matrix, and a mask like the right sides");
        let out = self.tensor(m, k);
        if k == 0 {
            return out;
        }
        let (wide, cubed) = (k as u64, (k as u64).pow(3));
        // Cholesky, four triangular solves, and one product with the matrix.
        let work_per_row = cubed / 3 + 6 * wide * wide;
        let slab = rows_per_dispatch(work_per_row, 1).min(TOGETHER);
        let work = self.room(slab.min(m) * (k + 1) * k);
        // As bits, because a shader's constants may not be NaN.
        let nothing = f32::NAN.to_bits();
        let bound = [&*gram.memory, &right.memory, &mask.memory, &work, &out.memory];
        for first in (0..m).step_by(slab) {
            let here = slab.min(m - first);
            let params = SolveRows { rows: m as u32, width: k as u32, first_row: first as u32, nothing };
            self.run(&self.kernels.solve_rows, params, &bound, [here as u32, 1, 1], here as u64 * work_per_row);
        }
        out
    }
}
