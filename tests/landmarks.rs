//! What a user knows of single points holds for what lies around them too, from the first map to the last match.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::sync::LazyLock;

use geose_fmap::pipeline::match_shapes;
use geose_fmap::uses::{EdgeDistances, mean_error};
use geose_fmap::{Match, MatchOptions, PrepareOptions, PreparedShape, Progress, Refinement, Shape};
use shapes::{body, distance, icosphere, prepared};

/// 60 eigenpairs and 1500 points are enough for the truths here.
fn quick() -> PrepareOptions {
    PrepareOptions { points: 1500, eigenpairs: 60, ..Default::default() }
}

/// Two people in different poses whose vertices correspond by index.
static PAIR: LazyLock<[PreparedShape; 2]> =
    LazyLock::new(|| ["woman-standing.ply", "man-lunging.ply"].map(|file| prepared(body(file), &quick())));

fn matched(a: &PreparedShape, b: &PreparedShape, options: &MatchOptions) -> Match {
    match_shapes(a, b, options, &mut Progress::silent()).expect("a match")
}

/// Error (×100/√area) of a map whose truth is "same index".
fn error(target: &[u32], on: &Shape) -> f64 {
    let pairs: Vec<_> = target.iter().copied().zip(0..).collect();
    mean_error(&EdgeDistances::new(on), &pairs)
}

/// The point of a part that is farthest from the middle of the body: the tip of a hand or a foot.
fn tip(shape: &PreparedShape, part: &str) -> u32 {
    let label = geose_fmap::network::Model::embedded().networks()[0]
        .category()
        .part_names()
        .iter()
        .position(|name| *name == part)
        .expect("a part") as u32;
    let (points, labels) = (shape.shape.points(), shape.shape.labels().expect("sample bodies have labels"));
    let middle = [0, 1, 2].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64);
    let of_part = (0..points.len()).filter(|&i| labels[i] == label);
    let far = |i: &usize| distance(points[*i], middle);
    of_part.max_by(|i, j| far(i).total_cmp(&far(j))).expect("points") as u32
}

/// Of the points within 0.05 √area of the landmark's point on A, the largest distance from its partner after the map, in √area of B; with the most confident of them.
fn surroundings(a: &PreparedShape, b: &PreparedShape, found: &Match, [i, j]: [u32; 2]) -> (f64, f32) {
    let (on_a, on_b) = (a.shape.points(), b.shape.points());
    let near = (0..on_a.len()).filter(|&n| distance(on_a[n], on_a[i as usize]) < 0.05 * a.info.scale);
    near.filter(|&n| n != i as usize).fold((0.0, 0.0), |(away, sure), n| {
        let off = distance(on_b[found.a_to_b.target[n] as usize], on_b[j as usize]) / b.info.scale;
        (off.max(away), found.a_to_b.confidence[n].max(sure))
    })
}

#[test]
fn what_lies_around_landmarks_goes_where_they_say() {
    let [a, b] = &*PAIR;
    // The left hand of A is to be the right hand of B, and so on: the map that the network would never choose.
    let exchanged = [("left hand", "right hand"), ("right hand", "left hand"), ("left foot", "right foot")];
    let landmarks: Vec<[u32; 2]> = exchanged.iter().map(|&(on_a, on_b)| [tip(a, on_a), tip(b, on_b)]).collect();
    for refine in [Refinement::ZoomOut, Refinement::Best] {
        let found = matched(a, b, &MatchOptions { landmarks: landmarks.clone(), refine, ..Default::default() });
        let off = landmarks.iter().map(|&pair| surroundings(a, b, &found, pair).0).collect::<Vec<f64>>();
        println!("{refine:?}: {off:?}; weights {:?}; {:?}", found.weights, found.warnings);
        assert!(landmarks.iter().all(|&[i, j]| found.a_to_b.target[i as usize] == j), "the landmarks themselves");
        assert!(off.iter().all(|&off| off < 0.1), "{refine:?}: {off:?}");
    }
}

#[test]
fn a_landmark_that_nothing_follows_leaves_no_confidence_around_it() {
    let [a, b] = &*PAIR;
    for pair in [[tip(a, "head"), tip(b, "left foot")], [tip(a, "left hand"), tip(b, "torso")]] {
        let found = matched(a, b, &MatchOptions { landmarks: vec![pair], ..Default::default() });
        let (away, sure) = surroundings(a, b, &found, pair);
        println!("{pair:?}: {away:.3} away, confidence up to {sure:.2}; {:?}", found.warnings);
        assert!(away < 0.1 || sure < 0.5, "{pair:?}: {away} {sure}");
        assert!(
            found.warnings.iter().any(|warning| warning.message.contains("a landmark joins")),
            "{:?}",
            found.warnings
        );
        assert_eq!(found.a_to_b.target[pair[0] as usize], pair[1]);
    }
}

#[test]
fn landmarks_choose_among_the_maps_of_a_symmetric_shape() {
    // An ellipsoid turns onto itself four ways. No description tells them apart; two landmarks do.
    let ellipsoid = icosphere(3).moved(|[x, y, z]| [2.2 * x, 1.5 * y, z]);
    let shape = prepared(ellipsoid.shape(), &quick());
    let nearest = |p: [f64; 3]| {
        let near = |i: &usize| distance(ellipsoid.points[*i], p);
        (0..ellipsoid.points.len()).min_by(|i, j| near(i).total_cmp(&near(j))).expect("points") as u32
    };
    for turn in [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]] {
        let image = |p: [f64; 3]| [p[0] * turn[0], p[1] * turn[1], p[2] * turn[2]];
        let landmarks = [[1.9, 0.7, 0.3], [-0.6, 1.3, 0.5], [0.4, -0.5, 0.9]].map(|p| [nearest(p), nearest(image(p))]);
        let found = matched(&shape, &shape, &MatchOptions { landmarks: landmarks.to_vec(), ..Default::default() });
        let off: f64 = (0..642)
            .map(|i| {
                let found = ellipsoid.points[found.a_to_b.target[i] as usize];
                distance(found, image(ellipsoid.points[i])) / 642.0
            })
            .sum();
        println!("turned by {turn:?}: {off:.3} off on average");
        assert!(off < 0.2, "turned by {turn:?}: {off}");
    }
}

#[test]
fn a_landmark_is_kept_even_where_the_rest_disagrees() {
    let [a, b] = &*PAIR;
    let found = matched(a, b, &MatchOptions { landmarks: vec![[100, 3000]], ..Default::default() });
    assert_eq!((found.a_to_b.target[100], found.b_to_a.target[3000]), (3000, 100));
}

#[test]
fn landmarks_do_not_hurt_a_pair_that_matches_anyway() {
    let [a, b] = &*PAIR;
    let without = error(&matched(a, b, &MatchOptions::default()).a_to_b.target, &b.shape);
    let landmarks = [3, 777, 1500, 2222, 3100, 4040, 4900].map(|i| [i, i]).to_vec();
    let found = matched(a, b, &MatchOptions { landmarks, ..Default::default() });
    let with = error(&found.a_to_b.target, &b.shape);
    println!("error without landmarks {without:.2}, with seven {with:.2}");
    assert!(with < without + 0.3, "{with} {without}");
}
