//! Seconds per Laplacian by kind and size, graph and all, without the eigensolver: `cargo bench --bench operators`.
//! Throughput is points per second, so that it should not fall from 5000 to 20 000 points.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use geose_fmap::operators::laplacian;
use geose_fmap::{LaplacianKind, Progress, Shape};
use shapes::{Random, Soup, body, farthest, soup, subdivided};

#[path = "../tests/shapes/mod.rs"]
mod shapes;

const SIZES: [usize; 3] = [1000, 5000, 20_000];

/// The surface of a body with four times as many faces per level, shaken by a thirtieth of the spacing so that no four
/// points lie on a circle.
fn finer(mesh: &Soup) -> Soup {
    let finer = subdivided(mesh);
    let area = finer.shape().surface_area();
    let by = (area / finer.points.len() as f64).sqrt() / 30.0;
    let mut random = Random(1);
    finer.moved(|p| p.map(|x| x + by * random.sign()))
}

/// Clouds of evenly spread points on a body: each is the beginning of the largest.
fn clouds() -> Vec<Shape> {
    let dense = finer(&finer(&soup(&body("woman-standing.ply")))).cloud();
    let largest = farthest(&dense.shape(), SIZES[2]);
    let first = |n: usize| Shape::new(largest.points()[..n].to_vec(), vec![], None).expect("a good shape");
    SIZES.map(first).into()
}

/// The head of a body, the body, and the body with four times as many faces: 1000, 5000 and 19 994 points.
fn meshes() -> Vec<Shape> {
    let whole = soup(&body("woman-standing.ply"));
    let mut from_the_top: Vec<u32> = (0..whole.points.len() as u32).collect();
    from_the_top.sort_by(|&i, &j| whole.points[j as usize][1].total_cmp(&whole.points[i as usize][1]));
    let mut row = vec![u32::MAX; whole.points.len()];
    (0..SIZES[0]).for_each(|i| row[from_the_top[i] as usize] = i as u32);
    let faces = whole.faces.iter().map(|f| f.map(|i| row[i as usize]));
    let head = Soup {
        points: from_the_top[..SIZES[0]].iter().map(|&i| whole.points[i as usize]).collect(),
        faces: faces.filter(|f| f.iter().all(|&i| i != u32::MAX)).collect(),
    };
    [head, whole.clone(), finer(&whole)].map(|soup| soup.shape()).into()
}

fn operators(c: &mut Criterion) {
    let (clouds, meshes) = (clouds(), meshes());
    let mut group = c.benchmark_group("laplacian");
    for kind in LaplacianKind::ALL {
        for shape in if kind == LaplacianKind::Cotangent { &meshes } else { &clouds } {
            let n = shape.points().len();
            group.throughput(Throughput::Elements(n as u64));
            group.bench_with_input(BenchmarkId::new(kind.name(), n), shape, |b, shape| {
                b.iter(|| laplacian(black_box(shape), kind, &mut Progress::silent()));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = operators_by_size;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(5));
    targets = operators
}
criterion_main!(operators_by_size);
