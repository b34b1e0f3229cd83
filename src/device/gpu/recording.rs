//! Commands before they are handed to the GPU, and how much of them goes together: none runs long.

/// Floating-point operations of one dispatch, and of one submission: 0.02 s at 100 GFlop/s. A graphics driver that shares the screen gives up on work
/// after 2 s, and even the slowest of them is not fifty times slower.
pub(super) const WORK_LIMIT: u64 = 1 << 31;
/// Parameters of a dispatch lie at multiples of this, which WebGPU guarantees to be allowed.
pub(super) const SLOT: usize = 256;
/// Bytes of parameters, and with them the number of dispatches, of one submission.
pub(super) const ARENA: usize = 256 * SLOT;
/// Workgroups in one direction of a dispatch.
const MOST_GROUPS: usize = 65535;

/// What was recorded since the last submission.
#[derive(Debug, Default)]
pub(super) struct Recording {
    pub encoder: Option<wgpu::CommandEncoder>,
    pub params: Vec<u8>,
    pub work: u64,
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

impl Recording {
    pub fn encoder(&mut self, device: &wgpu::Device) -> &mut wgpu::CommandEncoder {
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
