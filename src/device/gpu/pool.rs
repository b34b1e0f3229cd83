//! Buffers that are used again, by size class.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Bytes of buffers in waiting above which those that come back are freed instead.
const IDLE_LIMIT: u64 = 512 << 20;
/// The smallest buffer; an empty matrix has one too, because bindings cannot be empty.
const SMALLEST: u64 = 256;

/// What a buffer is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Use {
    /// Read and written by shaders.
    Storage,
    /// Read by the processor.
    Download,
}

/// How much memory a device holds, in use or waiting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PoolSize {
    /// Buffers.
    pub buffers: usize,
    /// Bytes of them.
    pub bytes: u64,
    /// Bytes of those that wait to be used again.
    pub idle_bytes: u64,
}

#[derive(Debug, Default)]
struct Shelves {
    idle: BTreeMap<(Use, u64), Vec<wgpu::Buffer>>,
    /// No longer wanted, but perhaps named by commands that were not submitted yet.
    condemned: Vec<wgpu::Buffer>,
    size: PoolSize,
}

/// The buffers of one device.
#[derive(Debug, Default)]
pub(super) struct Pool(RefCell<Shelves>);

/// A buffer in use.
#[derive(Debug)]
pub(super) struct Memory {
    /// None on a device that failed.
    buffer: Option<wgpu::Buffer>,
    class: (Use, u64),
    /// Bytes asked for; the buffer has at least as many.
    pub bytes: u64,
    /// Whether earlier commands may have used it.
    pub reused: bool,
    pool: Rc<Pool>,
}

impl Memory {
    pub fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.buffer.as_ref()
    }
}

impl Pool {
    /// At least `bytes` from `device`, or nothing at all without one.
    pub fn take(self: &Rc<Self>, device: Option<&wgpu::Device>, purpose: Use, bytes: u64) -> Memory {
        let class = (purpose, bytes.max(SMALLEST).next_power_of_two());
        let mut shelves = self.0.borrow_mut();
        let waiting = device.and_then(|_| shelves.idle.get_mut(&class)?.pop());
        let reused = waiting.is_some();
        if reused {
            shelves.size.idle_bytes -= class.1;
        }
        let buffer = waiting.or_else(|| {
            let device = device?;
            shelves.size.buffers += 1;
            shelves.size.bytes += class.1;
            let usage = match purpose {
                Use::Storage => {
                    wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST
                }
                Use::Download => wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            };
            let descriptor = wgpu::BufferDescriptor { label: None, size: class.1, usage, mapped_at_creation: false };
            Some(device.create_buffer(&descriptor))
        });
        Memory { buffer, class, bytes, reused, pool: Rc::clone(self) }
    }

    /// Frees what was condemned: right after a submission nothing unsubmitted names it.
    pub fn free_condemned(&self) {
        for buffer in self.0.borrow_mut().condemned.drain(..) {
            buffer.destroy();
        }
    }

    /// Frees buffers in waiting until they hold at most `most` bytes. Nothing unsubmitted may name them.
    pub fn trim(&self, most: u64) {
        let shelves = &mut *self.0.borrow_mut();
        for (&(_, bytes), waiting) in shelves.idle.iter_mut().rev() {
            while shelves.size.idle_bytes > most
                && let Some(buffer) = waiting.pop()
            {
                buffer.destroy();
                shelves.size.buffers -= 1;
                shelves.size.bytes -= bytes;
                shelves.size.idle_bytes -= bytes;
            }
        }
    }

    pub fn size(&self) -> PoolSize {
        self.0.borrow().size
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        let Some(buffer) = self.buffer.take() else { return };
        let mut shelves = self.pool.0.borrow_mut();
        let bytes = self.class.1;
        if shelves.size.idle_bytes + bytes > IDLE_LIMIT {
            shelves.size.buffers -= 1;
            shelves.size.bytes -= bytes;
            shelves.condemned.push(buffer);
        } else {
            shelves.size.idle_bytes += bytes;
            shelves.idle.entry(self.class).or_default().push(buffer);
        }
    }
}
