//! The device that dense work runs on: chosen once, told with its reason, and opened anew after it was lost.

use std::sync::Arc;

#[cfg(feature = "gpu")]
use super::GpuUse;
use super::{
    DeviceChoice, DeviceError, DeviceInfo, DeviceKind, Error, Match, MatchOptions, PrepareOptions, PreparedShape,
    match_with, prepare_with,
};
#[cfg(feature = "gpu")]
use crate::device::{Device, Fallback, Gpu, GpuOptions};
use crate::network::Model;
use crate::progress::Progress;
#[cfg(feature = "gpu")]
use crate::progress::Stage;
use crate::shape::Shape;

/// A network on the device of choice, with the CPU behind it.
#[derive(Debug)]
pub struct Processor {
    model: Arc<Model>,
    info: DeviceInfo,
    gpu: GpuState,
}

#[derive(Debug)]
enum GpuState {
    /// Not wanted, or none was there from the start.
    Unused,
    /// In use, with what was asked for.
    #[cfg(feature = "gpu")]
    Open(Box<Model<Gpu>>, GpuOptions),
    /// Asked for, and gone for the reason given; before every call there may be another.
    #[cfg(feature = "gpu")]
    Gone(String, GpuOptions),
}

/// Bytes of GPU memory that are kept between calls.
#[cfg(feature = "gpu")]
const KEPT: u64 = 64 << 20;

impl Processor {
    /// The CPU.
    pub fn cpu(model: Arc<Model>) -> Self {
        Self { model, info: on_cpu("asked for"), gpu: GpuState::Unused }
    }

    /// Which device runs, and why.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// [`prepare_with`] on the device.
    pub async fn prepare(
        &mut self,
        shape: Shape,
        name: Option<String>,
        options: &PrepareOptions,
        progress: &mut Progress<'_>,
    ) -> Result<PreparedShape, Error> {
        #[cfg(feature = "gpu")]
        self.renew().await;
        match &self.gpu {
            #[cfg(feature = "gpu")]
            GpuState::Open(on_gpu, _) => {
                let prepared = prepare_with(&**on_gpu, shape, name, options, progress).await;
                on_gpu.device().trim(KEPT);
                prepared
            }
            GpuState::Unused => prepare_with(&self.model, shape, name, options, progress).await,
            #[cfg(feature = "gpu")]
            GpuState::Gone(reason, _) => {
                let mut prepared = prepare_with(&self.model, shape, name, options, progress).await?;
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
        #[cfg(feature = "gpu")]
        self.renew().await;
        match &self.gpu {
            #[cfg(feature = "gpu")]
            GpuState::Open(on_gpu, _) => {
                let before = on_gpu.device().counters();
                let matched = match_with(&**on_gpu, a, b, options, progress).await;
                on_gpu.device().trim(KEPT);
                let done = on_gpu.device().counters() - before;
                let gpu = GpuUse { dispatches: done.dispatches, uploads: done.uploads, downloads: done.downloads };
                Ok(Match { device: DeviceKind::Webgpu, gpu, ..matched? })
            }
            GpuState::Unused => match_with(&self.model, a, b, options, progress).await,
            #[cfg(feature = "gpu")]
            GpuState::Gone(reason, _) => {
                let fallback = Fallback { stage: Stage::FunctionalMap, reason: reason.clone() };
                let matched = match_with(&self.model, a, b, options, progress).await?;
                Ok(Match { fallback: Some(fallback), ..matched })
            }
        }
    }

    /// What loses the GPU in use as a driver might, for tests.
    pub fn losing(&self) -> Option<Box<dyn Fn()>> {
        #[cfg(feature = "gpu")]
        return self.gpu().map(|gpu| Box::new(gpu.losing()) as Box<dyn Fn()>);
        #[cfg(not(feature = "gpu"))]
        None
    }

    /// Whether calls may wait for a GPU.
    pub fn waits(&self) -> bool {
        !matches!(self.gpu, GpuState::Unused)
    }
}

fn on_cpu(reason: impl Into<String>) -> DeviceInfo {
    DeviceInfo { kind: DeviceKind::Cpu, reason: reason.into(), adapter: None }
}

#[cfg(not(feature = "gpu"))]
impl Processor {
    /// The device of choice.
    pub async fn open(model: Arc<Model>, choice: DeviceChoice) -> Result<Self, DeviceError> {
        let cpu = Self::cpu(model);
        match choice {
            DeviceChoice::Cpu => Ok(cpu),
            DeviceChoice::Auto => Ok(Self { info: on_cpu("this build has no WebGPU device"), ..cpu }),
            DeviceChoice::Webgpu => Err(DeviceError::NotInBuild),
        }
    }

    /// The device of [`Processor::open`] once more.
    pub async fn reopen(model: Arc<Model>, _: DeviceChoice) -> Self {
        Self::cpu(model)
    }
}

#[cfg(feature = "gpu")]
impl Processor {
    /// The device of choice. A GPU is only taken when every kernel agrees with the CPU.
    pub async fn open(model: Arc<Model>, choice: DeviceChoice) -> Result<Self, DeviceError> {
        let Some(options) = options(choice) else { return Ok(Self::cpu(model)) };
        match (load(&model, options, true).await, choice) {
            (Ok(on_gpu), _) => {
                let reason = match (choice, on_gpu.device().info().software) {
                    (DeviceChoice::Auto, _) => "every kernel agrees with the CPU",
                    (_, true) => "asked for; it computes in software, more slowly than the CPU path",
                    (_, false) => "asked for",
                };
                Ok(Self { info: on_gpu_because(&on_gpu, reason), ..Self::with(model, on_gpu, options) })
            }
            (Err(reason), DeviceChoice::Webgpu) => Err(DeviceError::Unavailable(reason)),
            (Err(reason), _) => Ok(Self { info: on_cpu(reason), ..Self::cpu(model) }),
        }
    }

    /// The GPU that [`Processor::open`] gave before, without its test; while there is none the CPU does the work.
    pub async fn reopen(model: Arc<Model>, choice: DeviceChoice) -> Self {
        let Some(options) = options(choice) else { return Self::cpu(model) };
        match load(&model, options, false).await {
            Ok(on_gpu) => Self { info: on_gpu_because(&on_gpu, "opened anew"), ..Self::with(model, on_gpu, options) },
            Err(reason) => Self {
                info: on_cpu(reason.clone()),
                gpu: if choice == DeviceChoice::Auto { GpuState::Unused } else { GpuState::Gone(reason, options) },
                ..Self::cpu(model)
            },
        }
    }

    fn with(model: Arc<Model>, on_gpu: Model<Gpu>, options: GpuOptions) -> Self {
        Self { gpu: GpuState::Open(Box::new(on_gpu), options), ..Self::cpu(model) }
    }

    /// The GPU in use.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.gpu {
            GpuState::Open(on_gpu, _) => Some(on_gpu.device()),
            GpuState::Unused | GpuState::Gone(..) => None,
        }
    }

    /// A device that failed is not used again; another one may be there, now or later.
    async fn renew(&mut self) {
        let (lost, options) = match &self.gpu {
            GpuState::Open(on_gpu, options) => match on_gpu.device().failure() {
                Some(failure) => (failure, *options),
                None => return,
            },
            GpuState::Gone(reason, options) => (reason.clone(), *options),
            GpuState::Unused => return,
        };
        // Its memory first.
        self.gpu = GpuState::Unused;
        // What was tested once need not be tested again, and the caller waits.
        match load(&self.model, options, false).await {
            Ok(on_gpu) => {
                let info = on_gpu_because(&on_gpu, &format!("opened anew: {lost}"));
                *self = Self { info, ..Self::with(self.model.clone(), on_gpu, options) };
            }
            Err(reason) => {
                self.info = on_cpu(reason.clone());
                self.gpu = GpuState::Gone(reason, options);
            }
        }
    }
}

#[cfg(feature = "gpu")]
fn options(choice: DeviceChoice) -> Option<GpuOptions> {
    match choice {
        DeviceChoice::Cpu => None,
        DeviceChoice::Auto => Some(GpuOptions { software: false }),
        DeviceChoice::Webgpu => Some(GpuOptions { software: true }),
    }
}

/// Opens a GPU, tests it if it has not been, and takes the network there.
#[cfg(feature = "gpu")]
async fn load(model: &Model, options: GpuOptions, test: bool) -> Result<Model<Gpu>, String> {
    let gpu = Gpu::new(options).await?;
    if test {
        gpu.self_test().await?;
        gpu.trim(0);
    }
    Model::on(model.weights().cloned(), gpu).map_err(|error| error.to_string())
}

#[cfg(feature = "gpu")]
fn on_gpu_because(model: &Model<Gpu>, reason: &str) -> DeviceInfo {
    let adapter = model.device().info();
    let adapter = Some(format!("{}, {}", adapter.name, adapter.backend));
    DeviceInfo { kind: DeviceKind::Webgpu, reason: reason.to_owned(), adapter }
}
