//! What the network knows, what it does not, and that it says so.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use geose_fmap::network::Model;
use geose_fmap::pipeline::match_shapes;
use geose_fmap::{MatchOptions, Parts, PrepareOptions, PreparedShape, Progress, Refinement, Shape, Warning, Weights};

use shapes::{body, prepared, soup, torus, turn};

fn options() -> PrepareOptions {
    PrepareOptions { points: 2000, eigenpairs: 80, ..PrepareOptions::default() }
}

/// Share of points whose predicted part is `expected`.
fn share(found: &PreparedShape, expected: &[u32]) -> f64 {
    let predicted = found.predicted_parts().expect("a network was asked");
    predicted.iter().zip(expected).filter(|(a, b)| a == b).count() as f64 / expected.len() as f64
}

fn labels(shape: &Shape) -> Vec<u32> {
    shape.labels().expect("samples have labels").to_vec()
}

fn warnings(a: &PreparedShape, b: &PreparedShape) -> Vec<Warning> {
    let matched = match_shapes(a, b, &MatchOptions::default(), &mut Progress::silent()).expect("matched");
    matched.warnings
}

#[test]
fn parts_of_the_sample_people_are_found_on_meshes_and_clouds() {
    for name in ["woman-striding.ply", "man-lunging.ply"] {
        let mesh = body(name);
        let of_mesh = share(&prepared(mesh.clone(), &options()), &labels(&mesh));
        let cloud = mesh.clone().without_faces();
        let of_cloud = share(&prepared(cloud, &options()), &labels(&mesh));
        assert!(of_mesh > 0.94 && of_cloud > 0.93, "{name}: mesh {of_mesh}, cloud {of_cloud}");
    }
}

#[test]
fn probabilities_of_parts_are_probabilities() {
    let found = prepared(body("man-standing.ply"), &options());
    let embedding = &found.embeddings[0];
    assert_eq!(embedding.parts.ncols(), embedding.category.parts.len());
    for row in embedding.parts.rows() {
        assert!((row.sum() - 1.0).abs() < 1e-5 && row.iter().all(|p| (0.0..=1.0).contains(p)));
    }
}

#[test]
fn turning_moving_and_scaling_a_body_changes_nothing() {
    let mesh = body("woman-striding.ply");
    let still = prepared(mesh.clone(), &options()).predicted_parts().expect("parts");
    let moved = soup(&mesh).moved(|p| turn(p).map(|x| 40.0 * x - 7.0)).shape();
    let same = share(&prepared(moved, &options()), &still);
    assert!(same > 0.995, "{same}");
}

#[test]
fn in_a_mirror_left_is_right() {
    let mesh = body("man-lunging.ply");
    let mirrored = soup(&mesh).mirrored().shape();
    let exchanged: Vec<u32> = labels(&mesh).into_iter().map(|part| if part < 2 { part } else { part ^ 1 }).collect();
    let right = share(&prepared(mirrored, &options()), &exchanged);
    assert!(right > 0.93, "{right}");
}

#[test]
fn the_report_is_unsure_of_what_the_network_does_not_know_and_only_of_that() {
    let woman = prepared(body("woman-standing.ply"), &options());
    let man = prepared(body("man-lunging.ply").without_faces(), &options());
    let ring = prepared(torus(1.0, 0.35, 60, 30).cloud().shape(), &options());
    let unsure = |warnings: Vec<Warning>| warnings.iter().any(|warning| warning.message.starts_with("unsure"));
    assert!(!unsure(warnings(&woman, &man)));
    assert!(unsure(warnings(&woman, &ring)) && unsure(warnings(&ring, &ring)));
}

#[test]
fn weights_survive_their_file_and_damaged_ones_are_refused() {
    let weights = Model::embedded().networks()[0].weights();
    let again = Weights::from_bytes(&weights.to_bytes(true).expect("bytes")).expect("weights");
    assert_eq!(&again, weights, "f16 values come back as they were");
    assert_eq!((again.id(), weights.id().name.as_str()), (weights.id(), "bodies"));

    let refusal = |tensors: Vec<(String, ndarray::Array2<f32>)>| {
        let weights = {
            let (config, category) = (weights.config.clone(), weights.category.clone());
            Weights::new(config, category, weights.about.clone(), tensors.into_iter().collect())
        };
        Model::new(weights).expect_err("refused").to_string()
    };
    let all = || weights.tensors().map(|(name, matrix)| (name.to_owned(), matrix.to_owned())).collect::<Vec<_>>();
    let missing: Vec<_> = all().into_iter().filter(|(name, _)| name != "parts.weight").collect();
    assert!(refusal(missing).contains("parts.weight is missing"));
    let mut wrong = all();
    wrong.iter_mut().find(|(name, _)| name == "parts.bias").expect("there").1 = ndarray::Array2::zeros((1, 3));
    assert!(refusal(wrong).contains("parts.bias is 1 by 3 and should be 1 by 14"));

    let bytes = weights.to_bytes(false).expect("bytes");
    for cut in [0, 7, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(Weights::from_bytes(&bytes[..cut]).is_err(), "cut to {cut} bytes");
    }
    let mut poisoned = bytes.clone();
    let end = poisoned.len();
    poisoned[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(Weights::from_bytes(&poisoned).expect_err("refused").to_string().contains("not finite"));
}

/// A ring is nobody, so that a map made without the network would compete and is the better one.
#[test]
fn the_networks_map_stands_alone_where_that_is_asked_for() {
    let ring = prepared(torus(1.0, 0.35, 60, 30).cloud().shape(), &options());
    let weights = |network_only: bool| {
        let options = MatchOptions { refine: Refinement::None, network_only, ..MatchOptions::default() };
        match_shapes(&ring, &ring, &options, &mut Progress::silent()).expect("matched").weights
    };
    assert_eq!(weights(false), None);
    assert_eq!(weights(true).as_ref(), Some(Model::embedded().networks()[0].id()));
}

/// Without parts the map knows features alone: whatever was predicted changes no match.
#[test]
fn parts_that_were_not_asked_for_change_nothing() {
    let (mut a, b) = (prepared(body("woman-standing.ply"), &options()), prepared(body("man-lunging.ply"), &options()));
    let found = |a: &PreparedShape, parts: Parts| {
        let options = MatchOptions { parts, refine: Refinement::None, ..MatchOptions::default() };
        match_shapes(a, &b, &options, &mut Progress::silent()).expect("matched").a_to_b.target
    };
    let (without, with) = (found(&a, Parts::None), found(&a, Parts::Predicted));
    // The sides exchanged, as sure as before, so that the pair is as familiar.
    let parts = &mut a.embeddings[0].parts;
    *parts = parts.select(ndarray::Axis(1), &[0, 1, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12]);
    assert_eq!(found(&a, Parts::None), without);
    assert_ne!(found(&a, Parts::Predicted), with, "where they are asked for they count");
}

#[test]
fn a_block_with_other_parts_is_refused() {
    let mut shape = prepared(body("man-standing.ply"), &options());
    let embedding = &mut shape.embeddings[0];
    embedding.parts = embedding.parts.slice(ndarray::s![.., ..13]).to_owned();
    let refusal = PreparedShape::from_bytes(&shape.to_bytes().expect("bytes")).expect_err("refused");
    assert!(refusal.to_string().contains("its parts are others"), "{refusal}");
}
