//! Matrices and lists on the GPU.

use std::rc::Rc;

use super::pool::Memory;

/// A matrix on the GPU, row-major. Clones share its memory, which goes back to the pool with the last of them.
#[derive(Clone, Debug)]
pub struct GpuTensor {
    pub(super) memory: Rc<Memory>,
    pub(super) rows: usize,
    pub(super) cols: usize,
}

impl GpuTensor {
    /// Rows and columns.
    pub fn dim(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    pub(super) fn len(&self) -> usize {
        self.rows * self.cols
    }
}

/// Row indices on the GPU.
#[derive(Clone, Debug)]
pub struct GpuIndices {
    pub(super) memory: Rc<Memory>,
    pub(super) count: usize,
    /// Rows of the matrix that they index.
    pub(super) bound: usize,
}
