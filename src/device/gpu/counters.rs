//! What the GPU was asked to do.

/// Counted since the device was opened. Work is that of the arithmetic's definition: what tiles waste at their edges is not in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuCounters {
    /// Matrices and lists copied to the device.
    pub uploads: u64,
    /// Bytes of them.
    pub bytes_up: u64,
    /// Matrices and lists copied back.
    pub downloads: u64,
    /// Bytes of them.
    pub bytes_down: u64,
    /// Shaders run.
    pub dispatches: u64,
    /// Pieces in which they were handed over.
    pub submissions: u64,
    /// Floating-point operations; a fused multiply and add counts as two, an exponential as one.
    pub flops: u64,
    /// Bytes of the buffers that dispatches named, each once per dispatch, whole: about what moves between memory and processor, where caches are perfect.
    pub bytes_touched: u64,
}

impl std::ops::Sub for GpuCounters {
    type Output = Self;

    /// What came after `earlier`.
    fn sub(self, earlier: Self) -> Self {
        Self {
            uploads: self.uploads - earlier.uploads,
            bytes_up: self.bytes_up - earlier.bytes_up,
            downloads: self.downloads - earlier.downloads,
            bytes_down: self.bytes_down - earlier.bytes_down,
            dispatches: self.dispatches - earlier.dispatches,
            submissions: self.submissions - earlier.submissions,
            flops: self.flops - earlier.flops,
            bytes_touched: self.bytes_touched - earlier.bytes_touched,
        }
    }
}
