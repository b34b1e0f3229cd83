//! Which samples touch, as a prepared shape keeps them for refinement.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use geose_fmap::{PrepareOptions, PreparedShape};
use shapes::{body, distance, fibonacci_sphere, icosphere, prepared};

fn quick() -> PrepareOptions {
    PrepareOptions { points: 1000, eigenpairs: 40, ..Default::default() }
}

/// Positions of the samples of the even sampling.
fn samples(shape: &PreparedShape) -> Vec<[f64; 3]> {
    shape.coarse.iter().map(|&row| shape.shape.points()[shape.support.uploaded(row as usize)]).collect()
}

#[test]
fn samples_touch_along_the_surface_only() {
    // Two balls of 1500 points, a third of the spacing (0.09) apart.
    let ball = fibonacci_sphere(1500);
    let pair = ball.beside(&ball.moved(|[x, y, z]| [x, y, z + 2.03]));
    let options = PrepareOptions { points: 3000, eigenpairs: 60, ..Default::default() };
    let shape = prepared(pair.shape(), &options);
    let places = samples(&shape);
    let across = shape.surface.adjacent.iter().filter(|pair| {
        let [one, other] = pair.map(|row| places[row as usize][2] > 1.015);
        one != other
    });
    let (across, touching) = (across.count(), shape.surface.adjacent.len());
    println!("{across} of {touching} pairs lead from one ball to the other");
    assert!(across <= 2 && touching > 5 * places.len() / 2, "{across} {touching}");
}

#[test]
fn every_point_has_a_sample_near_it_and_every_sample_another_one() {
    for (name, options) in [
        ("mesh", PrepareOptions { eigenpairs: 40, ..Default::default() }),
        ("sampled mesh", PrepareOptions { points: 2500, eigenpairs: 40, ..Default::default() }),
        (
            "cloud",
            PrepareOptions { points: 2500, eigenpairs: 40, faces: geose_fmap::FaceUse::Ignore, ..Default::default() },
        ),
    ] {
        let shape = prepared(body("woman-standing.ply"), &options);
        let places = samples(&shape);
        let surface = &shape.surface;
        assert_eq!((surface.cell.len(), surface.normals.len()), (shape.points_used(), shape.points_used()));
        let spacing = shape.info.scale / (places.len() as f64).sqrt();
        let far = (0..shape.points_used()).filter(|&row| {
            let at = shape.shape.points()[shape.support.uploaded(row)];
            distance(at, places[surface.cell[row] as usize]) > 2.5 * spacing
        });
        assert_eq!(far.count(), 0, "{name}");
        shape
            .coarse
            .iter()
            .zip(0..)
            .for_each(|(&row, sample)| assert_eq!(surface.cell[row as usize], sample, "{name}"));
        let mut held = vec![0; places.len()];
        surface.adjacent.iter().flatten().for_each(|&row| held[row as usize] += 1);
        let alone = held.iter().filter(|&&count| count == 0).count();
        println!(
            "{name}: {:.2} neighbours on average, {alone} alone",
            2.0 * surface.adjacent.len() as f64 / held.len() as f64
        );
        assert!(alone <= places.len() / 100, "{name}: {alone}");
        assert!(surface.normals.iter().all(|n| (distance(*n, [0.0; 3]) - 1.0).abs() < 1e-9), "{name}");
    }
    let small = prepared(icosphere(2).shape(), &quick());
    assert_eq!(small.surface.adjacent.len(), 480, "all points are samples, so the edges are those of the mesh");
}
