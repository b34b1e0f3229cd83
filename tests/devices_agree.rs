//! The GPU computes what the CPU computes, says what it did, and says so when it cannot. Runs on any Vulkan, Metal or DirectX device, also in software.
#![cfg(all(feature = "gpu", not(target_arch = "wasm32")))]

use geose_fmap::Weights;
use geose_fmap::device::{Cpu, Device, Gpu, GpuCounters, GpuOptions, Mask};
use geose_fmap::network::{Model, ModelConfig, Network, ShapeInputs, Source, Start, WeightsError};
use ndarray::{Array2, array};
use pollster::block_on;

fn gpu() -> Gpu {
    block_on(Gpu::new(GpuOptions { software: true })).unwrap_or_else(|reason| {
        panic!(
            "{reason}. These tests need a GPU, which may be one in software: on Debian `apt-get install mesa-vulkan-drivers libvulkan1`, \
             or with libvulkan1 and Chromium installed VK_DRIVER_FILES=/usr/lib/chromium/vk_swiftshader_icd.json"
        )
    })
}

/// What a piece of work did.
fn counted<T>(gpu: &Gpu, work: impl FnOnce() -> T) -> (T, GpuCounters) {
    let before = gpu.counters();
    let result = work();
    (result, gpu.counters() - before)
}

fn wavy(rows: usize, cols: usize, phase: f32) -> Array2<f32> {
    Array2::from_shape_fn((rows, cols), |(i, j)| (phase + 1.3 * i as f32 + 0.7 * (i % 13 * j) as f32).sin())
}

/// All kernels on matrices of so many rows, with values up to `scale`.
fn agrees(gpu: &Gpu, rows: usize, scale: f32) {
    let (results, counters) = counted(gpu, || block_on(gpu.agreement(rows, scale)));
    assert_eq!(gpu.failure(), None);
    assert!(counters.dispatches >= 28, "{rows} rows: only {} dispatches ran", counters.dispatches);
    assert_eq!(results.len(), 25, "kernels compared");
    for result in &results {
        println!("{rows:>5} rows, values up to {scale:e}: {:<30} {:.1e}", result.kernel, result.error);
    }
    let worse: Vec<_> = results.iter().filter(|result| !result.holds()).collect();
    assert!(worse.is_empty(), "{rows} rows, values up to {scale:e}: {worse:?}");
}

#[test]
fn every_kernel_agrees_with_the_cpu_at_every_size() {
    let gpu = gpu();
    println!("{:?}", gpu.info());
    for rows in [1, 2, 63, 64, 65, 257, 1999] {
        agrees(&gpu, rows, 1.0);
    }
}

#[test]
fn huge_and_tiny_values_agree_too() {
    let gpu = gpu();
    for scale in [1e-15, 1e-6, 1e6, 1e15] {
        agrees(&gpu, 65, scale);
    }
}

#[test]
fn the_self_test_passes() {
    assert_eq!(block_on(gpu().self_test()), Ok(()));
}

#[test]
fn a_software_device_is_refused_unless_asked_for() {
    let gpu = gpu();
    if gpu.info().software {
        let refused = block_on(Gpu::new(GpuOptions::default())).err();
        assert!(refused.is_some_and(|reason| reason.contains("software")));
    }
}

#[test]
fn matrices_without_rows_or_columns_give_such_matrices() {
    let gpu = gpu();
    let up = |rows, cols| gpu.upload(Array2::zeros((rows, cols)).view());
    let down = |tensor| block_on(gpu.download(&tensor));
    assert_eq!(down(gpu.matmul(&up(0, 3), &up(3, 4))).dim(), (0, 4));
    assert_eq!(down(gpu.matmul_tn(&up(0, 3), &up(0, 4))), Array2::<f32>::zeros((3, 4)));
    assert_eq!(down(gpu.layer_norm(&up(0, 3), &up(1, 3), &up(1, 3))).dim(), (0, 3));
    assert_eq!(down(gpu.softmax_rows(&up(3, 0))).dim(), (3, 0));
    assert_eq!(down(gpu.cross_pairs(&up(1, 3))).dim(), (0, 3));
    assert_eq!(down(gpu.leading_columns(&up(5, 3), 0)).dim(), (5, 0));
    assert_eq!(down(gpu.solve_rows(&up(3, 3), &up(0, 3), &up(0, 3))).dim(), (0, 3));
    for mask in [Mask::Soft, Mask::Hard] {
        let seen = gpu.attend((&up(2, 3), &up(2, 1)), (&up(0, 3), &up(0, 1)), &up(0, 4), mask);
        assert_eq!(down(seen), Array2::<f32>::zeros((2, 4)));
    }
    let (to_y, to_x) = gpu.nearest_rows(&up(0, 3), &up(2, 3), None);
    assert!(block_on(gpu.download_indices(&to_y)).is_empty());
    assert_eq!(block_on(gpu.download_indices(&to_x)), [0, 0]);
    assert_eq!(gpu.failure(), None);
}

#[test]
fn a_hard_mask_shows_nothing_of_other_parts() {
    let gpu = gpu();
    let one_hot = |rows: usize, of: fn(usize) -> usize| {
        Array2::from_shape_fn((rows, 3), |(i, part)| f32::from(u8::from(of(i) == part)))
    };
    let (query, key) = (wavy(70, 5, 0.0), wavy(90, 5, 0.5));
    // No key is of part 2, and every second is of part 1.
    let (of_query, of_key) = (one_hot(70, |i| i % 3), one_hot(90, |i| i % 2));
    let attend = |value: &Array2<f32>| {
        let up = |matrix: &Array2<f32>| gpu.upload(matrix.view());
        let seen = gpu.attend((&up(&query), &up(&of_query)), (&up(&key), &up(&of_key)), &up(value), Mask::Hard);
        let found = block_on(gpu.download(&seen));
        let expected = Cpu.attend((&query, &of_query), (&key, &of_key), value, Mask::Hard);
        assert!((&found - &expected).iter().all(|d| d.abs() < 1e-5 * value.iter().fold(0.0, |m, v| v.abs().max(m))));
        found
    };
    let value = wavy(90, 4, 0.9);
    let mut poisoned = value.clone();
    (1..90).step_by(2).for_each(|i| poisoned.row_mut(i).fill(1e30));
    let (seen, still) = (attend(&value), attend(&poisoned));
    for i in 0..70 {
        match i % 3 {
            0 => assert_eq!(seen.row(i), still.row(i), "row {i} sees part 0 alone"),
            1 => assert_ne!(seen.row(i), still.row(i), "row {i} sees part 1"),
            _ => assert_eq!(seen.row(i), Array2::<f32>::zeros((1, 4)).row(0), "row {i} sees nothing"),
        }
    }
}

#[test]
fn of_equal_neighbours_the_first_is_found() {
    let gpu = gpu();
    let same = Array2::from_elem((200, 5), 0.3);
    let on_gpu = gpu.upload(same.view());
    for parts in [None, Some((vec![4; 200], vec![4; 200]))] {
        let parts = parts.as_ref().map(|(x, y): &(Vec<u32>, Vec<u32>)| (x.as_slice(), y.as_slice()));
        let (to_y, to_x) = gpu.nearest_rows(&on_gpu, &on_gpu, parts);
        assert_eq!(block_on(gpu.download_indices(&to_y)), [0; 200]);
        assert_eq!(block_on(gpu.download_indices(&to_x)), [0; 200]);
    }
}

#[test]
fn rows_find_their_own_part_and_those_without_one_any() {
    let gpu = gpu();
    // On a line: part 1 is far away from where the others are.
    let (x, y) = (array![[0.0_f32], [1.0], [2.0]], array![[0.1_f32], [10.0], [2.1], [1.1]]);
    let (of_x, of_y) = ([7, 1, 8], [7, 1, 9, 9]);
    let parts = Some((&of_x[..], &of_y[..]));
    let (to_y, to_x) = gpu.nearest_rows(&gpu.upload(x.view()), &gpu.upload(y.view()), parts);
    let found = (block_on(gpu.download_indices(&to_y)), block_on(gpu.download_indices(&to_x)));
    assert_eq!(found, (vec![0, 1, 2], vec![0, 1, 2, 1]));
    assert_eq!(found, Cpu.nearest_rows(&x, &y, parts));
}

#[test]
fn work_beyond_one_dispatch_is_split_and_still_right() {
    let gpu = gpu();
    // The last match of two bodies: both spectra, features, parts, places and normals.
    let (n, d) = (5000, 2 * 120 + 128 + 14 + 12);
    let (x, y) = (wavy(n, d, 0.0), wavy(n, d, 0.5));
    let (on_x, on_y) = (gpu.upload(x.view()), gpu.upload(y.view()));
    let (found, counters) = counted(&gpu, || {
        let (to_y, to_x) = gpu.nearest_rows(&on_x, &on_y, None);
        (block_on(gpu.download_indices(&to_y)), block_on(gpu.download_indices(&to_x)))
    });
    println!("nearest_rows {counters:?}");
    // 20 GFlop at 2 GFlop per dispatch, two merges after each, and two matrices' lengths before.
    assert_eq!(counters.dispatches, 2 + 3 * 10);
    assert_eq!((counters.uploads, counters.downloads, counters.bytes_down), (0, 2, 8 * n as u64));
    let expected = Cpu.nearest_rows(&x, &y, None);
    let same = |a: &[u32], b: &[u32]| a.iter().zip(b).filter(|(a, b)| a == b).count();
    assert!(same(&found.0, &expected.0) > 4990 && same(&found.1, &expected.1) > 4990);
    // Within parts there is a tenth to compare, and labels go up.
    let parts: Vec<u32> = (0..n as u32).map(|i| i / 37 % 14).collect();
    let (_, counters) = counted(&gpu, || gpu.nearest_rows(&on_x, &on_y, Some((&parts, &parts))));
    println!("nearest_rows within parts {counters:?}");
    assert_eq!((counters.uploads, counters.dispatches), (2, 2 + 3));
}

/// Points with as many channels and eigenfunctions as the network that ships asks for.
fn inputs(points: usize) -> ShapeInputs {
    let config = &Model::embedded().networks()[0].weights().config;
    let k = config.eigenpairs;
    let phi = Array2::from_shape_fn((points, k), |(i, j)| (0.37 * (i * (j + 1)) as f32 / points as f32).cos());
    let places = wavy(points, 3, 0.1) * 0.5;
    ShapeInputs {
        channels: wavy(points, 16, 0.2),
        moments: &places / points as f32,
        points: places,
        projector: &phi / points as f32,
        gradients: [wavy(points, k, 0.3), wavy(points, k, 0.4)],
        lambda: Array2::from_shape_fn((k, 1), |(j, _)| 12.6 * j as f32),
        phi,
        encoded: None,
        extent: 1.0,
    }
}

/// The weights that ship, and attention, which they have none of.
struct WithAttention<'a, D>(&'a Weights, &'a D);

impl<D: Device> Source<D::Tensor> for WithAttention<'_, D> {
    fn tensor(&mut self, name: &str, shape: [usize; 2], start: Start) -> Result<D::Tensor, WeightsError> {
        let made = || self.1.upload(wavy(shape[0], shape[1], 0.2).view());
        self.0.on(self.1).tensor(name, shape, start).or_else(|_| Ok(made()))
    }
}

#[test]
fn the_network_says_the_same_and_nothing_comes_back_in_between() {
    let gpu = gpu();
    let weights = Model::embedded().networks()[0].weights();
    let config = ModelConfig { attention: 64, ..weights.config.clone() };
    let points = 2000;
    let inputs = inputs(points);
    let parts = Array2::from_elem((points, 14), 1.0 / 14.0);
    let keys: Vec<u32> = (0..1024).collect();

    let on_cpu = Network::new(&config, 14, &mut WithAttention(weights, &Cpu)).expect("the weights that ship");
    let embedding = on_cpu.embed(&Cpu, &inputs.upload(&Cpu));
    let (features, logits, extent) = (embedding.features, embedding.logits, embedding.extent.expect("a head"));
    let [compared, _] = on_cpu.compare(&Cpu, [(&features, &parts, &keys); 2]);

    let (network, of_weights) =
        counted(&gpu, || Network::new(&config, 14, &mut WithAttention(weights, &gpu)).expect("the weights that ship"));
    let (on_gpu, of_inputs) = counted(&gpu, || inputs.upload(&gpu));
    let (embedding, of_embedding) = counted(&gpu, || network.embed(&gpu, &on_gpu));
    let on_parts = gpu.upload(parts.view());
    let on_keys = gpu.upload_indices(&keys);
    let ([seen, _], of_comparison) =
        counted(&gpu, || network.compare(&gpu, [(&embedding.features, &on_parts, &on_keys); 2]));
    println!("weights {of_weights:?}\ninputs {of_inputs:?}\nembed {of_embedding:?}\ncompare {of_comparison:?}");
    // What the mean over points weighs them with.
    assert_eq!((of_embedding.uploads, of_embedding.downloads), (1, 0));
    // One layer in, four blocks, a norm and two layers out; how much of a body there is.
    assert_eq!(of_embedding.dispatches, 1 + 4 * 29 + 3 + 8);
    // Of each shape the keys' features and parts, and nine more.
    assert_eq!((of_comparison.uploads, of_comparison.downloads, of_comparison.dispatches), (0, 0, 2 * (2 + 9)));

    for (name, found, expected) in [
        ("features", &embedding.features, &features),
        ("logits", &embedding.logits, &logits),
        ("extent", embedding.extent.as_ref().expect("a head"), &extent),
        ("compared", &seen, &compared),
    ] {
        let found = block_on(gpu.download(found));
        let largest = expected.iter().fold(0.0_f32, |most, v| most.max(v.abs()));
        let error = found.iter().zip(expected).fold(0.0_f32, |most, (a, b)| most.max((a - b).abs())) / largest;
        println!("{name}: {error:.1e} of {largest}");
        assert!(error < 1e-4, "{name} is {error:e} off");
    }
    assert_eq!(gpu.failure(), None);
}

#[test]
fn maps_of_a_whole_basis_are_solved_for() {
    let gpu = gpu();
    let k = 120;
    // Descriptors that fade towards high frequencies, as smooth ones do, and a mask that grows away from the diagonal.
    let descriptors = Array2::from_shape_fn((k, 128), |(i, j)| {
        ((1.7 * (i * 128 + j) as f32).sin() * 43758.547).fract() / (1.0 + i as f32 / 20.0)
    });
    let gram = Cpu.matmul_nt(&descriptors, &descriptors);
    let right = Cpu.matmul_nt(&descriptors, &descriptors.slice(ndarray::s![..;-1, ..]).to_owned());
    let mask = Array2::from_shape_fn((k, k), |(i, j)| ((i as f32 - j as f32) / k as f32).powi(2));
    let expected = Cpu.solve_rows(&gram, &right, &mask);
    let up = |matrix: &Array2<f32>| gpu.upload(matrix.view());
    let found = block_on(gpu.download(&gpu.solve_rows(&up(&gram), &up(&right), &up(&mask))));
    let error = (&found - &expected).iter().fold(0.0_f32, |most, d| most.max(d.abs()))
        / expected.iter().fold(0.0_f32, |most, v| most.max(v.abs()));
    println!("{error:.1e}");
    assert!(error < 1e-3, "{error:e}");
    // What is not positive definite has no solution here, as on the CPU.
    let broken = Array2::from_elem((2, 2), f32::NAN);
    let ones = Array2::ones((1, 2));
    for found in [
        block_on(gpu.download(&gpu.solve_rows(&up(&broken), &up(&ones), &up(&ones)))),
        Cpu.solve_rows(&broken, &ones, &ones),
    ] {
        assert!(found.iter().all(|v| v.is_nan()), "{found}");
    }
}

#[test]
fn a_matrix_too_large_to_bind_is_a_failure_and_not_a_panic() {
    let gpu = gpu();
    let long = gpu.upload(Array2::zeros((40_000, 1)).view());
    let (product, counters) = counted(&gpu, || gpu.matmul_nt(&long, &long));
    assert_eq!(product.dim(), (40_000, 40_000));
    assert_eq!(counters.dispatches, 0);
    let failure = gpu.failure().expect("a failure");
    assert!(failure.contains("MiB"), "{failure}");
    assert_eq!(block_on(gpu.download(&long)), Array2::<f32>::zeros((40_000, 1)));
}

#[test]
fn work_that_the_device_refuses_is_a_failure_by_the_next_download() {
    let (gpu, other) = (gpu(), gpu());
    let foreign = other.upload(wavy(30, 30, 0.0).view());
    assert_eq!(block_on(gpu.download(&gpu.relu(&foreign))), Array2::<f32>::zeros((30, 30)));
    let failure = gpu.failure().expect("a failure");
    assert!(failure.contains("refused"), "{failure}");
    assert_eq!(other.failure(), None);
}

#[test]
fn a_device_that_is_lost_in_the_middle_says_so_and_gives_zeros() {
    for moment in 0..3 {
        let gpu = gpu();
        if moment == 0 {
            gpu.destroy();
        }
        let a = gpu.upload(wavy(300, 300, 0.0).view());
        if moment == 1 {
            gpu.destroy();
        }
        let b = gpu.relu(&gpu.matmul(&a, &a));
        if moment == 2 {
            gpu.destroy();
        }
        let c = gpu.tanh(&b);
        assert_eq!(block_on(gpu.download(&c)), Array2::<f32>::zeros((300, 300)), "lost at moment {moment}");
        let failure = gpu.failure().expect("a failure");
        assert!(failure.contains("lost"), "{failure}");
        // Work goes on, and does nothing.
        let (indices, counters) = counted(&gpu, || gpu.nearest_rows(&a, &gpu.matmul(&a, &c), None));
        assert_eq!(block_on(gpu.download_indices(&indices.0)), [0; 300]);
        assert_eq!(counters, GpuCounters::default());
        assert_eq!(gpu.failure(), Some(failure));
        assert!(block_on(gpu.self_test()).is_err());
    }
}

#[test]
fn the_same_work_twenty_times_takes_the_memory_of_the_second() {
    let gpu = gpu();
    let (x, y) = (wavy(700, 50, 0.0), wavy(650, 50, 0.5));
    let labels = |rows: u32| (0..rows).map(|i| i % 5).collect::<Vec<u32>>();
    let (of_x, of_y) = (labels(700), labels(650));
    let mut second = None;
    for round in 1..=20 {
        let (on_x, on_y) = (gpu.upload(x.view()), gpu.upload(y.view()));
        let normal = gpu.normalize_rows(&gpu.relu(&on_x));
        let (to_y, _) = gpu.nearest_rows(&normal, &on_y, Some((&of_x, &of_y)));
        let moved = gpu.add(&normal, &gpu.gather(&on_y, &to_y), 0.5);
        block_on(gpu.download(&gpu.matmul_tn(&moved, &on_x)));
        drop((on_x, on_y, normal, to_y, moved));
        let size = gpu.pool_size();
        assert_eq!(size.idle_bytes, size.bytes, "everything came back");
        if round == 2 {
            second = Some(size);
        }
        if round > 2 {
            assert_eq!(Some(size), second, "round {round}");
        }
    }
    assert_eq!(gpu.failure(), None);
}
