//! Training: what its loader gives away, that a run resumes where it stopped, and that it learns.
#![cfg(feature = "train")]

mod shapes;

use std::fs;
use std::path::{Path, PathBuf};

use geose_fmap::device::Cpu;
use geose_fmap::network::{Model, ModelConfig};
use geose_fmap::pipeline::prepare;
use geose_fmap::train::atlas::Atlas;
use geose_fmap::train::folds::cross_validate;
use geose_fmap::train::losses::LossWeights;
use geose_fmap::train::pool::Pool;
use geose_fmap::train::run::{Fold, RunConfig, RunError, train};
use geose_fmap::train::sample::Sample;
use geose_fmap::train::sample_config::SampleConfig;
use geose_fmap::{LaplacianKind, PrepareOptions, Progress, Shape, Weights};
use ndarray::{Array2, Axis};
use shapes::{Random, Soup, body, icosphere};

fn network() -> ModelConfig {
    ModelConfig {
        width: 12,
        blocks: 2,
        eigenpairs: 24,
        moments: 3,
        features: 8,
        attention: 4,
        ..ModelConfig::shipped()
    }
}

/// Every twelfth point of a sample body, in an order of one's own.
fn scan(name: &str, order: impl Fn(usize) -> Vec<u32>) -> Shape {
    let whole = body(name);
    let labels = whole.labels().expect("samples have labels");
    let kept: Vec<usize> = (0..whole.points().len()).step_by(12).collect();
    let order = order(kept.len());
    let rows: Vec<usize> = order.iter().map(|&i| kept[i as usize]).collect();
    let points = rows.iter().map(|&i| whole.points()[i]).collect();
    Shape::new(points, vec![], Some(rows.iter().map(|&i| labels[i]).collect())).expect("a cloud")
}

fn in_order(n: usize) -> Vec<u32> {
    (0..n as u32).collect()
}

/// Samples for it.
fn samples() -> SampleConfig {
    SampleConfig::of(&network(), 1500)
}

/// A folder of its own.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Two people in turns, as training finds them on disk.
fn pool_of(count: usize, name: &str) -> Pool {
    let folder = folder(name);
    for index in 0..count {
        let name = ["woman-standing.ply", "man-lunging.ply"][index % 2];
        let sample = Sample::new(scan(name, in_order), None, None, &samples()).expect("a sample");
        sample.save(&folder.join(format!("{index:06}.sample"))).expect("saved");
    }
    Pool::open(&folder, count, &samples()).expect("opened")
}

fn pool(name: &str) -> Pool {
    pool_of(2, name)
}

#[test]
fn a_folder_of_samples_is_not_used_for_others() {
    let folder = folder("settings");
    let open = |config: &SampleConfig| Pool::open(&folder, 2, config).map(|pool| pool.count);
    assert_eq!(open(&samples()).ok(), Some(2));
    assert_eq!(open(&samples()).ok(), Some(2));
    let error = open(&SampleConfig { points: 900, ..samples() }).expect_err("other settings");
    assert!(error.to_string().contains("name another folder"), "{error}");
}

#[test]
fn folds_leave_bodies_out_and_are_scored_once() {
    let pool = pool_of(4, "folds");
    let folder = folder("folds-out");
    let run = |rate: f32| RunConfig { steps: 40, maps_from: 20, rate, ..RunConfig::default() };
    // At a rate of zero nothing is learned.
    let candidates = [run(0.0), run(5e-3)];
    assert_eq!(cross_validate(&network(), &candidates, 2, &pool, &folder).expect("trained"), Some(1));
    let table = fs::read_to_string(folder.join("folds.csv")).expect("written");
    assert_eq!(table.lines().count(), 3, "{table}");
    let trained = folder.join("candidate-1-fold-0/weights.safetensors");
    let first = fs::metadata(&trained).and_then(|m| m.modified()).expect("there");
    assert_eq!(cross_validate(&network(), &candidates, 2, &pool, &folder).expect("read"), Some(1));
    assert_eq!(fs::metadata(&trained).and_then(|m| m.modified()).expect("there"), first);
    assert_eq!(fs::read_to_string(folder.join("folds.csv")).expect("written"), table);
    // Other candidates of the same number: only what differs is trained again, and from its beginning.
    let score = folder.join("candidate-0-fold-1/score");
    fs::write(&score, "0.75").expect("written");
    let candidates = [candidates[0].clone(), RunConfig { steps: 20, ..candidates[1].clone() }];
    cross_validate(&network(), &candidates, 2, &pool, &folder).expect("trained");
    assert_eq!(fs::read_to_string(&score).expect("there"), "0.75");
    assert_eq!(weights(&folder.join("candidate-1-fold-0")).about["steps"], "20");

    let fold = Fold { of: 5, held: 2 };
    assert_eq!((0..12).filter(|&index| fold.holds(index)).collect::<Vec<_>>(), [2, 7]);
}

#[test]
fn folds_without_bodies_are_refused() {
    let pool = Pool::open(&folder("few"), 5, &samples()).expect("opened");
    let run = |of| RunConfig { fold: Some(Fold { of, held: 0 }), ..RunConfig::default() };
    for of in [0, 1, 3] {
        let refused = train(&network(), &run(of), &pool, &folder("few-out"), None, f64::INFINITY);
        assert!(matches!(refused, Err(RunError::Folds { folds, bodies: 5 }) if folds == of), "{refused:?}");
    }
    let refused = cross_validate(&network(), &[RunConfig::default()], 3, &pool, &folder("few-out"));
    assert!(refused.expect_err("too few").to_string().contains("3 folds of 5 bodies"));
}

#[test]
fn a_budget_in_minutes_ends_a_run() {
    let pool = pool("budget");
    let folder = folder("budget-out");
    let losses = LossWeights { coupling: 0.0, ..LossWeights::default() };
    let run = RunConfig { minutes: Some(0.02), steps: 1_000_000, losses, ..RunConfig::default() };
    assert!(train(&network(), &run, &pool, &folder, None, f64::INFINITY).expect("trained"));
    assert!(folder.join("weights.safetensors").exists());
}

#[test]
fn a_budget_in_minutes_begins_anew() {
    let pool = pool("anew");
    let folder = folder("anew-out");
    let steps = || weights(&folder).about["steps"].parse::<usize>().expect("a number");
    let run = RunConfig { steps: 20, ..RunConfig::default() };
    assert!(train(&network(), &run, &pool, &folder, None, f64::INFINITY).expect("trained"));
    assert_eq!(steps(), 20);
    // Over before its first step, or soon after.
    let run = RunConfig { minutes: Some(1e-9), ..run };
    assert!(train(&network(), &run, &pool, &folder, None, f64::INFINITY).expect("trained"));
    assert!(steps() < 20, "{}", steps());
}

/// Labels are all that says what a point is: in another order of the points the same numbers come in that order, so that no place in a list and no
/// hidden channel can say which body point a point is.
#[test]
fn the_loader_knows_parts_and_no_vertices() {
    let shuffled = |n: usize| Random(5).permutation(n);
    let plain = Sample::new(scan("man-lunging.ply", in_order), None, None, &samples()).expect("a sample");
    let mixed = Sample::new(scan("man-lunging.ply", shuffled), None, None, &samples()).expect("a sample");
    let order: Vec<usize> = shuffled(plain.labels.len()).iter().map(|&i| i as usize).collect();
    assert_eq!(mixed.labels, order.iter().map(|&i| plain.labels[i]).collect::<Vec<_>>());
    assert!(plain.labels.iter().all(|&label| label < 14));
    let same = |name: &str, a: &ndarray::Array2<f32>, b: &ndarray::Array2<f32>| {
        let apart = (a - &b.select(Axis(0), &order)).iter().fold(0.0f32, |most, d| most.max(d.abs()));
        assert!(apart < 1e-3, "{name}: {apart}");
    };
    let (mixed, plain) = (&mixed.inputs, &plain.inputs);
    same("channels", &mixed.channels, &plain.channels);
    same("points", &mixed.points, &plain.points);
    // Eigenfunctions up to their sign.
    let squares = |m: &ndarray::Array2<f32>| m.mapv(|v| v * v);
    same("phi", &squares(&mixed.phi), &squares(&plain.phi));
    let slopes = |s: &geose_fmap::network::ShapeInputs| squares(&s.gradients[0]) + squares(&s.gradients[1]);
    let (a, b) = (slopes(mixed), slopes(plain));
    let largest = b.iter().fold(0.0f32, |most, v| most.max(*v));
    same("gradients", &(a / largest), &(b / largest));
}

#[test]
fn points_put_between_others_have_the_label_and_the_place_of_the_one_that_stands_for_them() {
    let shells = icosphere(2).beside(&icosphere(2).moved(|[x, y, z]| [x + 1.4, y, z]));
    let n = shells.points.len();
    let labels: Vec<u32> = (0..n).map(|i| u32::from(i >= n / 2)).collect();
    let places: Vec<[f32; 3]> = labels.iter().map(|&label| [label as f32; 3]).collect();
    let scan = Shape::new(shells.points, shells.faces, Some(labels)).expect("two balls");
    let sample = Sample::new(scan, Some(&places), None, &samples()).expect("a sample");
    assert!(sample.labels.len() > n);
    for (place, &label) in sample.places.expect("places").rows().into_iter().zip(&sample.labels) {
        assert_eq!(place[0], label as f32);
    }
    // Far to one side every point is of that ball.
    let far = |row: usize| sample.inputs.points[(row, 0)];
    let (low, high) = (0..sample.labels.len()).map(far).fold((f32::MAX, f32::MIN), |(a, b), x| (a.min(x), b.max(x)));
    for (row, &label) in sample.labels.iter().enumerate() {
        let share = (far(row) - low) / (high - low);
        assert!((0.4..0.6).contains(&share) || label == u32::from(share > 0.5), "{label} at {share}");
    }
}

/// As L_orth takes them to be, so that features can be orthonormal.
#[test]
fn masses_of_a_sample_sum_to_1() {
    for kind in [LaplacianKind::Geodesic, LaplacianKind::GeodesicLiteral] {
        let inputs =
            Sample::new(scan("man-lunging.ply", in_order), None, Some(kind), &samples()).expect("a sample").inputs;
        let mass = inputs.projector.column(0).sum() / inputs.phi[(0, 0)];
        assert!((mass - 1.0).abs() < 1e-3, "{kind:?}: {mass}");
    }
}

/// Places are what the method finds by labels, and come with their points in any order: nothing but the mesh of the body and its labels goes in.
#[test]
fn places_are_found_by_part_labels() {
    let teacher = || Model::new(Model::embedded().networks()[0].weights().clone()).expect("a model");
    let atlas = Atlas::new(body("woman-standing.ply"), teacher()).expect("an atlas");
    let man = body("man-lunging.ply");
    let places = atlas.places(man.clone()).expect("places");
    // All samples share the vertices of one template, which neither side is told.
    let neutral = body("woman-standing.ply");
    let scale = prepare(neutral.clone(), None, &PrepareOptions::default(), &mut Progress::silent())
        .expect("prepared")
        .info
        .scale;
    let off = |(place, truth): (&[f32; 3], &[f64; 3])| {
        (0..3).map(|c| (f64::from(place[c]) - truth[c] / scale).powi(2)).sum::<f64>().sqrt()
    };
    let mean = places.iter().zip(neutral.points()).map(off).sum::<f64>() / places.len() as f64;
    assert!(mean < 0.03, "{mean}");

    let order = Random(5).permutation(man.points().len());
    let soup = Soup { points: man.points().to_vec(), faces: man.faces().to_vec() }.renumbered(&order);
    let mut labels = vec![0; order.len()];
    order.iter().zip(man.labels().expect("labels")).for_each(|(&new, &label)| labels[new as usize] = label);
    let again = atlas.places(Shape::new(soup.points, soup.faces, Some(labels)).expect("a mesh")).expect("places");
    let moved = |(&new, place): (&u32, &[f32; 3])| {
        (0..3).map(|c| (again[new as usize][c] - place[c]).powi(2)).sum::<f32>().sqrt()
    };
    let apart = order.iter().zip(&places).map(moved).sum::<f32>() / places.len() as f32;
    assert!(apart < 0.005, "{apart}");
    assert!(atlas.places(Shape::new(man.points().to_vec(), man.faces().to_vec(), None).expect("a mesh")).is_err());
}

#[test]
fn a_mirrored_sample_is_that_of_the_mirrored_scan() {
    let trained = &Model::embedded().networks()[0];
    let (config, category) = (SampleConfig::of(&trained.weights().config, 1500), trained.category());
    let scan = scan("man-lunging.ply", in_order);
    let mirror = |label: &u32| category.parts[*label as usize].mirror as u32;
    let labels: Vec<u32> = scan.labels().expect("samples have labels").iter().map(mirror).collect();
    let points: Vec<[f64; 3]> = scan.points().iter().map(|&[x, y, z]| [-x, y, z]).collect();
    let other = Shape::new(points, vec![], Some(labels)).expect("a cloud");
    let sample = |scan: Shape, places: &[[f32; 3]]| Sample::new(scan, Some(places), None, &config).expect("a sample");
    let places = |sign: f32| (0..other.points().len()).map(|i| [sign * i as f32, 1.0, 2.0]).collect::<Vec<_>>();
    let (plain, wanted) = (sample(scan, &places(1.0)), sample(other.clone(), &places(-1.0)));
    let found = plain.clone().mirrored(category);
    assert_eq!(found.labels, wanted.labels);
    assert_eq!(found.places, wanted.places);
    assert_eq!(found.clone().mirrored(category), plain);
    let features = |sample: &Sample| pollster::block_on(trained.embed(&Cpu, &sample.inputs)).0.features;
    let [plain, found, wanted] = [&plain, &found, &wanted].map(features);
    let apart = |a: &Array2<f32>, b: &Array2<f32>| (a - b).mapv(|x| x * x).sum() / (a * a).sum();
    assert!(apart(&wanted, &found) < 1e-3, "{}", apart(&wanted, &found));
    assert!(apart(&wanted, &plain) > 0.1, "{}", apart(&wanted, &plain));
}

#[test]
fn a_sample_comes_back_from_its_file_in_half_precision() {
    let folder = folder("sample");
    let places: Vec<[f32; 3]> =
        scan("woman-standing.ply", in_order).points().iter().map(|p| p.map(|x| x as f32)).collect();
    let sample = Sample::new(scan("woman-standing.ply", in_order), Some(&places), None, &samples()).expect("a sample");
    assert!(sample.places.is_some());
    let path = folder.join("one.sample");
    sample.save(&path).expect("saved");
    let again = Sample::load(&path).expect("loaded");
    assert_eq!(again.labels, sample.labels);
    let (placed, placed_again) = (sample.places.as_ref().expect("places"), again.places.as_ref().expect("places"));
    for (a, b) in [
        (placed_again, placed),
        (&again.inputs.phi, &sample.inputs.phi),
        (&again.inputs.projector, &sample.inputs.projector),
        (&again.inputs.moments, &sample.inputs.moments),
        (&again.inputs.gradients[0], &sample.inputs.gradients[0]),
    ] {
        let largest = b.iter().fold(0.0f32, |most, v| most.max(v.abs()));
        let apart = (a - b).iter().fold(0.0f32, |most, d| most.max(d.abs()));
        assert!(apart < 1e-3 * largest, "{apart} of {largest}");
    }
    fs::write(&path, b"not a sample").expect("written");
    assert!(Sample::load(&path).is_err());
}

fn weights(folder: &Path) -> Weights {
    Weights::from_bytes(&fs::read(folder.join("weights.safetensors")).expect("written")).expect("weights")
}

#[test]
fn a_run_that_was_stopped_goes_on_as_if_it_had_not_been() {
    let pool = pool("resumed");
    let run = RunConfig { steps: 6, maps_from: 2, ..RunConfig::default() };
    let (whole, parts) = (folder("whole"), folder("parts"));
    assert!(train(&network(), &run, &pool, &whole, None, f64::INFINITY).expect("trained"));
    // With no time at all a run ends after one step.
    let mut pieces = 0;
    while !train(&network(), &run, &pool, &parts, None, 0.0).expect("trained") {
        pieces += 1;
    }
    assert_eq!(pieces, 5);
    assert_eq!(weights(&whole), weights(&parts));
    Model::new(weights(&whole)).expect("a network");
}

#[test]
fn parts_are_learned_in_a_few_steps() {
    let pool = pool("learned");
    let folder = folder("learned-run");
    let run = RunConfig { steps: 120, maps_from: 60, rate: 1e-2, ..RunConfig::default() };
    train(&network(), &run, &pool, &folder, None, f64::INFINITY).expect("trained");
    let (head, lines) = log(&folder);
    assert_eq!(lines.len(), 6);
    let value = |line: &[String], name: &str| -> Option<f64> {
        let column = head.iter().position(|column| column == name).expect("a column");
        line[column].parse().ok()
    };
    let (first, last) = (&lines[0], &lines[5]);
    let (before, after) = (value(first, "parts").expect("a number"), value(last, "parts").expect("a number"));
    assert!(after < 0.5 * before && after < 0.9, "cross-entropy {before}, then {after}");
    assert_eq!(value(first, "coupling"), None);
    assert!(value(last, "coupling") > Some(0.0), "functional maps joined in");
}

/// The head of a run's log and its lines, all of one length.
fn log(folder: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(folder.join("log.csv")).expect("a log");
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let lines: Vec<Vec<String>> = lines.collect();
    assert!(lines.iter().all(|line| line.len() == head.len()), "{text}");
    (head, lines)
}

#[test]
fn a_log_has_one_head_and_the_lines_of_one_run() {
    let pool = pool("logged");
    let folder = folder("logged-run");
    let trained = |steps: usize, minutes: Option<f64>| {
        let run = RunConfig { steps, minutes, maps_from: 1000, ..RunConfig::default() };
        train(&network(), &run, &pool, &folder, None, f64::INFINITY).expect("trained");
        let (head, lines) = log(&folder);
        assert_eq!(head[..4], ["step", "rate", "seconds", "parts"]);
        lines.into_iter().map(|line| line[0].clone()).collect::<Vec<_>>()
    };
    assert_eq!(trained(20, None), ["20"]);
    assert_eq!(trained(40, None), ["20", "40"]);
    // What begins anew has a log of its own.
    assert!(trained(40, Some(1e-9)).is_empty());
}

/// Both configurations survive the JSON that options are merged in.
#[test]
fn run_configurations_survive_their_json() {
    for run in [RunConfig::default(), RunConfig::paper(1500)] {
        let text = serde_json::to_string(&run).expect("JSON");
        assert_eq!(serde_json::from_str::<RunConfig>(&text).expect("read back"), run);
    }
}
