//! Ops that candle would make of many passes over memory, or has no backward pass for: their forward is the CPU kernel that ships, their backward is written beside it
//! and checked by finite differences.

use candle_core::{CpuStorage, CustomOp1, CustomOp2, CustomOp3, Layout, Shape, Tensor};
use ndarray::{Array2, ArrayView2, Axis};

/// A contiguous matrix that an op was given.
fn view<'a>(storage: &'a CpuStorage, layout: &Layout) -> candle_core::Result<ArrayView2<'a, f32>> {
    let (rows, cols) = layout.shape().dims2()?;
    let (start, end) = layout
        .contiguous_offsets()
        .ok_or_else(|| candle_core::Error::Msg("ops here take contiguous matrices".into()))?;
    ArrayView2::from_shape((rows, cols), &storage.as_slice::<f32>()?[start..end])
        .map_err(|error| candle_core::Error::Msg(error.to_string()))
}

fn stored(matrix: Array2<f32>) -> (CpuStorage, Shape) {
    let shape = Shape::from(matrix.dim());
    (CpuStorage::F32(matrix.into_iter().collect()), shape)
}

/// Applies a function of two matrices that needs no gradient of its own.
struct Plain<F>(F);

impl<F: Fn(ArrayView2<f32>, ArrayView2<f32>) -> Array2<f32>> CustomOp2 for Plain<F> {
    fn name(&self) -> &'static str {
        "backward pass"
    }

    fn cpu_fwd(
        &self,
        a: &CpuStorage,
        la: &Layout,
        b: &CpuStorage,
        lb: &Layout,
    ) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(self.0(view(a, la)?, view(b, lb)?)))
    }
}

fn plain(
    a: &Tensor,
    b: &Tensor,
    function: impl Fn(ArrayView2<f32>, ArrayView2<f32>) -> Array2<f32> + Send + Sync + 'static,
) -> candle_core::Result<Option<Tensor>> {
    Ok(Some(a.contiguous()?.apply_op2_no_bwd(&b.contiguous()?, &Plain(function))?))
}

/// Rows to mean 0, variance 1.
pub(super) struct NormalRows;

impl CustomOp1 for NormalRows {
    fn name(&self) -> &'static str {
        "normal rows"
    }

    fn cpu_fwd(&self, x: &CpuStorage, layout: &Layout) -> candle_core::Result<(CpuStorage, Shape)> {
        let x = view(x, layout)?;
        let (gain, bias) = (Array2::ones((1, x.ncols())), Array2::zeros((1, x.ncols())));
        Ok(stored(crate::device::layer_norm(x, gain.view(), bias.view())))
    }

    fn bwd(&self, x: &Tensor, y: &Tensor, grad: &Tensor) -> candle_core::Result<Option<Tensor>> {
        // The scale of each row again, from the argument.
        let scale = x.contiguous()?.apply_op2_no_bwd(
            &x.contiguous()?,
            &Plain(|x: ArrayView2<f32>, _: ArrayView2<f32>| {
                x.map_axis(Axis(1), |row| {
                    let mean = row.sum() / row.len() as f32;
                    let variance = row.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>() / row.len() as f32;
                    (variance + crate::device::EPSILON).sqrt().recip()
                })
                .insert_axis(Axis(1))
            }),
        )?;
        let direction = plain(y, grad, |y, grad| {
            let mut out = grad.to_owned();
            for (mut row, y) in out.rows_mut().into_iter().zip(y.rows()) {
                let count = y.len() as f32;
                let (mean, along) = (row.sum() / count, row.dot(&y) / count);
                row.zip_mut_with(&y, |g, y| *g -= mean + along * y);
            }
            out
        })?;
        direction.map(|direction| direction.broadcast_mul(&scale)).transpose()
    }
}

/// tanh by the kernel that ships, several times faster than the library's.
pub(super) struct Tanh;

impl CustomOp1 for Tanh {
    fn name(&self) -> &'static str {
        "tanh"
    }

    fn cpu_fwd(&self, x: &CpuStorage, layout: &Layout) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(crate::device::tanh(view(x, layout)?)))
    }

    fn bwd(&self, _: &Tensor, y: &Tensor, grad: &Tensor) -> candle_core::Result<Option<Tensor>> {
        plain(y, grad, |y, grad| {
            let mut out = grad.to_owned();
            out.zip_mut_with(&y, |g, y| *g *= 1.0 - y * y);
            out
        })
    }
}

/// Rows to length 1.
pub(super) struct UnitRows;

impl CustomOp1 for UnitRows {
    fn name(&self) -> &'static str {
        "unit rows"
    }

    fn cpu_fwd(&self, x: &CpuStorage, layout: &Layout) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(crate::device::normalize_rows(view(x, layout)?)))
    }

    fn bwd(&self, x: &Tensor, _: &Tensor, grad: &Tensor) -> candle_core::Result<Option<Tensor>> {
        plain(x, grad, |x, grad| {
            let mut out = grad.to_owned();
            for (mut row, x) in out.rows_mut().into_iter().zip(x.rows()) {
                let length = x.dot(&x).sqrt();
                if length > crate::device::SHORTEST {
                    let along = row.dot(&x) / (length * length);
                    row.zip_mut_with(&x, |g, x| *g = (*g - along * x) / length);
                } else {
                    row /= crate::device::SHORTEST;
                }
            }
            out
        })
    }
}

/// Softmax over each row.
pub(super) struct SoftmaxRows;

impl CustomOp1 for SoftmaxRows {
    fn name(&self) -> &'static str {
        "softmax"
    }

    fn cpu_fwd(&self, x: &CpuStorage, layout: &Layout) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(crate::device::softmax_rows(view(x, layout)?)))
    }

    fn bwd(&self, _: &Tensor, y: &Tensor, grad: &Tensor) -> candle_core::Result<Option<Tensor>> {
        softmax_backward(y, grad)
    }
}

/// Softmax over the keys that share a part. The mask is not learned.
pub(super) struct SoftmaxWithin;

impl CustomOp2 for SoftmaxWithin {
    fn name(&self) -> &'static str {
        "softmax within parts"
    }

    fn cpu_fwd(
        &self,
        scores: &CpuStorage,
        ls: &Layout,
        shared: &CpuStorage,
        lp: &Layout,
    ) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(crate::device::softmax_within(view(scores, ls)?, view(shared, lp)?)))
    }

    fn bwd(
        &self,
        _: &Tensor,
        _: &Tensor,
        y: &Tensor,
        grad: &Tensor,
    ) -> candle_core::Result<(Option<Tensor>, Option<Tensor>)> {
        Ok((softmax_backward(y, grad)?, None))
    }
}

/// ∂x of y = softmax x over each row, as y ⊙ (∂y − Σ y ∂y): also of a row in which what is zero stays so.
fn softmax_backward(y: &Tensor, grad: &Tensor) -> candle_core::Result<Option<Tensor>> {
    plain(y, grad, |y, grad| {
        let mut out = grad.to_owned();
        for (mut row, y) in out.rows_mut().into_iter().zip(y.rows()) {
            let along = row.dot(&y);
            row.zip_mut_with(&y, |g, y| *g = (*g - along) * y);
        }
        out
    })
}

/// −Σ y ln p of each row, p being the softmax of the logits. The labels y are not learned.
pub(super) struct CrossEntropyRows;

impl CustomOp2 for CrossEntropyRows {
    fn name(&self) -> &'static str {
        "cross-entropy"
    }

    fn cpu_fwd(
        &self,
        logits: &CpuStorage,
        ll: &Layout,
        labels: &CpuStorage,
        ly: &Layout,
    ) -> candle_core::Result<(CpuStorage, Shape)> {
        let (logits, labels) = (view(logits, ll)?, view(labels, ly)?);
        let rows = logits.rows().into_iter().zip(labels.rows());
        let losses: Vec<f32> = rows
            .map(|(x, y)| {
                let most = x.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                let total: f32 = x.iter().map(|v| crate::device::exp(v - most)).sum();
                (total.ln() + most) * y.sum() - x.dot(&y)
            })
            .collect();
        let shape = Shape::from((losses.len(), 1));
        Ok((CpuStorage::F32(losses), shape))
    }

    fn bwd(
        &self,
        logits: &Tensor,
        labels: &Tensor,
        _: &Tensor,
        grad: &Tensor,
    ) -> candle_core::Result<(Option<Tensor>, Option<Tensor>)> {
        let direction = plain(logits, labels, |x, y| {
            let mut out = crate::device::softmax_rows(x);
            for (mut row, y) in out.rows_mut().into_iter().zip(y.rows()) {
                let sum = y.sum();
                row.zip_mut_with(&y, |p, y| *p = *p * sum - y);
            }
            out
        })?;
        Ok((direction.map(|direction| direction.broadcast_mul(grad)).transpose()?, None))
    }
}

/// Cross products of all pairs of rows.
pub(super) struct CrossPairs;

impl CustomOp1 for CrossPairs {
    fn name(&self) -> &'static str {
        "cross pairs"
    }

    fn cpu_fwd(&self, g: &CpuStorage, layout: &Layout) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(crate::device::cross_pairs(view(g, layout)?)))
    }

    fn bwd(&self, g: &Tensor, _: &Tensor, grad: &Tensor) -> candle_core::Result<Option<Tensor>> {
        plain(g, grad, |g, grad| {
            let cross = |a: [f32; 3], b: [f32; 3]| {
                [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            };
            let row = |m: &ArrayView2<f32>, i: usize| [m[(i, 0)], m[(i, 1)], m[(i, 2)]];
            let q = g.nrows();
            let mut out = Array2::zeros(g.dim());
            let mut pair = 0;
            for i in 0..q {
                for j in i + 1..q {
                    // d(a × b)·u = da·(b × u) + db·(u × a).
                    let up = row(&grad, pair);
                    let (to_a, to_b) = (cross(row(&g, j), up), cross(up, row(&g, i)));
                    for c in 0..3 {
                        out[(i, c)] += to_a[c];
                        out[(j, c)] += to_b[c];
                    }
                    pair += 1;
                }
            }
            out
        })
    }
}

/// Rows of a functional map.
pub(super) struct SolveRows;

impl CustomOp3 for SolveRows {
    fn name(&self) -> &'static str {
        "solve rows"
    }

    fn cpu_fwd(
        &self,
        gram: &CpuStorage,
        lg: &Layout,
        right: &CpuStorage,
        lr: &Layout,
        mask: &CpuStorage,
        lm: &Layout,
    ) -> candle_core::Result<(CpuStorage, Shape)> {
        Ok(stored(crate::device::solve_rows(view(gram, lg)?, view(right, lr)?, view(mask, lm)?)))
    }

    /// With y_i = (S + diag m_i)⁻¹ ∂c_i: ∂r_i = y_i and ∂S = −Σ y_i c_iᵀ. The mask is not learned.
    fn bwd(
        &self,
        gram: &Tensor,
        _: &Tensor,
        mask: &Tensor,
        solved: &Tensor,
        grad: &Tensor,
    ) -> candle_core::Result<(Option<Tensor>, Option<Tensor>, Option<Tensor>)> {
        let grad = grad.contiguous()?;
        let to_right = gram.contiguous()?.apply_op3_no_bwd(&grad, &mask.contiguous()?, &SolveRows)?;
        let to_gram = to_right.t()?.matmul(solved)?.neg()?;
        Ok((Some(to_gram), Some(to_right), None))
    }
}
