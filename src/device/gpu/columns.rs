//! Rows and columns copied to where they are wanted.

use super::params::Columns;
use super::recording::grid;
use super::{Gpu, GpuIndices, GpuTensor};

impl Gpu {
    /// The first `count` columns of each part, times its weight, side by side.
    pub(super) fn side_by_side(&self, rows: usize, parts: &[(&GpuTensor, usize, f32)]) -> GpuTensor {
        let cols = parts.iter().map(|&(_, count, _)| count).sum();
        let out = self.tensor(rows, cols);
        let mut first = 0;
        for &(part, count, weight) in parts {
            assert!(part.rows == rows && count <= part.cols, "parts have one row count and the columns asked for");
            let params = Columns {
                count: (rows * count) as u32,
                cols: count as u32,
                from_cols: part.cols as u32,
                to_cols: cols as u32,
                to_first: first as u32,
                weight,
            };
            let bound = [&*part.memory, &part.memory, &out.memory];
            let groups = grid((rows * count).div_ceil(256));
            self.run(&self.kernels.columns.beside, params, &bound, groups, (rows * count) as u64);
            first += count;
        }
        out
    }

    /// Rows of `a` in the given order.
    pub(super) fn in_order(&self, a: &GpuTensor, order: &GpuIndices) -> GpuTensor {
        let out = self.tensor(order.count, a.cols);
        let cols = a.cols as u32;
        let params =
            Columns { count: out.len() as u32, cols, from_cols: cols, to_cols: cols, to_first: 0, weight: 1.0 };
        let bound = [&*a.memory, &order.memory, &out.memory];
        self.run(&self.kernels.columns.gather, params, &bound, grid(out.len().div_ceil(256)), 0);
        out
    }
}
