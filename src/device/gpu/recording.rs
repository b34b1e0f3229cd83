//! Commands on their way to the GPU, in pieces small enough that none of them runs long.

use super::Gpu;
use super::kernel::Kernel;
use super::params::Params;
use super::pool::Memory;

/// Floating-point operations of one dispatch, and of one submission: 0.02 s at 100 GFlop/s. A graphics driver that shares the screen gives up on work
/// after 2 s, and even the slowest of them is not fifty times slower.
pub(super) const WORK_LIMIT: u64 = 1 << 31;
/// Parameters of a dispatch lie at multiples of this, which WebGPU guarantees to be allowed.
const SLOT: usize = 256;
/// Bytes of parameters, and with them the number of dispatches, of one submission.
pub(super) const ARENA: usize = 256 * SLOT;
/// Workgroups in one direction of a dispatch.
const MOST_GROUPS: usize = 65535;

/// What was recorded since the last submission.
#[derive(Debug, Default)]
pub(super) struct Recording {
    encoder: Option<wgpu::CommandEncoder>,
    params: Vec<u8>,
    work: u64,
}

/// `count` workgroups in two directions; shaders find theirs at y · width + x, and those beyond `count` have nothing to do.
pub(super) fn grid(count: usize) -> [u32; 3] {
    let width = count.min(MOST_GROUPS);
    [width as u32, if width == 0 { 0 } else { count.div_ceil(width) as u32 }, 1]
}

/// How many rows one dispatch may take when each costs `work`: a multiple of `tile`.
pub(super) fn rows_per_dispatch(work: u64, tile: usize) -> usize {
    let tiles = WORK_LIMIT / (work.max(1) * tile as u64).max(1);
    (tiles.clamp(1, MOST_GROUPS as u64)) as usize * tile
}

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
}

impl Recording {
    fn encoder(&mut self, device: &wgpu::Device) -> &mut wgpu::CommandEncoder {
        self.encoder.get_or_insert_with(|| device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_holds_every_workgroup_within_the_limits() {
        for count in [0, 1, 64, MOST_GROUPS, MOST_GROUPS + 1, 3 * MOST_GROUPS, 1_000_000] {
            let [width, height, depth] = grid(count).map(|n| n as usize);
            assert!(width * height * depth >= count && width.max(height) <= MOST_GROUPS, "{count}");
        }
    }

    #[test]
    fn dispatches_take_whole_tiles_and_no_more_work_than_allowed() {
        for work in [0, 1, 1000, WORK_LIMIT / 64, WORK_LIMIT] {
            let rows = rows_per_dispatch(work, 64);
            assert!(rows >= 64 && rows.is_multiple_of(64));
            assert!(rows == 64 || rows as u64 * work <= WORK_LIMIT, "{work}");
        }
    }
}
