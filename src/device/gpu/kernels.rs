//! The pipelines of all shaders, made once.

use super::kernel::{Family, Kernel};
use super::params::{
    Attention, BatchNorm, Columns, CrossPairs, Matmul, NearestMerge, NearestRows, Pointwise, Rows, SolveRows,
};

/// Every pipeline, made once.
#[derive(Debug)]
pub(super) struct Kernels {
    pub attention: Kernel,
    pub batch_norm: Kernel,
    pub columns: ColumnKernels,
    pub cross_pairs: Kernel,
    pub matmul: MatmulKernels,
    pub nearest: NearestKernels,
    pub pointwise: PointwiseKernels,
    pub rows: RowKernels,
    pub solve_rows: Kernel,
}

impl Kernels {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            attention: attention(device),
            batch_norm: batch_norm(device),
            columns: ColumnKernels::new(device),
            cross_pairs: cross_pairs(device),
            matmul: MatmulKernels::new(device),
            nearest: NearestKernels::new(device),
            pointwise: PointwiseKernels::new(device),
            rows: RowKernels::new(device),
            solve_rows: solve_rows(device),
        }
    }
}

/// The pipeline of `attention.wgsl`.
fn attention(device: &wgpu::Device) -> Kernel {
    let source = include_str!("attention.wgsl");
    Family::new::<Attention>(device, "attention", source, 5, 1).kernel("attend", &[])
}

/// The pipeline of `batch_norm.wgsl`.
fn batch_norm(device: &wgpu::Device) -> Kernel {
    Family::new::<BatchNorm>(device, "batch_norm", include_str!("batch_norm.wgsl"), 5, 1).kernel("batch_norm", &[])
}

/// The pipeline of `cross_pairs.wgsl`.
fn cross_pairs(device: &wgpu::Device) -> Kernel {
    let source = include_str!("cross_pairs.wgsl");
    Family::new::<CrossPairs>(device, "cross_pairs", source, 1, 1).kernel("cross_pairs", &[])
}

/// The pipeline of `solve_rows.wgsl`.
fn solve_rows(device: &wgpu::Device) -> Kernel {
    let source = include_str!("solve_rows.wgsl");
    Family::new::<SolveRows>(device, "solve_rows", source, 3, 2).kernel("solve_rows", &[])
}

/// Pipelines of `columns.wgsl`.
#[derive(Debug)]
pub(super) struct ColumnKernels {
    pub beside: Kernel,
    pub gather: Kernel,
}

impl ColumnKernels {
    pub fn new(device: &wgpu::Device) -> Self {
        let family = Family::new::<Columns>(device, "columns", include_str!("columns.wgsl"), 2, 1);
        Self { beside: family.kernel("beside", &[]), gather: family.kernel("gather", &[]) }
    }
}

/// Pipelines of `matmul.wgsl`.
#[derive(Debug)]
pub(super) struct MatmulKernels {
    pub plain: Kernel,
    pub left: Kernel,
    pub right: Kernel,
    pub sum: Kernel,
}

impl MatmulKernels {
    pub fn new(device: &wgpu::Device) -> Self {
        let family = Family::new::<Matmul>(device, "matmul", include_str!("matmul.wgsl"), 3, 1);
        Self {
            plain: family.kernel("matmul", &[]),
            left: family.kernel("matmul", &[("transposed_a", 1.0)]),
            right: family.kernel("matmul", &[("transposed_b", 1.0)]),
            sum: family.kernel("sum", &[]),
        }
    }
}

/// Pipelines of `nearest_rows.wgsl` and `nearest_merge.wgsl`, without labels and with.
#[derive(Debug)]
pub(super) struct NearestKernels {
    pub compare: [Kernel; 2],
    pub merge: [Kernel; 2],
}

impl NearestKernels {
    pub fn new(device: &wgpu::Device) -> Self {
        let compare = Family::new::<NearestRows>(device, "nearest_rows", include_str!("nearest_rows.wgsl"), 6, 2);
        let merge = Family::new::<NearestMerge>(device, "nearest_merge", include_str!("nearest_merge.wgsl"), 1, 2);
        Self {
            compare: [0.0, 1.0].map(|labelled| compare.kernel("nearest_rows", &[("labelled", labelled)])),
            merge: [0.0, 1.0].map(|labelled| merge.kernel("nearest_merge", &[("labelled", labelled)])),
        }
    }
}

/// Pipelines of `pointwise.wgsl`.
#[derive(Debug)]
pub(super) struct PointwiseKernels {
    pub multiply: Kernel,
    pub add: Kernel,
    pub relu: Kernel,
    pub tanh: Kernel,
    pub diffuse: Kernel,
}

impl PointwiseKernels {
    pub fn new(device: &wgpu::Device) -> Self {
        let family = Family::new::<Pointwise>(device, "pointwise", include_str!("pointwise.wgsl"), 3, 1);
        Self {
            multiply: family.kernel("multiply", &[]),
            add: family.kernel("add", &[]),
            relu: family.kernel("relu", &[]),
            // `tanh` itself is taken in the language.
            tanh: family.kernel("hyperbolic_tangent", &[]),
            diffuse: family.kernel("diffuse", &[]),
        }
    }
}

/// Pipelines of `rows.wgsl`.
#[derive(Debug)]
pub(super) struct RowKernels {
    pub layer_norm: Kernel,
    pub normalize_rows: Kernel,
    pub softmax_rows: Kernel,
    pub squares: Kernel,
}

impl RowKernels {
    pub fn new(device: &wgpu::Device) -> Self {
        let family = Family::new::<Rows>(device, "rows", include_str!("rows.wgsl"), 3, 1);
        Self {
            layer_norm: family.kernel("layer_norm", &[]),
            normalize_rows: family.kernel("normalize_rows", &[]),
            softmax_rows: family.kernel("softmax_rows", &[]),
            squares: family.kernel("squares", &[]),
        }
    }
}
