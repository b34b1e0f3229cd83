//! Each element of the paper's configuration is there: without it one of these tests fails.
#![cfg(feature = "train")]

#[path = "paper/labelled.rs"]
mod labelled;
mod shapes;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize};

use geose_fmap::device::{Cpu, Device, Mask};
use geose_fmap::maps::FunctionalMap;
use geose_fmap::network::{Encoding, Model, ModelConfig, Network, Norm, Solver, Source, Start, WeightsError};
use geose_fmap::train::bodies::BodyModel;
use geose_fmap::train::bodies::parts::{PARTS, people};
use geose_fmap::train::device::matrix;
use geose_fmap::train::folds::cross_validate;
use geose_fmap::train::labelled::LabelledScans;
use geose_fmap::train::parameters::Parameters;
use geose_fmap::train::pool::{Maker, Pool};
use geose_fmap::train::run::{RunConfig, Schedule, train};
use geose_fmap::train::sample::Sample;
use geose_fmap::train::sample_config::{SampleConfig, Stand};
use geose_fmap::train::step::{embed, embed_together};
use geose_fmap::{LaplacianKind, MatchOptions, Matcher, Parts, PrepareOptions, Refinement, Shape, Weights};
use ndarray::{Array2, Axis, array, s};
use pollster::block_on;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shapes::{Random, body};

/// The paper's network, small.
fn network() -> ModelConfig {
    ModelConfig { width: 12, blocks: 2, features: 16, attention: 8, ..ModelConfig::paper() }
}

/// New parameters, as training starts with them; attention too has weights.
struct Fresh(Random, BTreeMap<String, Array2<f32>>);

impl Source<Array2<f32>> for Fresh {
    fn tensor(&mut self, name: &str, [rows, cols]: [usize; 2], start: Start) -> Result<Array2<f32>, WeightsError> {
        let spread = match start {
            Start::Normal(0.0) => 0.3,
            Start::Normal(spread) => spread,
            _ => 0.0,
        };
        let level = if let Start::Constant(value) = start { value } else { -3.0 };
        let level = if spread > 0.0 { 0.0 } else { level };
        let made = Array2::from_shape_simple_fn((rows, cols), || level + spread * self.0.sign() as f32);
        self.1.insert(name.to_owned(), made.clone());
        Ok(made)
    }
}

fn weights(config: &ModelConfig) -> Weights {
    let mut source = Fresh(Random(3), BTreeMap::new());
    Network::new(config, PARTS.len(), &mut source).expect("a network");
    Weights::new(config.clone(), people(), BTreeMap::new(), source.1)
}

/// Every twelfth point of a sample body, with its labels.
fn scan(name: &str) -> Shape {
    let whole = body(name);
    let labels = whole.labels().expect("samples have labels");
    let kept: Vec<usize> = (0..whole.points().len()).step_by(12).collect();
    let points = kept.iter().map(|&i| whole.points()[i]).collect();
    Shape::new(points, vec![], Some(kept.iter().map(|&i| labels[i]).collect())).expect("a cloud")
}

fn sample(shape: Shape, config: &ModelConfig) -> Sample {
    Sample::new(shape, None, None, &SampleConfig::of(config, 1500)).expect("a sample")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn training_normalises_channels_over_the_points_of_a_step_and_matching_by_what_training_saw() {
    let config = network();
    let samples = ["woman-standing.ply", "man-lunging.ply"].map(|name| sample(scan(name), &config));
    let weights = weights(&config);
    let mut parameters = Parameters::from_weights(&weights, ChaCha8Rng::seed_from_u64(1));
    let network = Network::new(&config, PARTS.len(), &mut parameters).expect("a network");
    let (embeddings, found) = embed_together(&network, &samples.each_ref());
    assert_eq!((embeddings.len(), found.len()), (2, config.blocks));

    // The first layer's statistics are those of the heat of its inputs on both bodies together.
    let [weight, bias, times] = ["input.weight", "input.bias", "block0.log_times"].map(|name| named(&weights, name));
    let heat = |sample: &Sample| {
        let x = Cpu.linear(&sample.inputs.channels, &weight, &bias);
        let coefficients = Cpu.diffuse(&Cpu.matmul_tn(&sample.inputs.projector, &x), &sample.inputs.lambda, &times);
        Cpu.matmul(&sample.inputs.phi, &coefficients)
    };
    let both = ndarray::concatenate![Axis(0), heat(&samples[0]), heat(&samples[1])];
    let [mean, variance] = [both.mean_axis(Axis(0)).expect("points"), both.var_axis(Axis(0), 0.0)];
    let near = |a: &Array2<f32>, b: &ndarray::Array1<f32>| {
        a.row(0).iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4 + 1e-3 * b.abs())
    };
    assert_eq!(found[0].layer, "block0.norm");
    assert!(near(&matrix(&found[0].mean), &mean) && near(&matrix(&found[0].variance), &variance));
    let normal = Cpu.batch_norm(
        &both,
        (&matrix(&found[0].mean), &matrix(&found[0].variance)),
        &Array2::ones((1, config.width)),
        &Array2::zeros((1, config.width)),
    );
    let still = |c: usize| variance[c] < 1e-3;
    for (c, column) in normal.columns().into_iter().enumerate().filter(|&(c, _)| !still(c)) {
        let (mean, variance) = (column.mean().expect("points"), column.var(0.0));
        assert!(mean.abs() < 1e-3 && (variance - 1.0).abs() < 0.02, "channel {c}: {mean}, {variance}");
    }

    // Until they are followed the weights say mean 0 and variance 1; after one step matching goes by what the step found.
    let apart = |by_weights: &Array2<f32>| {
        let by_points = matrix(&embeddings[0].features);
        (by_weights - &by_points).iter().fold(0.0f32, |most, d| most.max(d.abs()))
    };
    let before = matrix(&embed(&network, &samples[0]).features);
    parameters.follow(&found, 0).expect("followed");
    let after = matrix(&embed(&network, &samples[0]).features);
    assert!(apart(&before) > 0.05 && apart(&after) < 1e-3, "{} then {}", apart(&before), apart(&after));

    // They are in the file, and another device reads them there.
    let saved = parameters.weights(&config, &people(), false).to_bytes(false).expect("bytes");
    let model = Model::new(Weights::from_bytes(&saved).expect("weights")).expect("a network");
    assert!(near(&named(model.networks()[0].weights(), "block0.norm.mean"), &mean));
    let (matched, _) = block_on(model.networks()[0].embed(&Cpu, &samples[0].inputs));
    assert!(apart(&matched.features) < 1e-3);
}

fn named(weights: &Weights, name: &str) -> Array2<f32> {
    weights.tensors().find(|(known, _)| *known == name).expect("a tensor").1.to_owned()
}

#[test]
fn positions_join_after_the_network_and_before_attention() {
    let config = network();
    let turned = |shape: Shape| {
        let points = shape.points().iter().map(|&[x, y, z]| [z, y, -x]).collect();
        Shape::new(points, vec![], shape.labels().map(<[u32]>::to_vec)).expect("a cloud")
    };
    let scan = scan("woman-standing.ply");
    let (still, moved) = (sample(scan.clone(), &config), sample(turned(scan), &config));
    let weights = weights(&config);
    let network = Network::new(&config, PARTS.len(), &mut weights.on(&Cpu)).expect("a network");
    // On one basis: a turned cloud has the same up to signs.
    let mut moved_inputs = still.inputs.clone();
    moved_inputs.encoded = moved.inputs.encoded.clone();
    moved_inputs.points = moved.inputs.points.clone();
    moved_inputs.moments = moved.inputs.moments.clone();
    let channels = (&moved.inputs.channels - &still.inputs.channels).iter().fold(0.0f32, |most, d| most.max(d.abs()));
    assert!(channels < 1e-3, "the network sees no positions: {channels}");
    let [a, b] = [&still.inputs, &moved_inputs].map(|inputs| network.embed(&Cpu, &inputs.upload(&Cpu)));
    assert_eq!(a.features.ncols(), config.feature_columns());
    let own = s![.., ..config.features];
    assert_eq!(a.features.slice(own), b.features.slice(own), "F is the same");
    assert_eq!(a.logits, b.logits);
    let psi = s![.., config.features..];
    assert_eq!(Some(a.features.slice(psi).to_owned()), still.inputs.encoded, "ψ stands beside it");
    assert_ne!(a.features.slice(psi), b.features.slice(psi));
    // Attention sees them: what it adds to F differs too.
    let parts = Array2::ones((a.features.nrows(), 1));
    let keys = vec![0, 5, 9, 14];
    let seen = |e: &Array2<f32>| network.compare(&Cpu, [(e, &parts, &keys), (&a.features, &parts, &keys)])[0].clone();
    let (seen_a, seen_b) = (seen(&a.features), seen(&b.features));
    let turned_by = |m: &Array2<f32>| {
        m.slice(own).to_owned() / m.slice(own).map_axis(Axis(1), |r| r.dot(&r).sqrt()).insert_axis(Axis(1))
    };
    let apart = (turned_by(&seen_a) - turned_by(&seen_b)).iter().fold(0.0f32, |most, d| most.max(d.abs()));
    assert!(apart > 1e-3, "{apart}");

    // The default network is given them at once.
    let default = ModelConfig { moments: 3, width: 12, ..ModelConfig::shipped() };
    assert_eq!(
        (default.encoding, sample(self::scan("woman-standing.ply"), &default).inputs.encoded),
        (Encoding::Input, None)
    );
}

#[test]
fn attention_does_not_depend_on_other_parts_at_all() {
    let values = |rows: usize, cols: usize, seed: u64| {
        let mut random = Random(seed);
        Array2::from_shape_simple_fn((rows, cols), || 2.0 * random.sign() as f32)
    };
    let one_hot = |of: &[usize]| Array2::from_shape_fn((of.len(), 4), |(i, part)| f32::from(u8::from(of[i] == part)));
    let (query, key, value) = (values(4, 5, 1), values(6, 5, 2), values(6, 3, 3));
    let (of_query, of_key) = (one_hot(&[0, 1, 0, 3]), one_hot(&[0, 1, 2, 0, 1, 2]));
    let attend =
        |key: &Array2<f32>, value: &Array2<f32>, mask| Cpu.attend((&query, &of_query), (key, &of_key), value, mask);
    let (mut other_key, mut other_value) = (key.clone(), value.clone());
    for other in [1, 2, 4, 5] {
        other_key.row_mut(other).fill(30.0);
        other_value.row_mut(other).fill(-1e6);
    }
    let rows_of_part_0 = |m: Array2<f32>| m.select(Axis(0), &[0, 2]);
    let hard = attend(&key, &value, Mask::Hard);
    assert_eq!(rows_of_part_0(attend(&other_key, &other_value, Mask::Hard)), rows_of_part_0(hard.clone()));
    assert_ne!(
        rows_of_part_0(attend(&other_key, &other_value, Mask::Soft)),
        rows_of_part_0(attend(&key, &value, Mask::Soft))
    );
    // A convex combination of the keys of its part.
    let seen = hard[(0, 0)];
    assert!((value[(0, 0)].min(value[(3, 0)])..=value[(0, 0)].max(value[(3, 0)])).contains(&seen));
    // No key is of the last query's part.
    assert_eq!(hard.row(3), array![0.0, 0.0, 0.0]);

    // Such a point keeps its own features through every layer.
    let config = network();
    let network = Network::new(&config, PARTS.len(), &mut Fresh(Random(9), BTreeMap::new())).expect("a network");
    let (a, b) = (values(4, config.feature_columns(), 4), values(6, config.feature_columns(), 5));
    let [seen, _] = network.compare(&Cpu, [(&a, &of_query, &vec![0, 1, 2, 3]), (&b, &of_key, &vec![0, 1, 2, 3, 4, 5])]);
    let own = Cpu.normalize_rows(&a);
    assert_eq!(seen.row(3), own.row(3));
    assert_ne!(seen.row(0), own.row(0));
}

#[test]
fn attention_layers_build_on_each_other() {
    let of = |layers: usize| {
        let config = ModelConfig { attention_layers: layers, ..network() };
        let mut source = Fresh(Random(9), BTreeMap::new());
        let network = Network::new(&config, PARTS.len(), &mut source).expect("a network");
        let mut random = Random(11);
        let mut features = || Array2::from_shape_simple_fn((7, config.feature_columns()), || random.unit() as f32);
        let (a, b, parts) = (features(), features(), Array2::ones((7, 1)));
        let all: Vec<u32> = (0..7).collect();
        let layered =
            source.1.keys().filter(|name| name.ends_with("out.weight") && name.starts_with("attention")).count();
        (layered, network.compare(&Cpu, [(&a, &parts, &all), (&b, &parts, &all)]))
    };
    let ((one, after_one), (three, after_three)) = (of(1), of(3));
    assert_eq!((one, three), (1, 3));
    assert!((&after_one[0] - &after_three[0]).iter().any(|d| d.abs() > 1e-3));
}

#[test]
fn least_squares_find_the_map_that_descriptors_agree_on() {
    let (k, c) = (20, 60);
    let mut random = Random(21);
    let mut matrix = |rows, cols| Array2::from_shape_simple_fn((rows, cols), || random.sign());
    let (map, g_a) = (matrix(k, k), matrix(k, c));
    let g_b = map.dot(&g_a);
    let lambda: Vec<f64> = (0..k).map(|j| 12.6 * j as f64).collect();
    let error = |found: &Array2<f64>| (found - &map).iter().fold(0.0f64, |most, d| most.max(d.abs()));
    assert!(error(&FunctionalMap::least_squares(g_a.view(), g_b.view()).matrix) < 1e-6);
    let lambda = ndarray::ArrayView1::from(&lambda);
    assert!(
        error(&FunctionalMap::solve(g_a.view(), g_b.view(), lambda, lambda).matrix) > 0.1,
        "the penalty pulls away"
    );
}

/// The whole way in matching: 120 by 120, and with that solver.
#[test]
fn the_first_maps_are_of_120_eigenfunctions() {
    let config = network();
    let match_of = |config: &ModelConfig| {
        let matcher = Matcher::with_weights([weights(config)]).expect("a network");
        let options = PrepareOptions { points: 500, ..PrepareOptions::default() };
        let [a, b] = ["woman-standing.ply", "man-lunging.ply"]
            .map(|name| matcher.prepare(scan(name), &options).expect("prepared"));
        assert_eq!(a.embeddings[0].features.ncols(), config.feature_columns());
        let options = MatchOptions {
            parts: Parts::Given,
            refine: Refinement::None,
            network_only: true,
            ..MatchOptions::default()
        };
        matcher.match_shapes(&a, &b, &options).expect("matched").c_ab.matrix
    };
    let least_squares = match_of(&config);
    assert_eq!(least_squares.dim(), (120, 120));
    let masked = match_of(&ModelConfig { solve: Solver::Masked, ..config.clone() });
    assert!((&least_squares - &masked).iter().any(|d| d.abs() > 1e-2));
    assert_eq!(match_of(&ModelConfig { map: 60, ..config }).dim(), (60, 60));
}

/// D_A = Φᵀ M F (Sec. 3.3): of a network without attention, whose rows of F have unit length.
#[test]
fn features_are_projected_by_mass() {
    let matcher =
        Matcher::with_weights([weights(&ModelConfig { attention: 0, map: 8, ..network() })]).expect("a network");
    let options = PrepareOptions { points: 500, ..PrepareOptions::default() };
    let [a, b] =
        ["woman-standing.ply", "man-lunging.ply"].map(|name| matcher.prepare(scan(name), &options).expect("prepared"));
    let options = MatchOptions { refine: Refinement::None, network_only: true, ..MatchOptions::default() };
    let found = matcher.match_shapes(&a, &b, &options).expect("matched").c_ab.matrix;
    let [by_mass, by_count] = [true, false].map(|by_mass| {
        let [g_a, g_b] = [&a, &b].map(|shape| {
            let (phi, mass, mut features) = (
                shape.basis.eigenvectors.slice(s![.., ..8]),
                &shape.basis.mass,
                shape.embeddings[0].features.mapv(f64::from),
            );
            assert_eq!(phi.nrows(), features.nrows(), "every point is used");
            features.rows_mut().into_iter().for_each(|mut row| row /= row.dot(&row).sqrt());
            let even = mass.mapv(|m| if by_mass { m } else { mass.sum() / mass.len() as f64 });
            (&phi * &even.insert_axis(Axis(1))).t().dot(&features)
        });
        FunctionalMap::least_squares(g_a.view(), g_b.view()).matrix
    });
    // Areas differ, and with them the unit of the map.
    let unit = |map: &Array2<f64>| map / map.iter().map(|c| c * c).sum::<f64>().sqrt();
    let off = |map: &Array2<f64>| (unit(map) - unit(&found)).iter().map(|d| d * d).sum::<f64>().sqrt();
    assert!(off(&by_mass) < 0.02 && off(&by_count) > 0.1, "{} {}", off(&by_mass), off(&by_count));
}

#[test]
fn the_papers_configuration_has_all_its_elements() {
    let network = ModelConfig::paper();
    assert_eq!((network.norm, network.encoding, network.mask), (Norm::Batch, Encoding::Features, Mask::Hard));
    assert_eq!((network.solve, network.map, network.eigenpairs), (Solver::LeastSquares, 120, 120));
    assert_eq!((network.features, network.moments), (256, 0));
    assert!(network.attention_layers > 1);
    let (run, samples) = (RunConfig::paper(800), SampleConfig::paper(&network));
    assert_eq!((run.batch, run.rate, run.steps * 2 * run.batch), (8, 1e-3, 100 * 800));
    assert_eq!((run.schedule, run.warm_up, run.decay, run.maps_from), (Schedule::Halved, 0, 0.0, 0));
    assert!(
        run.first_bodies >= 800 && run.clip == f32::MAX && run.mirrored == 0.0,
        "every pair may be drawn from the start, and counts as it is"
    );
    assert_eq!((samples.points, samples.spread, samples.stand), (5000, 0.0, Stand::Alike));
    assert_eq!((samples.laplacian, samples.pieces, samples.stylised), (Some(LaplacianKind::GeodesicLiteral), 0.0, 0.0));
    // Sec. 3.4 and 4.1: of L_geo, L_orth and L_sem alone, as weighted there.
    let losses = run.losses;
    let others = [
        losses.parts,
        losses.bijectivity,
        losses.orthogonality,
        losses.coupling,
        losses.places,
        losses.near_weight,
        losses.extent,
    ];
    assert_eq!(others, [0.0; 7]);
    assert_eq!((losses.eigen, losses.semantic, losses.features_orthogonal), (1.0, 0.5, 50.0));
    assert_eq!((losses.temperature, losses.semantic_temperature), (0.1, 0.1));
}

/// A run that is stopped goes on with the same running statistics.
#[test]
fn a_run_with_batch_normalisation_goes_on_as_if_it_had_not_been_stopped() {
    let config = ModelConfig { width: 6, blocks: 1, features: 6, eigenpairs: 20, map: 20, ..network() };
    let samples = SampleConfig::of(&config, 500);
    let place = folder("resumed-batch");
    for (index, name) in ["woman-standing.ply", "man-lunging.ply"].into_iter().enumerate() {
        let made = Sample::new(scan(name), None, None, &samples).expect("a sample");
        made.save(&place.join(format!("{index:06}.sample"))).expect("saved");
        let again = Sample::load(&place.join(format!("{index:06}.sample"))).expect("loaded");
        assert_eq!(again.inputs.encoded.map(|encoded| encoded.dim()), made.inputs.encoded.map(|encoded| encoded.dim()));
    }
    let pool = Pool::open(&place, 2, &samples).expect("opened");
    let run = RunConfig { steps: 4, batch: 2, ..RunConfig::paper(2) };
    let (whole, pieces) = (folder("whole-batch"), folder("pieces-batch"));
    assert!(train(&config, &run, &pool, &whole, None, f64::INFINITY).expect("trained"));
    while !train(&config, &run, &pool, &pieces, None, 0.0).expect("trained") {}
    let read = |folder: &Path| {
        Weights::from_bytes(&fs::read(folder.join("weights.safetensors")).expect("written")).expect("weights")
    };
    assert!(read(&whole) == read(&pieces));
}

#[test]
#[ignore = "needs the body data: set GEOSE_BODY_DATA and pass --include-ignored"]
fn bodies_stand_alike_where_that_is_asked_for() {
    let data = std::env::var_os("GEOSE_BODY_DATA").expect("GEOSE_BODY_DATA names a folder");
    let model = BodyModel::load(Path::new(&data)).expect("body data");
    let template = model.template(5000).expect("body data");
    let config = SampleConfig { points: 600, ..SampleConfig::paper(&ModelConfig::paper()) };
    let maker = Maker::new(&model, &template, None, &config);
    let part = |name: &str| PARTS.iter().position(|part| *part == name).expect("a part") as u32;
    let mut found = Vec::new();
    for seed in 0..24 {
        let sample = maker.sample(seed).expect("a sample");
        // But for points too far from the body to count.
        let n = sample.labels.len();
        assert!((570..=600).contains(&n), "{n}");
        let middle = |name: &str| {
            let own: Vec<usize> = (0..n).filter(|&i| sample.labels[i] == part(name)).collect();
            sample.inputs.points.select(Axis(0), &own).mean_axis(Axis(0)).expect("every part is there")
        };
        // Someone who faces +z with the head up has the left at +x; mirrored it would be at −x. Arms and thighs together, so that no single raised limb decides.
        let sides = |side: &str| middle(&format!("{side} upper arm")) + middle(&format!("{side} thigh"));
        let (left, right) = (sides("left"), sides("right"));
        let up = (middle("head") + middle("torso")) * 2.0 - &left - &right;
        let across = left - right;
        println!("{seed}: across {across}, up {up}");
        found.push([across[0] / across.dot(&across).sqrt(), up[1] / up.dot(&up).sqrt()]);
    }
    // All of them, but for what a pose turns or bends.
    for axis in 0..2 {
        let mean = found.iter().map(|cosines| cosines[axis]).sum::<f32>() / found.len() as f32;
        assert!(found.iter().all(|cosines| cosines[axis] > 0.0) && mean > 0.8, "{found:?}");
    }
}
