//! The GPU through wgpu: WebGPU in the browser; Vulkan, Metal or DirectX 12 natively. Each launcher stands beside its shader and has the
//! name of its twin in `cpu/`; the pipelines of all shaders are made in `kernels`.
//!
//! Work is recorded, not done, until something is downloaded. What goes wrong (the device is lost, memory runs out, a driver refuses) travels through no
//! return value: it sets [`Device::failure`], after which every operation gives a tensor of the right shape with nothing in it and downloads
//! give zeros. Whoever downloads asks for the failure and repeats the work on the CPU.
//!
//! Not here, and why: products of sparse matrices, since gradients of eigenfunctions are made with the operators, on the CPU in f64, and come up dense;
//! second-best neighbours, since confidence is judged by what else is known; pipelines made in the background, since wgpu has no call for it. Features
//! come down when a shape is prepared, as bytes that outlive the device, and go up once with a match. In every round of refinement the systems of both maps and
//! the match come down, because solving and laying bodies onto each other are the CPU's work, and what they give goes up.

mod adapter;
mod agreement;
mod attention;
mod batch_norm;
mod columns;
mod counters;
mod cross_pairs;
mod dispatch;
mod failure;
mod kernel;
mod kernels;
mod matmul;
mod nearest_rows;
mod params;
mod pointwise;
mod pool;
mod recording;
mod rows;
mod solve_rows;
mod tensor;
mod transfer;

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use ndarray::{Array2, ArrayView2};

pub use adapter::{GpuInfo, GpuOptions};
pub use agreement::Agreement;
pub use counters::GpuCounters;
pub use pool::PoolSize;
pub use tensor::{GpuIndices, GpuTensor};

use super::{Device, Mask};
use failure::{Failure, Watch};
use kernels::Kernels;
use params::Transposed;
use pool::Pool;
use recording::{ARENA, Recording};

/// A graphics processor.
#[derive(Debug)]
pub struct Gpu {
    info: GpuInfo,
    device: wgpu::Device,
    queue: wgpu::Queue,
    failure: Failure,
    watch: Watch,
    kernels: Kernels,
    pool: Rc<Pool>,
    /// Parameters of the dispatches of one submission.
    arena: wgpu::Buffer,
    /// Bytes of the largest matrix that shaders can see.
    largest_binding: u64,
    recording: RefCell<Recording>,
    counters: Cell<GpuCounters>,
}

impl Gpu {
    /// Opens a GPU, or says why there is none.
    pub async fn new(options: GpuOptions) -> Result<Self, String> {
        let adapter::Opened { info, device, queue, failure } = adapter::open(options).await?;
        let kernels = Kernels::new(&device);
        let arena = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("parameters"),
            size: ARENA as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let largest_binding = device.limits().max_storage_buffer_binding_size;
        let gpu = Self {
            info,
            device,
            queue,
            failure,
            watch: Watch::default(),
            kernels,
            pool: Rc::default(),
            arena,
            largest_binding,
            recording: RefCell::default(),
            counters: Cell::default(),
        };
        gpu.begin_watch();
        match gpu.failure() {
            Some(message) => Err(message),
            None => Ok(gpu),
        }
    }

    /// Which device this is.
    pub fn info(&self) -> &GpuInfo {
        &self.info
    }

    /// What was done so far.
    pub fn counters(&self) -> GpuCounters {
        self.counters.get()
    }

    /// Memory held at the moment.
    pub fn pool_size(&self) -> PoolSize {
        self.pool.size()
    }

    /// Gives back memory that waits to be used again, but for `most` bytes.
    pub fn trim(&self, most: u64) {
        self.submit();
        self.pool.trim(most);
    }

    /// Ends the device as a driver might, for tests.
    pub fn destroy(&self) {
        self.device.destroy();
    }

    /// What ends the device, to be kept by others.
    pub(crate) fn losing(&self) -> impl Fn() + 'static {
        let device = self.device.clone();
        move || device.destroy()
    }

    fn count(&self, change: impl FnOnce(&mut GpuCounters)) {
        let mut counters = self.counters.get();
        change(&mut counters);
        self.counters.set(counters);
    }

    /// An unwritten matrix.
    fn tensor(&self, rows: usize, cols: usize) -> GpuTensor {
        GpuTensor { memory: self.room(rows * cols), rows, cols }
    }

    /// Unwritten indices, each to be below `bound`.
    fn indices(&self, count: usize, bound: usize) -> GpuIndices {
        GpuIndices { memory: self.room(count), count, bound }
    }
}

impl Drop for Gpu {
    /// Frees its memory now; a browser would wait for the garbage collector.
    fn drop(&mut self) {
        self.device.destroy();
    }
}

impl Device for Gpu {
    type Tensor = GpuTensor;
    type Indices = GpuIndices;

    fn failure(&self) -> Option<String> {
        self.listen();
        self.failure.message().map(str::to_owned)
    }

    fn upload(&self, matrix: ArrayView2<f32>) -> GpuTensor {
        let (rows, cols) = matrix.dim();
        let values = matrix.as_standard_layout();
        let values = values.as_slice().expect("standard layout");
        GpuTensor { memory: self.send(bytemuck::cast_slice(values)), rows, cols }
    }

    fn upload_indices(&self, indices: &[u32]) -> GpuIndices {
        GpuIndices { memory: self.send(bytemuck::cast_slice(indices)), count: indices.len(), bound: usize::MAX }
    }

    async fn download(&self, tensor: &GpuTensor) -> Array2<f32> {
        let bytes = self.fetch(&tensor.memory, 4 * tensor.len() as u64).await;
        let values = bytes.map(|bytes| bytemuck::pod_collect_to_vec::<u8, f32>(&bytes));
        let matrix = values.and_then(|values| Array2::from_shape_vec(tensor.dim(), values).ok());
        matrix.unwrap_or_else(|| Array2::zeros(tensor.dim()))
    }

    async fn download_indices(&self, indices: &GpuIndices) -> Vec<u32> {
        let bytes = self.fetch(&indices.memory, 4 * indices.count as u64).await;
        let values = bytes.map(|bytes| bytemuck::pod_collect_to_vec::<u8, u32>(&bytes));
        let none = || vec![0; indices.count];
        if values.iter().flatten().any(|&index| index as usize >= indices.bound.max(1)) {
            self.failure.set("the GPU gave an index that there is not".to_owned());
            return none();
        }
        values.unwrap_or_else(none)
    }

    fn matmul(&self, a: &GpuTensor, b: &GpuTensor) -> GpuTensor {
        self.product(a, b, Transposed::Neither, None)
    }

    fn matmul_tn(&self, a: &GpuTensor, b: &GpuTensor) -> GpuTensor {
        self.product(a, b, Transposed::Left, None)
    }

    fn matmul_nt(&self, a: &GpuTensor, b: &GpuTensor) -> GpuTensor {
        self.product(a, b, Transposed::Right, None)
    }

    fn linear(&self, x: &GpuTensor, weight: &GpuTensor, bias: &GpuTensor) -> GpuTensor {
        self.product(x, weight, Transposed::Neither, Some(bias))
    }

    fn layer_norm(&self, x: &GpuTensor, gain: &GpuTensor, bias: &GpuTensor) -> GpuTensor {
        self.by_rows(&self.kernels.rows.layer_norm, x, Some((gain, bias)), x.cols, 8)
    }

    fn batch_norm(
        &self,
        x: &GpuTensor,
        statistics: (&GpuTensor, &GpuTensor),
        gain: &GpuTensor,
        bias: &GpuTensor,
    ) -> GpuTensor {
        self.normalize_columns(x, statistics, gain, bias)
    }

    fn multiply(&self, a: &GpuTensor, b: &GpuTensor) -> GpuTensor {
        assert_eq!(a.dim(), b.dim(), "values to multiply");
        self.by_value(&self.kernels.pointwise.multiply, a, [&b.memory, &b.memory], 1.0, 1)
    }

    fn relu(&self, x: &GpuTensor) -> GpuTensor {
        self.by_value(&self.kernels.pointwise.relu, x, [&x.memory, &x.memory], 1.0, 1)
    }

    fn tanh(&self, x: &GpuTensor) -> GpuTensor {
        self.by_value(&self.kernels.pointwise.tanh, x, [&x.memory, &x.memory], 1.0, 5)
    }

    fn diffuse(&self, x: &GpuTensor, lambda: &GpuTensor, log_times: &GpuTensor) -> GpuTensor {
        assert_eq!(
            (lambda.dim(), log_times.dim()),
            ((x.rows, 1), (1, x.cols)),
            "an eigenvalue per row, a time per column"
        );
        self.by_value(&self.kernels.pointwise.diffuse, x, [&lambda.memory, &log_times.memory], 1.0, 4)
    }

    fn cross_pairs(&self, g: &GpuTensor) -> GpuTensor {
        self.cross_of_pairs(g)
    }

    fn normalize_rows(&self, x: &GpuTensor) -> GpuTensor {
        self.by_rows(&self.kernels.rows.normalize_rows, x, None, x.cols, 3)
    }

    fn softmax_rows(&self, x: &GpuTensor) -> GpuTensor {
        self.by_rows(&self.kernels.rows.softmax_rows, x, None, x.cols, 5)
    }

    fn attend(
        &self,
        query: (&GpuTensor, &GpuTensor),
        key: (&GpuTensor, &GpuTensor),
        value: &GpuTensor,
        mask: Mask,
    ) -> GpuTensor {
        self.stream_attention(query, key, value, mask)
    }

    fn solve_rows(&self, gram: &GpuTensor, right: &GpuTensor, mask: &GpuTensor) -> GpuTensor {
        self.solve_systems(gram, right, mask)
    }

    fn leading_columns(&self, a: &GpuTensor, count: usize) -> GpuTensor {
        self.side_by_side(a.rows, &[(a, count, 1.0)])
    }

    fn concat(&self, parts: &[(&GpuTensor, f32)]) -> GpuTensor {
        let rows = parts.first().expect("something to put side by side").0.rows;
        let parts: Vec<_> = parts.iter().map(|&(part, weight)| (part, part.cols, weight)).collect();
        self.side_by_side(rows, &parts)
    }

    fn add(&self, a: &GpuTensor, b: &GpuTensor, weight: f32) -> GpuTensor {
        assert_eq!(a.dim(), b.dim(), "values to add");
        self.by_value(&self.kernels.pointwise.add, a, [&b.memory, &b.memory], weight, 2)
    }

    fn gather(&self, a: &GpuTensor, rows: &GpuIndices) -> GpuTensor {
        self.in_order(a, rows)
    }

    fn nearest_rows(&self, x: &GpuTensor, y: &GpuTensor, parts: Option<(&[u32], &[u32])>) -> (GpuIndices, GpuIndices) {
        self.nearest_both_ways(x, y, parts)
    }
}
