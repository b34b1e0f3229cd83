//! Finding a GPU and opening it.

use std::sync::Arc;

use super::failure::{Failure, sentence};

/// What kind of device will do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuOptions {
    /// Also one that computes on the processor: it gives the same results, more slowly than [`Cpu`](crate::device::Cpu).
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
    let no_gpu = |reason: String| format!("no GPU was found ({reason})");
    #[cfg(target_arch = "wasm32")]
    let info = in_browser().await.map_err(no_gpu)?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let request =
        wgpu::RequestAdapterOptions { power_preference: wgpu::PowerPreference::HighPerformance, ..Default::default() };
    let adapter = instance.request_adapter(&request).await.map_err(|error| no_gpu(error.to_string()))?;
    #[cfg(not(target_arch = "wasm32"))]
    let info = described(&adapter);
    if info.software && !options.software {
        return Err(format!("the only GPU is one in software ({}), slower than the CPU path", info.name));
    }
    let descriptor = wgpu::DeviceDescriptor { required_limits: wgpu::Limits::default(), ..Default::default() };
    let opened = adapter.request_device(&descriptor).await;
    let (device, queue) = opened.map_err(|error| format!("{} could not be opened ({error})", info.name))?;
    let failure = Failure::default();
    let (on_error, on_loss) = (failure.clone(), failure.clone());
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| on_error.set(sentence(&error))));
    device.set_device_lost_callback(move |reason, message| {
        let message = if message.is_empty() { String::new() } else { format!(": {message}") };
        on_loss.set_lost(format!("the GPU was lost ({reason:?}{message})"));
    });
    Ok(Opened { info, device, queue, failure })
}

#[cfg(not(target_arch = "wasm32"))]
fn described(adapter: &wgpu::Adapter) -> GpuInfo {
    let found = adapter.get_info();
    GpuInfo {
        name: found.name,
        backend: format!("{:?}", found.backend),
        software: found.device_type == wgpu::DeviceType::Cpu,
    }
}

/// The adapter as the browser tells of it: wgpu knows no vendor and no architecture, which is all that most browsers say, panics outside of windows
/// and workers, and traps where an adapter has no `info`.
#[cfg(target_arch = "wasm32")]
async fn in_browser() -> Result<GpuInfo, String> {
    use js_sys::{Function, Object, Promise, Reflect};
    use wasm_bindgen::{JsCast, JsValue};

    let get = |object: &JsValue, name: &str| {
        let found = Reflect::get(object, &name.into()).ok();
        found.filter(|value| !value.is_undefined() && !value.is_null())
    };
    let global = js_sys::global();
    let of_window = global.dyn_ref::<web_sys::Window>().map(|window| JsValue::from(window.navigator()));
    let of_worker = || Some(global.dyn_ref::<web_sys::WorkerGlobalScope>()?.navigator().into());
    // The rest of WebGPU is not in web-sys but behind a flag for what may still change.
    let gpu = of_window.or_else(of_worker).and_then(|navigator| get(&navigator, "gpu"));
    let missing = "the engine has no WebGPU, or the page is not served over HTTPS";
    let gpu = gpu.ok_or(missing)?;
    let options = Object::new();
    let asked = Reflect::set(&options, &"powerPreference".into(), &"high-performance".into())
        .and_then(|_| Reflect::get(&gpu, &"requestAdapter".into()))
        .and_then(|request| request.dyn_into::<Function>())
        .and_then(|request| request.call1(&gpu, &options))
        .and_then(|promise| promise.dyn_into::<Promise>());
    let adapter = wasm_bindgen_futures::JsFuture::from(asked.map_err(|_| missing)?).await.map_err(|_| missing)?;
    if adapter.is_null() {
        return Err("the browser gives none".to_owned());
    }
    let about = get(&adapter, "info").ok_or("the browser does not say what it is")?;
    let said = |name: &str| get(&about, name).and_then(|value| value.as_string()).unwrap_or_default();
    let software = [&about, &adapter].iter().find_map(|object| get(object, "isFallbackAdapter")?.as_bool());
    let name = match said("description") {
        description if description.is_empty() => format!("{} {}", said("vendor"), said("architecture")),
        description => description,
    };
    let name = if name.trim().is_empty() { "not named by the browser".to_owned() } else { name.trim().to_owned() };
    Ok(GpuInfo { name, backend: "WebGPU".to_owned(), software: software.unwrap_or(false) })
}
