//! Finding a GPU and opening it.

use std::sync::Arc;

use super::failure::Failure;

/// What kind of device will do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuOptions {
    /// Also one that computes on the processor: it gives the same results, more slowly than [`crate::Cpu`].
    pub software: bool,
}

/// Which device was opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GpuInfo {
    /// As its driver names it; browsers may say nothing.
    pub name: String,
    /// WebGPU, Vulkan, Metal or DirectX.
    pub backend: String,
    /// Whether it computes on the processor: natively `device_type` says so, in browsers `isFallbackAdapter`.
    pub software: bool,
}

/// An open device whose errors end in its `failure`.
pub(super) struct Opened {
    pub info: GpuInfo,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub failure: Failure,
}

/// Opens the fastest device there is, within the limits that every WebGPU device has.
pub(super) async fn open(options: GpuOptions) -> Result<Opened, String> {
    #[cfg(target_arch = "wasm32")]
    if !has_webgpu() {
        return Err("there is no WebGPU here: the engine has none, or the page is not served over HTTPS".to_owned());
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let request =
        wgpu::RequestAdapterOptions { power_preference: wgpu::PowerPreference::HighPerformance, ..Default::default() };
    let adapter = instance.request_adapter(&request).await.map_err(|error| format!("no GPU was found ({error})"))?;
    let found = adapter.get_info();
    let info = GpuInfo {
        name: found.name,
        backend: match found.backend {
            wgpu::Backend::BrowserWebGpu => "WebGPU".to_owned(),
            other => format!("{other:?}"),
        },
        software: found.device_type == wgpu::DeviceType::Cpu,
    };
    if info.software && !options.software {
        return Err(format!("the only GPU is one in software ({}), slower than the CPU path", info.name));
    }
    let descriptor = wgpu::DeviceDescriptor { required_limits: wgpu::Limits::default(), ..Default::default() };
    let opened = adapter.request_device(&descriptor).await;
    let (device, queue) = opened.map_err(|error| format!("{} could not be opened ({error})", info.name))?;
    let failure = Failure::default();
    let (on_error, on_loss) = (failure.clone(), failure.clone());
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        on_error.set(match error {
            wgpu::Error::OutOfMemory { .. } => "the GPU is out of memory".to_owned(),
            other => format!("the GPU refused its work: {other}"),
        });
    }));
    device.set_device_lost_callback(move |reason, message| {
        let message = if message.is_empty() { String::new() } else { format!(": {message}") };
        on_loss.set_lost(format!("the GPU was lost ({reason:?}{message})"));
    });
    Ok(Opened { info, device, queue, failure })
}

/// Whether the engine has WebGPU at all. wgpu panics outside of windows and workers.
#[cfg(target_arch = "wasm32")]
fn has_webgpu() -> bool {
    let get =
        |object: &js_sys::Object, name: &str| js_sys::Reflect::get(object, &name.into()).map(js_sys::Object::from);
    let of_browser = ["Window", "WorkerGlobalScope"]
        .iter()
        .any(|kind| get(&js_sys::global(), kind).is_ok_and(|kind| !kind.is_undefined()));
    of_browser
        && get(&js_sys::global(), "navigator")
            .and_then(|navigator| get(&navigator, "gpu"))
            .is_ok_and(|gpu| !gpu.is_undefined())
}
