//! The crate in a browser's worker: one module, because linking it takes as long as its tests. `cpu` is for any browser, `gpu` for one that has WebGPU.
#![cfg(target_arch = "wasm32")]

#[path = "wasm/cpu.rs"]
mod cpu;
#[cfg(feature = "gpu")]
#[path = "wasm/gpu.rs"]
mod gpu;
mod shapes;

wasm_bindgen_test::wasm_bindgen_test_configure!(run_in_dedicated_worker);
