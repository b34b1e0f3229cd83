//! What went wrong on a device.

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
