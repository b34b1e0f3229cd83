//! Shaders made ready to run.

use std::num::NonZeroU64;

use super::params::Params;

/// A shader's entry point as a pipeline. Its bindings: `Params`, then buffers that it reads, then those that it writes.
#[derive(Debug)]
pub(super) struct Kernel {
    pub name: &'static str,
    pub pipeline: wgpu::ComputePipeline,
    pub bindings: wgpu::BindGroupLayout,
    pub params: NonZeroU64,
}

/// The entry points of one shader, which have one layout of bindings.
pub(super) struct Family<'a> {
    device: &'a wgpu::Device,
    module: wgpu::ShaderModule,
    bindings: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    params: NonZeroU64,
}

impl<'a> Family<'a> {
    /// A shader with `Params` P that binds `reads` and then `writes` buffers.
    pub fn new<P: Params>(device: &'a wgpu::Device, name: &str, source: &str, reads: u32, writes: u32) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let params = NonZeroU64::new(P::SIZE as u64).expect("params are not empty");
        let entry = |binding: u32, ty, dynamic, least| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: dynamic, min_binding_size: least },
            count: None,
        };
        let storage = |i: u32| entry(1 + i, wgpu::BufferBindingType::Storage { read_only: i < reads }, false, None);
        let entries: Vec<_> = std::iter::once(entry(0, wgpu::BufferBindingType::Uniform, true, Some(params)))
            .chain((0..reads + writes).map(storage))
            .collect();
        let bindings =
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(name), entries: &entries });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&bindings)],
            ..Default::default()
        });
        Self { device, module, bindings, layout, params }
    }

    /// One of its entry points, with values for its `override` constants.
    pub fn kernel(&self, entry: &'static str, constants: &[(&str, f64)]) -> Kernel {
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&self.layout),
            module: &self.module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        Kernel { name: entry, pipeline, bindings: self.bindings.clone(), params: self.params }
    }
}
