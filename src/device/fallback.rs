//! When a device fails: where it did, why, and how its work ends.

use serde::{Deserialize, Serialize};

use super::Device;
use crate::progress::{Cancelled, Stage};

/// Where a device failed, so that the CPU did the work again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fallback {
    /// The stage in which it failed.
    pub stage: Stage,
    /// What the device said.
    pub reason: String,
}

/// Why work on a device ended before it was done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Interrupted {
    /// The listener asked for it.
    Cancelled(Cancelled),
    /// The device failed.
    Failed(Fallback),
    /// What it computed with, or from, are no finite numbers.
    NotFinite(Stage),
}

impl Interrupted {
    /// Why the CPU is to do the work again; nothing for who was asked to stop.
    pub(crate) fn fallback(&self) -> Option<Fallback> {
        match self {
            Self::Cancelled(_) => None,
            Self::Failed(fallback) => Some(fallback.clone()),
            Self::NotFinite(stage) => {
                Some(Fallback { stage: *stage, reason: "it came to something that is no finite number".to_owned() })
            }
        }
    }
}

impl From<Cancelled> for Interrupted {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

/// Ends the work of a stage on a device that has failed. To be asked after downloads: before them nothing may have happened yet.
pub(crate) fn still_well<D: Device>(device: &D, stage: Stage) -> Result<(), Interrupted> {
    match device.failure() {
        None => Ok(()),
        Some(reason) => Err(Interrupted::Failed(Fallback { stage, reason })),
    }
}
