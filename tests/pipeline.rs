//! From scan to map: a body finds itself, in any pose of the whole and any unit; every size of upload gives a whole map; what cannot be done
//! is said; a prepared shape survives its bytes.
#![cfg(not(target_arch = "wasm32"))]

#[path = "pipeline/blocks.rs"]
mod blocks;
#[path = "pipeline/large_meshes.rs"]
mod large_meshes;
#[path = "pipeline/maps.rs"]
mod maps;
#[path = "pipeline/options.rs"]
mod options;
mod shapes;
#[path = "pipeline/stages.rs"]
mod stages;
#[path = "pipeline/strays.rs"]
mod strays;
#[path = "pipeline/uploads.rs"]
mod uploads;
#[path = "pipeline/warnings.rs"]
mod warnings;

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;
use std::sync::LazyLock;

use geose_fmap::network::Model;
use geose_fmap::pipeline::{BlockError, ShapeKind, match_shapes, prepare};
use geose_fmap::uses::{EdgeDistances, mean_error};
use geose_fmap::{
    Correspondence, Error, FaceUse, LaplacianKind, Match, MatchOptions, Parts, PrepareOptions, PreparedShape, Progress,
    Refinement, Shape, Stage, UNMATCHED, read,
};
use safetensors::SafeTensors;
use shapes::{
    BODIES, Random, Soup, blob, body, distance, fibonacci_sphere, icosphere, prepared, scan, sheet, soup, subdivided,
    torus, turn,
};

fn matched(a: &PreparedShape, b: &PreparedShape) -> Match {
    matched_with(a, b, &MatchOptions::default()).expect("a match")
}

fn matched_with(a: &PreparedShape, b: &PreparedShape, options: &MatchOptions) -> Result<Match, Error> {
    match_shapes(a, b, options, &mut Progress::silent())
}

fn as_cloud() -> PrepareOptions {
    PrepareOptions { faces: FaceUse::Ignore, ..Default::default() }
}

/// Fewer eigenpairs, for tests that are not about accuracy.
fn quick() -> PrepareOptions {
    PrepareOptions { eigenpairs: 60, ..Default::default() }
}

/// The first sample body as a mesh, prepared once.
static BODY: LazyLock<PreparedShape> = LazyLock::new(|| prepared(body(BODIES[0]), &PrepareOptions::default()));

/// A small shape of everything a block can hold: labels, samples, and a point without a face.
static SMALL: LazyLock<PreparedShape> = LazyLock::new(|| {
    let mut soup = blob(2);
    soup.points.push([0.0, 0.0, 4.0]);
    let labels = (0..soup.points.len() as u32).map(|i| i % 3).collect();
    let shape = Shape::new(soup.points, soup.faces, Some(labels)).expect("a valid shape");
    prepare(
        shape,
        Some("small.ply".into()),
        &PrepareOptions { points: 80, eigenpairs: 20, ..quick() },
        &mut Progress::silent(),
    )
    .expect("a prepared shape")
});

/// Targets for every uploaded point, all there, each with a confidence.
fn assert_whole(what: &str, map: &Correspondence, from: &PreparedShape, to: &PreparedShape) {
    let (n, m) = (from.shape.points().len(), to.shape.points().len());
    assert_eq!((map.target.len(), map.confidence.len()), (n, n), "{what}");
    assert!(map.target.iter().all(|&t| (t as usize) < m && t != UNMATCHED), "{what}");
    assert!(map.confidence.iter().all(|c| (0.0..=1.0).contains(c)), "{what}");
}

fn assert_match(what: &str, a: &PreparedShape, b: &PreparedShape) -> Match {
    let found = matched(a, b);
    assert_whole(what, &found.a_to_b, a, b);
    assert_whole(what, &found.b_to_a, b, a);
    assert_eq!(found.points_used, [a.points_used(), b.points_used()], "{what}");
    let k = a.info.eigenpairs.min(b.info.eigenpairs);
    for map in [&found.c_ab, &found.c_ba] {
        assert_eq!(map.matrix.dim(), (k, k), "{what}");
        assert!(map.matrix.iter().all(|v| v.is_finite()), "{what}");
    }
    found
}
