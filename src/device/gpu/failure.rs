//! The first thing that went wrong on a device.

use std::sync::{Arc, OnceLock};

/// Shared with the callbacks of the device. Once set it stays: a device that failed is not used again.
#[derive(Clone, Debug, Default)]
pub(super) struct Failure(Arc<OnceLock<String>>);

impl Failure {
    /// Keeps the first message; later ones are its consequences.
    pub fn set(&self, message: String) {
        self.0.get_or_init(|| message);
    }

    pub fn message(&self) -> Option<&str> {
        self.0.get().map(String::as_str)
    }

    pub fn is_set(&self) -> bool {
        self.0.get().is_some()
    }
}
