//! Bytes to the GPU and back.

use std::future::poll_fn;
use std::rc::Rc;
use std::sync::{Arc, Mutex};
use std::task::{Poll, Waker};

use super::Gpu;
use super::pool::{Memory, Use};

impl Gpu {
    /// Room for `values` 32-bit numbers; none on a device that failed.
    pub(super) fn room(&self, values: usize) -> Rc<Memory> {
        let bytes = 4 * values as u64;
        let most = self.largest_binding;
        if bytes > most {
            self.failure.set(format!("a matrix takes {} MiB, of {} that a shader sees", bytes >> 20, most >> 20));
        }
        Rc::new(self.pool.take(self.device_in_order(), Use::Storage, bytes))
    }

    fn device_in_order(&self) -> Option<&wgpu::Device> {
        (!self.failure.is_set()).then_some(&self.device)
    }

    /// Copies 32-bit numbers to the GPU.
    pub(super) fn send(&self, values: &[u8]) -> Rc<Memory> {
        let memory = self.room(values.len() / 4);
        let Some(buffer) = memory.buffer() else { return memory };
        if memory.reused {
            // The copy would overtake recorded commands, which may still read what the buffer held.
            self.submit();
        }
        if !values.is_empty() {
            self.queue.write_buffer(buffer, 0, values);
        }
        self.count(|counters| {
            counters.uploads += 1;
            counters.bytes_up += values.len() as u64;
        });
        memory
    }

    /// Waits for the first `bytes` of a buffer; nothing when the device has failed.
    pub(super) async fn fetch(&self, memory: &Memory, bytes: u64) -> Option<Vec<u8>> {
        if bytes == 0 {
            return Some(Vec::new());
        }
        let staging = self.pool.take(self.device_in_order(), Use::Download, bytes);
        let target = staging.buffer()?;
        self.copy(memory.buffer()?, target, bytes);
        self.submit();
        if self.failure.is_set() {
            return None;
        }
        let (mapped, signal) = signal();
        target.map_async(wgpu::MapMode::Read, ..bytes, move |result| mapped.give(result.is_ok()));
        self.wait();
        let arrived = signal.await;
        self.hear_complaints().await;
        if !arrived {
            self.failure.set("the GPU did not hand back its results".to_owned());
            return None;
        }
        let values = target.get_mapped_range(..bytes).map(|view| view.to_vec());
        target.unmap();
        if self.failure.is_set() {
            return None;
        }
        self.count(|counters| {
            counters.downloads += 1;
            counters.bytes_down += bytes;
        });
        values.map_err(|error| self.failure.set(error.to_string())).ok()
    }

    /// Hears from the GPU what it has to say, natively; browsers tell by themselves.
    pub(super) fn listen(&self) {
        #[cfg(not(target_arch = "wasm32"))]
        self.poll(wgpu::PollType::Poll);
    }

    /// Natively somebody has to wait for the GPU; browsers do so by themselves.
    fn wait(&self) {
        #[cfg(not(target_arch = "wasm32"))]
        self.poll(wgpu::PollType::wait_indefinitely());
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn poll(&self, how: wgpu::PollType) {
        // wgpu 30 panics when a driver loses the device here, which is no reason to end the program.
        match std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| self.device.poll(how))) {
            Ok(Ok(_)) => {}
            Ok(Err(error)) => self.failure.set(format!("waiting for the GPU failed: {error}")),
            Err(_) => self.failure.set_lost("the GPU was lost while it worked".to_owned()),
        }
    }
}

/// What the two ends of a signal share.
#[derive(Default)]
struct Pending {
    outcome: Option<bool>,
    waker: Option<Waker>,
}

/// The end that is given the outcome; dropped without one, it gives false.
struct Given(Arc<Mutex<Pending>>);

impl Given {
    fn give(&self, outcome: bool) {
        let mut pending = self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        pending.outcome.get_or_insert(outcome);
        if let Some(waker) = pending.waker.take() {
            waker.wake();
        }
    }
}

impl Drop for Given {
    fn drop(&mut self) {
        self.give(false);
    }
}

/// A callback's outcome as something to wait for.
fn signal() -> (Given, impl Future<Output = bool>) {
    let pending = Arc::new(Mutex::new(Pending::default()));
    let given = Given(Arc::clone(&pending));
    let outcome = poll_fn(move |context| {
        let mut pending = pending.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        match pending.outcome {
            Some(outcome) => Poll::Ready(outcome),
            None => {
                pending.waker = Some(context.waker().clone());
                Poll::Pending
            }
        }
    });
    (given, outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_tells_its_outcome_and_that_there_will_be_none() {
        let (given, outcome) = signal();
        given.give(true);
        drop(given);
        assert!(pollster::block_on(outcome));
        let (given, outcome) = signal();
        std::thread::spawn(move || drop(given));
        assert!(!pollster::block_on(outcome));
    }
}
