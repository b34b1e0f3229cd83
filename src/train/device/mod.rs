//! Automatic differentiation as a [`Device`]: the tensors are candle's, so that the one forward pass is also the one that is trained.
//!
//! Ops that candle would make of many passes over memory, or has no backward pass for, are one op each in `ops.rs`.

mod ops;

use candle_core::Tensor;
use ndarray::{Array2, ArrayView2};

use crate::device::{Cpu, Device, Mask};
use ops::{CrossEntropyRows, CrossPairs, NormalRows, SoftmaxRows, SoftmaxWithin, SolveRows, Tanh, UnitRows};

/// The device that trains.
#[derive(Clone, Copy, Debug, Default)]
pub struct Autodiff;

/// Fails only for shapes that do not fit, which is a bug of the caller here as on every device.
fn done(result: candle_core::Result<Tensor>) -> Tensor {
    result.unwrap_or_else(|error| panic!("{error}"))
}

/// A matrix as a tensor.
pub fn tensor(matrix: ArrayView2<f32>) -> Tensor {
    let values: Vec<f32> = matrix.iter().copied().collect();
    done(Tensor::from_vec(values, matrix.dim(), &candle_core::Device::Cpu))
}

/// A tensor as a matrix.
pub fn matrix(tensor: &Tensor) -> Array2<f32> {
    let (rows, cols) = tensor.dims2().expect("tensors here are matrices");
    let values = tensor.flatten_all().and_then(|flat| flat.to_vec1()).expect("f32 on the CPU");
    Array2::from_shape_vec((rows, cols), values).expect("as many values as the shape says")
}

/// −Σ y ln p (n, 1) of the rows of `logits` (n, c), p being their softmax and y those of `labels`.
pub fn cross_entropy_rows(logits: &Tensor, labels: &Tensor) -> candle_core::Result<Tensor> {
    logits.contiguous()?.apply_op2(&labels.contiguous()?, CrossEntropyRows)
}

impl Device for Autodiff {
    type Tensor = Tensor;
    type Indices = Vec<u32>;

    fn upload(&self, matrix: ArrayView2<f32>) -> Tensor {
        tensor(matrix)
    }

    fn upload_indices(&self, indices: &[u32]) -> Vec<u32> {
        indices.to_vec()
    }

    async fn download(&self, tensor: &Tensor) -> Array2<f32> {
        matrix(tensor)
    }

    async fn download_indices(&self, indices: &Vec<u32>) -> Vec<u32> {
        indices.clone()
    }

    fn matmul(&self, a: &Tensor, b: &Tensor) -> Tensor {
        done(a.matmul(b))
    }

    fn matmul_tn(&self, a: &Tensor, b: &Tensor) -> Tensor {
        done(a.t().and_then(|a| a.matmul(b)))
    }

    fn matmul_nt(&self, a: &Tensor, b: &Tensor) -> Tensor {
        done(b.t().and_then(|b| a.matmul(&b)))
    }

    fn linear(&self, x: &Tensor, weight: &Tensor, bias: &Tensor) -> Tensor {
        done(x.matmul(weight).and_then(|y| y.broadcast_add(bias)))
    }

    fn layer_norm(&self, x: &Tensor, gain: &Tensor, bias: &Tensor) -> Tensor {
        let normal = done(x.contiguous().and_then(|x| x.apply_op1(NormalRows)));
        done(normal.broadcast_mul(gain).and_then(|y| y.broadcast_add(bias)))
    }

    fn batch_norm(&self, x: &Tensor, (mean, variance): (&Tensor, &Tensor), gain: &Tensor, bias: &Tensor) -> Tensor {
        let scale = variance.affine(1.0, f64::from(crate::device::EPSILON)).and_then(|v| gain / v.sqrt()?);
        done(scale.and_then(|scale| x.broadcast_sub(mean)?.broadcast_mul(&scale)?.broadcast_add(bias)))
    }

    fn multiply(&self, a: &Tensor, b: &Tensor) -> Tensor {
        done(a * b)
    }

    fn relu(&self, x: &Tensor) -> Tensor {
        done(x.relu())
    }

    fn tanh(&self, x: &Tensor) -> Tensor {
        done(x.contiguous().and_then(|x| x.apply_op1(Tanh)))
    }

    fn diffuse(&self, x: &Tensor, lambda: &Tensor, log_times: &Tensor) -> Tensor {
        let decay = log_times.exp().and_then(|times| lambda.matmul(&times)).and_then(|rate| rate.neg()?.exp());
        done(decay.and_then(|decay| x * decay))
    }

    fn cross_pairs(&self, g: &Tensor) -> Tensor {
        done(g.contiguous().and_then(|g| g.apply_op1(CrossPairs)))
    }

    fn normalize_rows(&self, x: &Tensor) -> Tensor {
        done(x.contiguous().and_then(|x| x.apply_op1(UnitRows)))
    }

    fn softmax_rows(&self, x: &Tensor) -> Tensor {
        done(x.contiguous().and_then(|x| x.apply_op1(SoftmaxRows)))
    }

    fn attend(
        &self,
        (query, query_parts): (&Tensor, &Tensor),
        (key, key_parts): (&Tensor, &Tensor),
        value: &Tensor,
        mask: Mask,
    ) -> Tensor {
        let scale = 1.0 / (query.dims()[1] as f64).sqrt();
        let scores = done(self.matmul_nt(query, key).affine(scale, 0.0));
        let shared = self.matmul_nt(query_parts, key_parts);
        let weights = match mask {
            Mask::Soft => {
                let masked = shared.affine(1.0, 1e-6).and_then(|shared| scores + shared.log()?);
                self.softmax_rows(&done(masked))
            }
            Mask::Hard => done(shared.contiguous().and_then(|shared| scores.apply_op2(&shared, SoftmaxWithin))),
        };
        self.matmul(&weights, value)
    }

    fn solve_rows(&self, gram: &Tensor, right: &Tensor, mask: &Tensor) -> Tensor {
        let contiguous = |t: &Tensor| done(t.contiguous());
        done(contiguous(gram).apply_op3(&contiguous(right), &contiguous(mask), SolveRows))
    }

    fn leading_columns(&self, a: &Tensor, count: usize) -> Tensor {
        done(a.narrow(1, 0, count).and_then(|a| a.contiguous()))
    }

    fn concat(&self, parts: &[(&Tensor, f32)]) -> Tensor {
        let scaled: Vec<Tensor> = parts
            .iter()
            .map(|&(part, weight)| if weight == 1.0 { part.clone() } else { done(part.affine(f64::from(weight), 0.0)) })
            .collect();
        done(Tensor::cat(&scaled, 1))
    }

    fn add(&self, a: &Tensor, b: &Tensor, weight: f32) -> Tensor {
        if weight == 1.0 { done(a + b) } else { done(b.affine(f64::from(weight), 0.0).and_then(|b| a + b)) }
    }

    fn gather(&self, a: &Tensor, rows: &Vec<u32>) -> Tensor {
        let index = Tensor::new(rows.as_slice(), &candle_core::Device::Cpu);
        done(index.and_then(|index| a.contiguous()?.index_select(&index, 0)))
    }

    fn nearest_rows(&self, x: &Tensor, y: &Tensor, parts: Option<(&[u32], &[u32])>) -> (Vec<u32>, Vec<u32>) {
        Cpu.nearest_rows(&matrix(x), &matrix(y), parts)
    }
}
