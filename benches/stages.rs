//! Seconds per stage after the Laplacian (benches/operators.rs) by size: `cargo bench --bench stages`. Bodies are the
//! sample scans; other sizes are farthest-point samplings of them.

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use geose_fmap::operators::laplacian;
use geose_fmap::pipeline::{match_shapes, prepare};
use geose_fmap::spectrum::spectrum;
use geose_fmap::{FaceUse, LaplacianKind, MatchOptions, PrepareOptions, Progress, Refinement, Shape, read};

fn sample(name: &str) -> Shape {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("www/public/samples").join(name);
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    read(&bytes, Some(name), None).expect("the samples are good files")
}

/// A cloud of about `n` points: the vertices of a body, with the midpoints of its faces and edges where more are
/// needed.
fn cloud(n: usize) -> Shape {
    let body = sample("woman-standing.ply");
    let corner = |i: u32| body.points()[i as usize];
    let between = |f: &[u32; 3], w: [f64; 3]| std::array::from_fn(|c| (0..3).map(|k| w[k] * corner(f[k])[c]).sum());
    let inside = [[1.0 / 3.0; 3], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2]];
    let more = inside.into_iter().flat_map(|w| body.faces().iter().map(move |f| (f, w))).map(|(f, w)| between(f, w));
    let points: Vec<[f64; 3]> = body.points().iter().copied().chain(more).collect();
    let stride = (points.len() / n).max(1);
    Shape::new(points.into_iter().step_by(stride).take(n).collect(), Vec::new(), None).expect("a body is a good shape")
}

fn spectra(c: &mut Criterion) {
    let mut group = c.benchmark_group("spectrum of 120");
    for n in [1000, 5000, 20_000] {
        let cloud = cloud(n);
        let l = laplacian(&cloud, LaplacianKind::Geodesic, &mut Progress::silent())
            .expect("clouds have a geodesic Laplacian");
        group.bench_function(BenchmarkId::from_parameter(cloud.points().len()), |b| {
            b.iter(|| spectrum(black_box(&l.matrix), &l.mass, 120, &mut Progress::silent()));
        });
    }
    group.finish();
}

fn matching(c: &mut Criterion) {
    let mut group = c.benchmark_group("match of 5000 and 5000");
    for faces in [FaceUse::Use, FaceUse::Ignore] {
        let options = PrepareOptions { faces, ..PrepareOptions::default() };
        let ready =
            |name| prepare(sample(name), None, &options, &mut Progress::silent()).expect("the samples are good shapes");
        let (a, b) = (ready("woman-standing.ply"), ready("man-standing.ply"));
        for refine in [Refinement::None, Refinement::ZoomOut, Refinement::Best] {
            let options = MatchOptions { refine, ..MatchOptions::default() };
            group.bench_function(BenchmarkId::new(format!("{refine:?}"), format!("faces {faces:?}")), |bench| {
                bench.iter(|| match_shapes(&a, &b, &options, &mut Progress::silent()));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = stages;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(8));
    targets = spectra, matching
}
criterion_main!(stages);
