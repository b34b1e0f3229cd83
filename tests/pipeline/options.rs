//! What cannot be done is refused.

use super::*;

#[test]
fn options_out_of_range_are_refused() {
    let shape = fibonacci_sphere(100).shape();
    let defaults = PrepareOptions::default();
    let bad = [
        PrepareOptions { points: 0, ..defaults.clone() },
        PrepareOptions { points: 49, ..defaults.clone() },
        PrepareOptions { eigenpairs: 0, ..defaults.clone() },
        PrepareOptions { eigenpairs: 9, ..defaults.clone() },
        PrepareOptions { eigenpairs: 1001, ..defaults.clone() },
    ];
    for options in bad {
        let error = prepare(shape.clone(), None, &options, &mut Progress::silent()).expect_err("refused");
        assert_eq!(error.code(), "invalid-option", "{options:?}");
    }
    let cotangent = PrepareOptions { laplacian: Some(LaplacianKind::Cotangent), ..defaults };
    let error = prepare(shape, None, &cotangent, &mut Progress::silent()).expect_err("refused");
    assert_eq!(error.code(), "needs-faces");
}

#[test]
fn match_options_that_cannot_be_are_refused() {
    let small = &*SMALL;
    let bare = prepared(blob(2).shape(), &quick());
    let refused = |a: &PreparedShape, b: &PreparedShape, options: MatchOptions| {
        matched_with(a, b, &options).map(|_| ()).expect_err("refused")
    };
    let n = small.shape.points().len() as u32;
    // Not a point of A, nor of B, and points that would have two partners.
    for pair in [[n, 0], [0, 162], [u32::MAX, 0], [1, 2], [2, 1]] {
        let error = refused(small, &bare, MatchOptions { landmarks: vec![[1, 1], pair], ..Default::default() });
        assert_eq!(error.code(), "invalid-option", "{pair:?}");
    }
    let given = refused(small, &bare, MatchOptions { parts: Parts::Given, ..Default::default() });
    assert_eq!((given.code(), given.details()["scan"].as_str()), ("no-labels", Some("b")));
}

#[test]
fn what_cannot_fit_is_refused_before_any_work() {
    let shape = fibonacci_sphere(300_000).shape();
    for (points, eigenpairs) in [(190_000, 1000), (300_000, 1000)] {
        let options = PrepareOptions { points, eigenpairs, ..Default::default() };
        let mut progress = Progress::new(|stage, fraction| {
            assert!(stage == Stage::Sample && fraction == 0.0, "{stage:?} {fraction}");
            true
        });
        let error = prepare(shape.clone(), None, &options, &mut progress).expect_err("too large");
        assert_eq!(error.code(), "too-large");
    }
    for points in [10, 3_000_000_000] {
        let options = PrepareOptions { points, ..Default::default() };
        let error = prepare(shape.clone(), None, &options, &mut Progress::silent()).expect_err("out of range");
        assert_eq!(error.code(), "invalid-option");
    }
}
