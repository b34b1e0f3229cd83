//! Matrix products through faer, whose packing and micro-kernels know the instruction set of the machine.

use faer::linalg::matmul::matmul as product;
use faer::{Accum, MatMut, MatRef, Par};
use ndarray::{Array2, ArrayView2};

/// a b for any strides: (n, k) × (k, m) → (n, m), row-major.
pub(super) fn matmul(a: ArrayView2<f32>, b: ArrayView2<f32>) -> Array2<f32> {
    assert_eq!(a.ncols(), b.nrows(), "inner sizes of a matrix product");
    let mut c = Array2::<f32>::zeros((a.nrows(), b.ncols()));
    let (rows, cols) = c.dim();
    let values = c.as_slice_mut().expect("freshly made, row-major");
    let destination = MatMut::from_row_major_slice_mut(values, rows, cols);
    // One contiguous operand each; the transposed view of a row-major matrix is column-major.
    let (a, b) = (Dense::of(a), Dense::of(b));
    product(destination, Accum::Replace, a.view(), b.view(), 1.0, Par::Seq);
    c
}

/// A matrix whose values lie in one slice, by rows or by columns.
struct Dense<'a> {
    values: std::borrow::Cow<'a, [f32]>,
    by_rows: bool,
    rows: usize,
    cols: usize,
}

impl<'a> Dense<'a> {
    fn of(matrix: ArrayView2<'a, f32>) -> Self {
        let (rows, cols) = matrix.dim();
        if let Some(values) = matrix.to_slice() {
            return Self { values: values.into(), by_rows: true, rows, cols };
        }
        match matrix.reversed_axes().to_slice() {
            Some(values) => Self { values: values.into(), by_rows: false, rows, cols },
            None => Self { values: matrix.iter().copied().collect(), by_rows: true, rows, cols },
        }
    }

    fn view(&self) -> MatRef<'_, f32> {
        if self.by_rows {
            MatRef::from_row_major_slice(&self.values, self.rows, self.cols)
        } else {
            MatRef::from_column_major_slice(&self.values, self.rows, self.cols)
        }
    }
}
