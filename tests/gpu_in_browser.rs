//! The same kernels through WebGPU, in a browser's worker. Chromium has WebGPU without a graphics card when started with
//! `--enable-unsafe-webgpu --use-webgpu-adapter=swiftshader`.
#![cfg(all(feature = "gpu", target_arch = "wasm32"))]

use geose_fmap::{Device, Gpu, GpuOptions};
use ndarray::Array2;
use wasm_bindgen_test::{console_log, wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_dedicated_worker);

async fn gpu() -> Gpu {
    Gpu::new(GpuOptions { software: true }).await.expect("a browser with WebGPU")
}

#[wasm_bindgen_test]
async fn every_kernel_agrees_with_the_cpu() {
    let gpu = gpu().await;
    console_log!("{:?}", gpu.info());
    for (rows, scale) in [(1, 1.0), (64, 1.0), (257, 1.0), (65, 1e15), (65, 1e-15)] {
        let results = gpu.agreement(rows, scale).await;
        for result in &results {
            console_log!("{rows} rows, values up to {scale:e}: {:<30} {:.1e}", result.kernel, result.error);
        }
        let worse: Vec<_> = results.iter().filter(|result| !result.holds()).collect();
        assert!(worse.is_empty(), "{rows} rows, values up to {scale:e}: {worse:?}");
    }
    assert_eq!(gpu.failure(), None);
    assert!(gpu.counters().dispatches >= 5 * 26, "{:?}", gpu.counters());
    assert_eq!(gpu.self_test().await, Ok(()));
}

#[wasm_bindgen_test]
async fn a_software_device_is_known_and_refused_unless_asked_for() {
    let info = gpu().await.info().clone();
    assert!(info.software, "tests run on a browser's adapter in software: {info:?}");
    let refused = Gpu::new(GpuOptions::default()).await.err();
    assert!(refused.is_some_and(|reason| reason.contains("software")));
}

#[wasm_bindgen_test]
async fn a_device_that_is_lost_in_the_middle_says_so_and_gives_zeros() {
    for moment in 0..3 {
        let gpu = gpu().await;
        if moment == 0 {
            gpu.destroy();
        }
        let a = gpu.upload(Array2::ones((300, 300)).view());
        if moment == 1 {
            gpu.destroy();
        }
        let b = gpu.matmul(&a, &a);
        if moment == 2 {
            gpu.destroy();
        }
        assert_eq!(gpu.download(&gpu.tanh(&b)).await, Array2::<f32>::zeros((300, 300)), "lost at moment {moment}");
        let failure = gpu.failure().expect("a failure");
        assert!(failure.contains("lost"), "lost at moment {moment}: {failure}");
        assert_eq!(gpu.download(&gpu.relu(&b)).await, Array2::<f32>::zeros((300, 300)));
    }
}
