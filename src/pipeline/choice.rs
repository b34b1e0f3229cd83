//! Which device is wanted, and which one is in use.

use serde::{Deserialize, Serialize};
use serde_json::json;

/// Which device is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceChoice {
    /// A GPU, where there is a real one that computes rightly; else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A GPU, also one in software, or an error.
    Webgpu,
}

/// Kinds of devices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// The processor.
    #[default]
    Cpu,
    /// A graphics processor: WebGPU in the browser; Vulkan, Metal or DirectX natively.
    Webgpu,
}

/// The device in use.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DeviceInfo {
    /// Its kind.
    pub kind: DeviceKind,
    /// Why this one, in a sentence.
    pub reason: String,
    /// Name of the graphics adapter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapter: Option<String>,
}

/// What a GPU was asked to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct GpuUse {
    /// Shaders run.
    pub dispatches: u64,
    /// Matrices and lists copied to it.
    pub uploads: u64,
    /// Matrices and lists copied back.
    pub downloads: u64,
}

/// Why the device that was insisted on is not there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// This build has the CPU only.
    #[error("this build has no WebGPU device: use 'auto' or 'cpu'")]
    NotInBuild,
    /// There is none, or none that computes rightly.
    #[error("WebGPU cannot be used: {0}")]
    Unavailable(String),
}

impl DeviceError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotInBuild => "device-not-in-build",
            Self::Unavailable(_) => "device-unavailable",
        }
    }

    /// The facts behind the sentence.
    pub fn details(&self) -> serde_json::Value {
        match self {
            Self::NotInBuild => json!({ "device": DeviceChoice::Webgpu }),
            Self::Unavailable(reason) => json!({ "device": DeviceChoice::Webgpu, "reason": reason }),
        }
    }
}
