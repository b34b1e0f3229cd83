//! The same kernels through WebGPU. Chromium has WebGPU without a graphics card when started with
//! `--enable-unsafe-webgpu --use-webgpu-adapter=swiftshader`.

use geose_fmap::device::{Device, Gpu, GpuOptions};
use geose_fmap::network::Model;
use geose_fmap::pipeline::{DeviceChoice, DeviceKind, Processor, match_shapes, match_with, prepare, prepare_with};
use geose_fmap::{MatchOptions, PrepareOptions, PreparedShape, Progress, Stage, read};
use ndarray::Array2;
use wasm_bindgen_test::{console_log, wasm_bindgen_test};

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

/// Both samples, with few points because a GPU in software is slow.
fn samples() -> [PreparedShape; 2] {
    SAMPLES.map(|bytes| {
        let scan = read(bytes, None, None).expect("a scan");
        prepare(scan, None, &few(), &mut Progress::silent()).expect("prepared")
    })
}

const SAMPLES: [&[u8]; 2] = [
    include_bytes!("../../www/public/samples/woman-standing.ply"),
    include_bytes!("../../www/public/samples/man-lunging.ply"),
];

fn few() -> PrepareOptions {
    PrepareOptions { points: 400, eigenpairs: 40, ..PrepareOptions::default() }
}

async fn model() -> Model<Gpu> {
    Model::on(Model::embedded().weights().cloned(), gpu().await).expect("the weights that ship")
}

#[wasm_bindgen_test]
async fn a_match_is_that_of_the_cpu_and_a_lost_device_is_replaced() {
    let [a, b] = samples();
    let options = MatchOptions::default();
    let expected = match_shapes(&a, &b, &options, &mut Progress::silent()).expect("matched");
    let same = |found: &[u32]| {
        let same = found.iter().zip(&expected.a_to_b.target).filter(|(f, e)| f == e).count();
        same as f64 / found.len() as f64
    };
    let auto = Processor::open(Model::embedded().clone(), DeviceChoice::Auto).await.expect("some device");
    assert_eq!(auto.info().kind, DeviceKind::Cpu);
    assert!(auto.info().reason.contains("software"), "{:?}", auto.info());
    let mut on_gpu = Processor::open(Model::embedded().clone(), DeviceChoice::Webgpu).await.expect("a GPU");
    for lost in [false, true] {
        if lost {
            let gpu = on_gpu.gpu().expect("a GPU");
            gpu.destroy();
            // A browser tells of it when it is next waited for.
            gpu.download(&gpu.upload(Array2::ones((1, 1)).view())).await;
        }
        let found = on_gpu.match_shapes(&a, &b, &options, &mut Progress::silent()).await.expect("matched");
        console_log!("{:?}: {:?}", on_gpu.info(), found.gpu);
        assert_eq!((found.device, &found.fallback), (DeviceKind::Webgpu, &None));
        assert!(found.gpu.dispatches > 100, "{:?}", found.gpu);
        assert!(same(&found.a_to_b.target) >= 0.995);
        assert_eq!(on_gpu.info().reason.contains("lost"), lost);
    }
}

#[wasm_bindgen_test]
async fn a_device_destroyed_in_any_stage_leaves_the_map_of_the_cpu() {
    let [a, b] = samples();
    let options = MatchOptions::default();
    let expected = match_shapes(&a, &b, &options, &mut Progress::silent()).expect("matched");
    for stage in [Stage::FunctionalMap, Stage::Refine, Stage::Correspondence] {
        let model = model().await;
        let mut progress = Progress::new(|now, _| {
            if now == stage {
                model.device().destroy();
            }
            true
        });
        let found = match_with(&model, &a, &b, &options, &mut progress).await.expect("matched");
        let fallback = found.fallback.expect("the CPU took over");
        console_log!("{fallback:?}");
        assert_eq!(fallback.stage, stage);
        assert_eq!((&found.a_to_b, &found.b_to_a), (&expected.a_to_b, &expected.b_to_a), "lost in {stage:?}");
    }
    let model = model().await;
    let mut progress = Progress::new(|now, _| {
        if now == Stage::Features {
            model.device().destroy();
        }
        true
    });
    let scan = read(SAMPLES[0], None, None).expect("a scan");
    let prepared = prepare_with(&model, scan, None, &few(), &mut progress).await.expect("prepared");
    assert_eq!(prepared.info.fallback.as_ref().expect("the CPU took over").stage, Stage::Features);
    assert_eq!(prepared.embeddings, a.embeddings);
}
