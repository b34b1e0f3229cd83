//! Matrix products: one shader for all transposes.

use super::params::{Matmul, Transposed};
use super::recording::{grid, rows_per_dispatch};
use super::{Gpu, GpuTensor};

/// Rows and columns of the product that a workgroup makes.
const TILE: usize = 64;
/// A product of fewer tiles leaves most of a GPU idle, so a long inner index is shared out in chunks.
const ENOUGH_TILES: usize = 64;
/// Inner indices of such a chunk.
const CHUNK: usize = 256;

impl Gpu {
    /// a b + bias, with either operand transposed.
    pub(super) fn product(
        &self,
        a: &GpuTensor,
        b: &GpuTensor,
        transposed: Transposed,
        bias: Option<&GpuTensor>,
    ) -> GpuTensor {
        let (rows, inner) = if transposed == Transposed::Left { (a.cols, a.rows) } else { (a.rows, a.cols) };
        let (inner_b, cols) = if transposed == Transposed::Right { (b.cols, b.rows) } else { (b.rows, b.cols) };
        assert_eq!(inner, inner_b, "inner sizes of a matrix product");
        assert!(bias.is_none_or(|bias| bias.dim() == (1, cols)), "one bias per column");
        let kernels = &self.kernels.matmul;
        let kernel = match transposed {
            Transposed::Neither => &kernels.plain,
            Transposed::Left => &kernels.left,
            Transposed::Right => &kernels.right,
        };
        let c = self.tensor(rows, cols);
        let tiles = rows.div_ceil(TILE) * cols.div_ceil(TILE);
        let layers = if tiles < ENOUGH_TILES && bias.is_none() { inner.div_ceil(CHUNK).max(1) } else { 1 };
        let target = if layers > 1 { self.room(layers * rows * cols) } else { c.memory.clone() };
        let params = Matmul {
            rows: rows as u32,
            cols: cols as u32,
            inner: inner as u32,
            first_row: 0,
            chunk: if layers > 1 { CHUNK } else { inner } as u32,
            layers: layers as u32,
            has_bias: bias.is_some().into(),
        };
        let work_per_row = 2 * cols as u64 * inner as u64;
        let slab = rows_per_dispatch(work_per_row, TILE);
        let unused = &a.memory;
        let bound = [&*a.memory, &b.memory, bias.map_or(unused, |bias| &bias.memory), &target];
        for first in (0..rows).step_by(slab) {
            let here = slab.min(rows - first);
            let groups = [cols.div_ceil(TILE), here.div_ceil(TILE), layers].map(|n| n as u32);
            let params = Matmul { first_row: first as u32, ..params };
            self.run(kernel, params, &bound, groups, here as u64 * work_per_row);
        }
        if layers > 1 {
            let groups = grid(c.len().div_ceil(256));
            self.run(&kernels.sum, params, &[&target, unused, unused, &c.memory], groups, (layers * c.len()) as u64);
        }
        c
    }
}
