//! A mesh, the cloud of its vertices and samplings of that cloud have nearly the same spectrum once area and scale are
//! taken out.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::f64::consts::PI;

use geose_fmap::spectrum::spectrum;
use geose_fmap::{LaplacianKind, Progress, Shape};
use shapes::{BODIES, body, farthest, laplacian};

/// Eigenvalues compared, the zero among them.
const FIRST: usize = 60;

/// The first eigenvalues of a body of unit area, and Weyl-normalised: divided by the mean of λ_j/4πj over j = 16…63,
/// which is 1 on a surface without boundary but for terms of higher order.
fn normalised(shape: &Shape, kind: LaplacianKind) -> Vec<f64> {
    let operator = laplacian(shape, kind);
    let (basis, _) = spectrum(&operator.matrix, &operator.mass, 64, &mut Progress::silent()).expect("a spectrum");
    let unit: Vec<f64> = basis.eigenvalues.iter().map(|lambda| lambda * operator.area()).collect();
    let weyl = (16..64).map(|j| unit[j] / (4.0 * PI * j as f64)).sum::<f64>() / 48.0;
    unit.iter().map(|lambda| lambda / weyl).collect()
}

/// How far the first eigenvalues are from others, in %.
#[derive(Debug)]
struct Deviation {
    mean: f64,
    most: f64,
    /// Which eigenvalue deviates most.
    at: usize,
    /// How many deviate by no more than 3 %.
    good: usize,
}

impl Deviation {
    fn of(found: &[f64], right: &[f64]) -> Self {
        let off: Vec<f64> = (1..FIRST).map(|j| 100.0 * (found[j] / right[j] - 1.0).abs()).collect();
        let worst = (0..off.len()).fold(0, |worst, j| if off[j] > off[worst] { j } else { worst });
        let good = off.iter().filter(|&&e| e <= 3.0).count();
        Self { mean: off.iter().sum::<f64>() / off.len() as f64, most: off[worst], at: worst + 1, good }
    }
}

/// The aim is 3 % for each of the first 60. Of the clouds' 49 to 57 of 59 reach it, 1.2 to 1.7 % is the average, and
/// 6.4 % the worst: λ₃ of man-standing, on which the arms oscillate against each other, is too small. Weights are good
/// there (on woman-standing they give this function of the mesh its energy within 2 %), but the mass finds hands 8 %
/// too large: five points go around a finger, and no plane is theirs.
///
/// On 3000 samples two or three do. Hands come out a third too large, λ₃ 11 to 14 % too small, and the average
/// deviation is 1.9 to 2.5 %.
#[test]
fn a_cloud_and_its_samplings_have_about_the_spectrum_of_the_mesh_of_the_same_body() {
    for file in BODIES {
        let mesh = body(file);
        let right = normalised(&mesh, LaplacianKind::Cotangent);
        let cloud = mesh.without_faces();
        let samples = farthest(&cloud, 3000);
        let [found, sampled] = [&cloud, &samples].map(|shape| normalised(shape, LaplacianKind::Geodesic));
        // Measured on the four bodies, rounded up: mean and largest deviation, and how many of 59 are within 3 %.
        for (name, off, mean_allowed, most_allowed, good_needed) in [
            ("cloud against mesh", Deviation::of(&found, &right), 1.8, 6.7, 48),
            ("3000 samples against mesh", Deviation::of(&sampled, &right), 2.6, 14.5, 41),
            ("3000 samples against cloud", Deviation::of(&sampled, &found), 2.1, 11.0, 47),
        ] {
            let Deviation { mean, most, at, good } = off;
            println!("{file}, {name}: {mean:.2} % on average, at most {most:.2} % (λ{at}), {good} of 59 within 3 %");
            assert!(mean <= mean_allowed && most <= most_allowed && good >= good_needed, "{file}, {name}: {off:?}");
        }
    }
}
