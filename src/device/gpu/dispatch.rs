//! Commands on their way to the GPU, and what it complains of.

use super::Gpu;
use super::failure::sentence;
use super::kernel::Kernel;
use super::params::Params;
use super::pool::Memory;
use super::recording::{ARENA, SLOT, WORK_LIMIT};

impl Gpu {
    /// Records one dispatch of `groups` workgroups on `buffers`, in the order of the shader's bindings; `work` are its floating-point operations.
    pub(super) fn run(&self, kernel: &Kernel, params: impl Params, buffers: &[&Memory], groups: [u32; 3], work: u64) {
        if groups.contains(&0) || self.failure.is_set() {
            return;
        }
        let Some(bound) = buffers.iter().map(|memory| memory.buffer()).collect::<Option<Vec<_>>>() else { return };
        let full = {
            let recording = self.recording.borrow();
            recording.params.len() + SLOT > ARENA || recording.work + work > WORK_LIMIT
        };
        if full {
            self.submit();
        }
        let uniform = wgpu::BufferBinding { buffer: &self.arena, offset: 0, size: Some(kernel.params) };
        let entries: Vec<_> = std::iter::once(wgpu::BindingResource::Buffer(uniform))
            .chain(bound.iter().map(|buffer| buffer.as_entire_binding()))
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(kernel.name),
            layout: &kernel.bindings,
            entries: &entries,
        });
        let mut recording = self.recording.borrow_mut();
        let slot = recording.params.len();
        recording.params.extend_from_slice(&params.bytes());
        recording.params.resize(slot + SLOT, 0);
        recording.work += work;
        let mut pass = recording
            .encoder(&self.device)
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(kernel.name), timestamp_writes: None });
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, &group, &[slot as u32]);
        pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
        self.count(|counters| {
            counters.dispatches += 1;
            counters.flops += work;
            // Bindings that a shader has no use for name a buffer again.
            let first =
                |&(i, memory): &(usize, &&Memory)| !buffers[..i].iter().any(|earlier| std::ptr::eq(*earlier, *memory));
            counters.bytes_touched +=
                buffers.iter().enumerate().filter(first).map(|(_, memory)| memory.bytes).sum::<u64>();
        });
    }

    /// Records a copy of the first `bytes`.
    pub(super) fn copy(&self, from: &wgpu::Buffer, to: &wgpu::Buffer, bytes: u64) {
        self.recording.borrow_mut().encoder(&self.device).copy_buffer_to_buffer(from, 0, to, 0, bytes);
    }

    /// Hands what was recorded to the GPU.
    pub(super) fn submit(&self) {
        let mut recording = self.recording.borrow_mut();
        let Some(encoder) = recording.encoder.take() else { return };
        recording.work = 0;
        let params = std::mem::take(&mut recording.params);
        drop(recording);
        if !params.is_empty() {
            self.queue.write_buffer(&self.arena, 0, &params);
        }
        self.queue.submit([encoder.finish()]);
        self.pool.free_condemned();
        self.count(|counters| counters.submissions += 1);
        self.listen();
    }

    /// Everything from here on is watched.
    pub(super) fn begin_watch(&self) {
        self.watch.begin(&self.device);
    }

    /// Waits for what the device has to say of all that was handed to it since, and begins anew.
    pub(super) async fn hear_complaints(&self) {
        let complaints = self.watch.end();
        self.begin_watch();
        for complaint in complaints {
            if let Some(error) = complaint.await {
                self.failure.set(sentence(&error));
            }
        }
    }
}
