//! Work has bounds whatever is asked for, and what has no numbers is refused rather than matched.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::sync::LazyLock;

use geose_fmap::pipeline::match_shapes;
use geose_fmap::{Error, Match, MatchOptions, PrepareOptions, PreparedShape, Progress, Stage, UNMATCHED};
use shapes::{blob, body, distance, fibonacci_sphere, prepared};

fn quick() -> PrepareOptions {
    PrepareOptions { points: 1500, eigenpairs: 60, ..Default::default() }
}

fn matched(a: &PreparedShape, b: &PreparedShape, progress: &mut Progress) -> Result<Match, Error> {
    match_shapes(a, b, &MatchOptions::default(), progress)
}

/// A cloud of 10 242 points, all of which are to take part.
static LARGE: LazyLock<PreparedShape> =
    LazyLock::new(|| prepared(blob(5).cloud().shape(), &PrepareOptions { points: 20_000, ..quick() }));

#[test]
fn of_a_large_scan_a_sampling_is_compared_and_the_rest_follows() {
    let large = &*LARGE;
    assert_eq!(large.points_used(), 10_242);
    let found = matched(large, large, &mut Progress::silent()).expect("a match");
    // The square of these is what a match compares.
    assert_eq!(found.points_used, [7500, 7500]);
    for map in [&found.a_to_b, &found.b_to_a] {
        assert_eq!(map.target.len(), 10_242);
        assert!(map.target.iter().all(|&target| target != UNMATCHED));
        let points = large.shape.points();
        let off = map.target.iter().zip(points).map(|(&j, &p)| distance(points[j as usize], p)).sum::<f64>();
        let off = off / 10_242.0 / large.info.scale;
        println!("{off:.4} √area off on average");
        assert!(off < 0.005, "{off}");
    }
}

#[test]
fn the_last_match_can_be_stopped() {
    let small = prepared(blob(3).shape(), &quick());
    for large in [&*LARGE, &small] {
        let mut progress = Progress::new(|stage, _| stage != Stage::Correspondence);
        let error = matched(large, large, &mut progress).map(|_| ()).expect_err("stopped");
        assert_eq!((error.code(), error.details()["stage"].as_str()), ("cancelled", Some("correspondence")));
    }
}

#[test]
fn the_network_has_its_eigenpairs_however_few_are_asked_for() {
    let with = |eigenpairs: usize| prepared(body("woman-standing.ply"), &PrepareOptions { eigenpairs, ..quick() });
    let (few, enough) = (with(20), with(64));
    assert_eq!((few.basis.k(), few.info.eigenpairs), (20, 20));
    assert_eq!((few.basis.eigenvectors.ncols(), few.basis.eigenvalues.len()), (20, 20));
    assert_eq!(few.embeddings, enough.embeddings);
    let said = |shape: &PreparedShape| shape.repairs.iter().any(|repair| repair.code == "few-eigenpairs");
    assert!(!said(&few) && !said(&enough));
    let tiny = prepared(fibonacci_sphere(60).shape(), &quick());
    assert!(said(&tiny) && tiny.basis.k() == 58, "{:?}", tiny.repairs);
}

#[test]
fn a_prepared_shape_that_holds_no_numbers_is_refused_by_name() {
    let good = prepared(blob(3).shape(), &quick());
    let spoiled: [fn(&mut PreparedShape); 4] = [
        |shape| shape.basis.eigenvectors[(5, 3)] = f64::NAN,
        |shape| shape.basis.eigenvalues[7] = f64::INFINITY,
        |shape| shape.features[(9, 1)] = f32::NAN,
        |shape| shape.embeddings[0].features[(9, 1)] = f32::NAN,
    ];
    for spoil in spoiled {
        let mut bad = good.clone();
        spoil(&mut bad);
        let error = matched(&good, &bad, &mut Progress::silent()).map(|_| ()).expect_err("refused");
        assert_eq!(error.code(), "not-finite");
        assert!(error.to_string().contains("scan B"), "{error}");
    }
}
