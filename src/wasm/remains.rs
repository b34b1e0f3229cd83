//! What a dead instance leaves to be read: the last panic, and the request for memory that could not be met.
//!
//! A trap itself says only "unreachable". Without these notes a full memory could not be told from a bug.

use std::alloc::{GlobalAlloc, Layout, System};
use std::panic;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use wasm_bindgen::prelude::*;

static REFUSED: AtomicUsize = AtomicUsize::new(0);
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// The system's allocator, which notes the size of what it could not give.
struct Noting;

#[global_allocator]
static ALLOCATOR: Noting = Noting;

fn noted(given: *mut u8, size: usize) -> *mut u8 {
    if given.is_null() {
        REFUSED.store(size, Ordering::Relaxed);
    }
    given
}

// The hook for failed allocations is not in stable Rust; this is the only other place to hear of them.
#[allow(unsafe_code)] // Required by the trait; every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Noting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        noted(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        noted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        noted(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        unsafe { System.dealloc(block, layout) }
    }
}

/// Keeps the message of a panic, beside printing it.
pub(super) fn keep_panics() {
    panic::set_hook(Box::new(|panic| {
        console_error_panic_hook::hook(panic);
        if let Ok(mut last) = LAST_PANIC.try_lock() {
            let payload = panic.payload();
            let text = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
            *last = text.map(str::to_owned);
        }
    }));
}

/// Bytes of the last request for memory that was refused; 0 when none ever was.
#[wasm_bindgen]
pub fn refused_bytes() -> f64 {
    REFUSED.load(Ordering::Relaxed) as f64
}

/// Message of the panic that the instance died of.
#[wasm_bindgen]
pub fn last_panic() -> Option<String> {
    LAST_PANIC.try_lock().ok().and_then(|last| last.clone())
}
