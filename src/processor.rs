//! The device that dense work runs on: chosen once, told with its reason, and opened anew after it was lost.

use serde::{Deserialize, Serialize};
use serde_json::json;

#[cfg(feature = "gpu")]
use crate::device::{Device, Fallback, Gpu, GpuOptions};
use crate::error::Error;
use crate::model::Model;
use crate::options::{MatchOptions, PrepareOptions};
use crate::pipeline::{Match, match_with, prepare_with};
use crate::prepared::PreparedShape;
use crate::progress::Progress;
#[cfg(feature = "gpu")]
use crate::progress::Stage;
use crate::shape::Shape;

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

/// A network on the device of choice, with the CPU behind it.
#[derive(Debug)]
pub struct Processor {
    model: &'static Model,
    info: DeviceInfo,
    #[cfg(feature = "gpu")]
    gpu: GpuState,
}

#[cfg(feature = "gpu")]
#[derive(Debug)]
enum GpuState {
    /// Not wanted, or not there.
    Unused,
    /// In use; whether one in software would do as well.
    Open(Box<Model<Gpu>>, GpuOptions),
    /// It failed, and there was no other.
    Gone(String),
}

impl Processor {
    /// The CPU.
    pub fn cpu(model: &'static Model) -> Self {
        Self {
            model,
            info: on_cpu("asked for"),
            #[cfg(feature = "gpu")]
            gpu: GpuState::Unused,
        }
    }

    /// Which device runs, and why.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }
}

fn on_cpu(reason: impl Into<String>) -> DeviceInfo {
    DeviceInfo { kind: DeviceKind::Cpu, reason: reason.into(), adapter: None }
}

#[cfg(not(feature = "gpu"))]
impl Processor {
    /// The device of choice.
    pub async fn open(model: &'static Model, choice: DeviceChoice) -> Result<Self, DeviceError> {
        let cpu = Self::cpu(model);
        match choice {
            DeviceChoice::Cpu => Ok(cpu),
            DeviceChoice::Auto => Ok(Self { info: on_cpu("this build has no WebGPU device"), ..cpu }),
            DeviceChoice::Webgpu => Err(DeviceError::NotInBuild),
        }
    }

    /// [`prepare_with`] on the device.
    pub async fn prepare(
        &mut self,
        shape: Shape,
        name: Option<String>,
        options: &PrepareOptions,
        progress: &mut Progress<'_>,
    ) -> Result<PreparedShape, Error> {
        prepare_with(self.model, shape, name, options, progress).await
    }

    /// [`match_with`] on the device.
    pub async fn match_shapes(
        &mut self,
        a: &PreparedShape,
        b: &PreparedShape,
        options: &MatchOptions,
        progress: &mut Progress<'_>,
    ) -> Result<Match, Error> {
        match_with(self.model, a, b, options, progress).await
    }
}

#[cfg(feature = "gpu")]
impl Processor {
    /// The device of choice. A GPU is only taken when every kernel agrees with the CPU.
    pub async fn open(model: &'static Model, choice: DeviceChoice) -> Result<Self, DeviceError> {
        let options = match choice {
            DeviceChoice::Cpu => return Ok(Self::cpu(model)),
            DeviceChoice::Auto => GpuOptions { software: false },
            DeviceChoice::Webgpu => GpuOptions { software: true },
        };
        match (load(model, options).await, choice) {
            (Ok(on_gpu), _) => {
                let reason = match (choice, on_gpu.device().info().software) {
                    (DeviceChoice::Auto, _) => "every kernel agrees with the CPU",
                    (_, true) => "asked for; it computes in software, more slowly than the CPU path",
                    (_, false) => "asked for",
                };
                let info = on_gpu_because(&on_gpu, reason);
                Ok(Self { model, info, gpu: GpuState::Open(Box::new(on_gpu), options) })
            }
            (Err(reason), DeviceChoice::Webgpu) => Err(DeviceError::Unavailable(reason)),
            (Err(reason), _) => Ok(Self { info: on_cpu(reason), ..Self::cpu(model) }),
        }
    }

    /// [`prepare_with`] on the device.
    pub async fn prepare(
        &mut self,
        shape: Shape,
        name: Option<String>,
        options: &PrepareOptions,
        progress: &mut Progress<'_>,
    ) -> Result<PreparedShape, Error> {
        self.replace_if_lost().await;
        match &self.gpu {
            GpuState::Open(on_gpu, _) => prepare_with(on_gpu, shape, name, options, progress).await,
            GpuState::Unused => prepare_with(self.model, shape, name, options, progress).await,
            GpuState::Gone(reason) => {
                let mut prepared = prepare_with(self.model, shape, name, options, progress).await?;
                prepared.info.fallback = Some(Fallback { stage: Stage::Features, reason: reason.clone() });
                Ok(prepared)
            }
        }
    }

    /// [`match_with`] on the device.
    pub async fn match_shapes(
        &mut self,
        a: &PreparedShape,
        b: &PreparedShape,
        options: &MatchOptions,
        progress: &mut Progress<'_>,
    ) -> Result<Match, Error> {
        self.replace_if_lost().await;
        match &self.gpu {
            GpuState::Open(on_gpu, _) => {
                let before = on_gpu.device().counters();
                let mut matched = match_with(&**on_gpu, a, b, options, progress).await?;
                let done = on_gpu.device().counters() - before;
                matched.device = DeviceKind::Webgpu;
                matched.gpu = GpuUse { dispatches: done.dispatches, uploads: done.uploads, downloads: done.downloads };
                Ok(matched)
            }
            GpuState::Unused => match_with(self.model, a, b, options, progress).await,
            GpuState::Gone(reason) => {
                let mut matched = match_with(self.model, a, b, options, progress).await?;
                matched.fallback = Some(Fallback { stage: Stage::FunctionalMap, reason: reason.clone() });
                Ok(matched)
            }
        }
    }

    /// The GPU in use.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.gpu {
            GpuState::Open(on_gpu, _) => Some(on_gpu.device()),
            GpuState::Unused | GpuState::Gone(_) => None,
        }
    }

    /// A device that failed is not used again; another one may be there.
    async fn replace_if_lost(&mut self) {
        let GpuState::Open(on_gpu, options) = &self.gpu else { return };
        let Some(lost) = on_gpu.device().failure() else { return };
        let options = *options;
        // Its memory first.
        self.gpu = GpuState::Unused;
        match load(self.model, options).await {
            Ok(on_gpu) => {
                self.info = on_gpu_because(&on_gpu, "opened anew after the one before was lost");
                self.gpu = GpuState::Open(Box::new(on_gpu), options);
            }
            Err(reason) => {
                let reason = format!("{lost}, and no other could be opened: {reason}");
                self.info = on_cpu(reason.clone());
                self.gpu = GpuState::Gone(reason);
            }
        }
    }
}

/// Opens and tests a GPU, and takes the network there.
#[cfg(feature = "gpu")]
async fn load(model: &Model, options: GpuOptions) -> Result<Model<Gpu>, String> {
    let gpu = Gpu::new(options).await?;
    gpu.self_test().await?;
    Model::on(model.weights().clone(), gpu).map_err(|error| error.to_string())
}

#[cfg(feature = "gpu")]
fn on_gpu_because(model: &Model<Gpu>, reason: &str) -> DeviceInfo {
    let adapter = model.device().info();
    let name = [&adapter.name, &adapter.backend].into_iter().find(|name| !name.is_empty());
    DeviceInfo { kind: DeviceKind::Webgpu, reason: reason.to_owned(), adapter: name.cloned() }
}
