//! What is heard on the way, and what preparing tells at the end.

use super::*;

#[test]
fn preparing_tells_what_the_scan_is() {
    let info = &BODY.info;
    assert_eq!(
        (info.kind, info.points, info.faces, info.pieces, info.points_used),
        (ShapeKind::Mesh, 5000, 9996, 1, 5000)
    );
    assert_eq!((info.unit.as_deref(), info.up_axis), (Some("m"), Some(geose_fmap::Axis::Y)));
    assert_eq!((info.laplacian, info.eigenpairs), (LaplacianKind::Cotangent, 120));
    assert!(info.residual <= 1e-6 && (info.scale / BODY.shape.surface_area().sqrt() - 1.0).abs() < 1e-3);
    let cloud = prepared(body("woman-greeting-cloud.ply"), &quick());
    assert_eq!((cloud.info.kind, cloud.info.laplacian), (ShapeKind::Cloud, LaplacianKind::Geodesic));
}

/// Runs once to hear of everything, then once for every call, stopping there.
fn assert_stops(stages: &[Stage], run: impl Fn(&mut Progress<'_>) -> Result<(), Error>) {
    let mut heard: Vec<(Stage, f64)> = vec![];
    let listener = |stage, fraction| {
        heard.push((stage, fraction));
        true
    };
    run(&mut Progress::new(listener)).expect("not stopped");
    assert!(heard.windows(2).all(|w| w[0] <= w[1]), "stages in order, fractions growing: {heard:?}");
    assert!(stages.iter().all(|stage| heard.iter().any(|(s, _)| s == stage)), "{heard:?}");
    for (stop, (stage, _)) in heard.iter().enumerate() {
        let mut calls = 0;
        let listener = |_, _| {
            calls += 1;
            calls <= stop
        };
        let error = run(&mut Progress::new(listener)).expect_err("stopped");
        assert!(matches!(error, Error::Cancelled(_)), "{error:?}");
        assert_eq!((error.code(), calls), ("cancelled", stop + 1), "{stage:?}");
        assert_eq!(error.details(), serde_json::json!({ "stage": stage }));
    }
}

#[test]
fn every_stage_is_heard_of_and_a_stop_there_stops() {
    let shape = body("man-standing.ply");
    let options = PrepareOptions { points: 400, eigenpairs: 60, ..as_cloud() };
    let whole = prepared(shape.clone(), &options);
    let stages = [Stage::Sample, Stage::Graph, Stage::Laplacian, Stage::Spectrum, Stage::Features];
    assert_stops(&stages, |progress| prepare(shape.clone(), None, &options, progress).map(|_| ()));
    let options = MatchOptions::default();
    let stages = [Stage::FunctionalMap, Stage::Refine, Stage::Correspondence];
    assert_stops(&stages, |progress| match_shapes(&whole, &whole, &options, progress).map(|_| ()));
}
