//! What went wrong on a device.

use std::cell::RefCell;
use std::sync::{Arc, OnceLock};

/// Shared with the callbacks of the device. Once set it stays: a device that failed is not used again.
#[derive(Clone, Debug, Default)]
pub(super) struct Failure(Arc<Messages>);

/// The first of each kind; later ones are consequences.
#[derive(Debug, Default)]
struct Messages {
    lost: OnceLock<String>,
    refused: OnceLock<String>,
}

impl Failure {
    /// Work was refused, or its results did not come.
    pub fn set(&self, message: String) {
        self.0.refused.get_or_init(|| message);
    }

    /// The device is gone. Drivers refuse work for that reason before they say so.
    pub fn set_lost(&self, message: String) {
        self.0.lost.get_or_init(|| message);
    }

    /// The cause, as far as it is known.
    pub fn message(&self) -> Option<&str> {
        self.0.lost.get().or(self.0.refused.get()).map(String::as_str)
    }

    pub fn is_set(&self) -> bool {
        self.message().is_some()
    }
}

/// What the device complains of between two downloads. Its callback hears of the same, but in some browsers only after the bytes have come.
#[derive(Debug, Default)]
pub(super) struct Watch(RefCell<Option<[wgpu::ErrorScopeGuard; 2]>>);

impl Watch {
    pub fn begin(&self, device: &wgpu::Device) {
        let filters = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];
        *self.0.borrow_mut() = Some(filters.map(|filter| device.push_error_scope(filter)));
    }

    /// The inner scope first, as they nest.
    pub fn end(&self) -> Vec<impl Future<Output = Option<wgpu::Error>> + use<>> {
        let scopes = self.0.borrow_mut().take();
        scopes.into_iter().flatten().rev().map(wgpu::ErrorScopeGuard::pop).collect()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        drop(self.end());
    }
}

/// An error of the device for a person.
pub(super) fn sentence(error: &wgpu::Error) -> String {
    match error {
        wgpu::Error::OutOfMemory { .. } => "the GPU is out of memory".to_owned(),
        other => format!("the GPU refused its work: {other}"),
    }
}
