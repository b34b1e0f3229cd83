//! Functional maps go the way their name says, come out of the solve as they went in, and keep left, right and parts apart.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::sync::LazyLock;

use geose_fmap::maps::FunctionalMap;
use geose_fmap::pipeline::match_shapes;
use geose_fmap::uses::{EdgeDistances, mean_error};
use geose_fmap::{
    FaceUse, LaplacianKind, Match, MatchOptions, Parts, PrepareOptions, PreparedShape, Progress, Refinement, Shape,
};
use ndarray::{Array1, Array2, Axis};
use shapes::{Random, blob, body, prepared, soup};

/// 60 eigenpairs and 1500 points are enough for the truths here.
fn quick() -> PrepareOptions {
    PrepareOptions { points: 1500, eigenpairs: 60, ..Default::default() }
}

/// Two people in different poses whose vertices correspond by index; the second in centimetres.
static PAIR: LazyLock<[PreparedShape; 2]> = LazyLock::new(|| {
    let man = body("man-lunging.ply");
    let labels = man.labels().map(<[u32]>::to_vec);
    let man = soup(&man).moved(|p| p.map(|x| 100.0 * x));
    let man = Shape::new(man.points, man.faces, labels).expect("a valid shape");
    [prepared(body("woman-standing.ply"), &quick()), prepared(man, &quick())]
});

static FOUND: LazyLock<Match> = LazyLock::new(|| matched(&PAIR[0], &PAIR[1], &MatchOptions::default()));

fn matched(a: &PreparedShape, b: &PreparedShape, options: &MatchOptions) -> Match {
    match_shapes(a, b, options, &mut Progress::silent()).expect("a match")
}

/// Error (×100/√area) of a map whose truth is "same index".
fn error(target: &[u32], on: &Shape) -> f64 {
    let pairs: Vec<_> = target.iter().copied().zip(0..).collect();
    mean_error(&EdgeDistances::new(on), &pairs)
}

/// Correlation of two functions on a shape, under its mass.
fn correlation(f: &Array1<f64>, g: &Array1<f64>, mass: &Array1<f64>) -> f64 {
    let centred = |f: &Array1<f64>| f - (f * mass).sum() / mass.sum();
    let (f, g) = (centred(f), centred(g));
    let product = |f: &Array1<f64>, g: &Array1<f64>| (f * g * mass).sum();
    product(&f, &g) / (product(&f, &f) * product(&g, &g)).sqrt()
}

#[test]
fn c_ab_takes_functions_on_a_to_functions_on_b() {
    let [a, b] = &*PAIR;
    let transported = |from: &PreparedShape, to: &PreparedShape, c: &FunctionalMap, f: &Array1<f64>| {
        let coefficients = from.basis.project(f.view().insert_axis(Axis(1)));
        to.basis.reconstruct(c.matrix.dot(&coefficients).view()).index_axis_move(Axis(1), 0)
    };
    let indicator = |shape: &PreparedShape, part: u32| -> Array1<f64> {
        shape.shape.labels().expect("labels").iter().map(|&l| if l == part { 1.0 } else { 0.0 }).collect()
    };
    // Head, left forearm, right hand, left thigh, right foot: of A on B, and of B on A, smooth as 60 eigenfunctions make them.
    let mut losses = vec![];
    for part in [0, 4, 7, 8, 13] {
        let (on_a, on_b) = (indicator(a, part), indicator(b, part));
        let right = correlation(&transported(a, b, &FOUND.c_ab, &on_a), &on_b, &b.basis.mass);
        let wrong = correlation(&transported(a, b, &FOUND.c_ba, &on_a), &on_b, &b.basis.mass);
        let back = correlation(&transported(b, a, &FOUND.c_ba, &on_b), &on_a, &a.basis.mass);
        println!("part {part}: C_ab A → B {right:.2}, C_ba B → A {back:.2}, C_ba used as A → B {wrong:.2}");
        // What the 60 eigenfunctions keep of the part itself is the most there can be.
        let most = b.basis.reconstruct(b.basis.project(on_b.view().insert_axis(Axis(1))).view());
        let most = correlation(&most.index_axis_move(Axis(1), 0), &on_b, &b.basis.mass);
        assert!(right > 0.9 * most && back > 0.85 * most, "part {part}: {right} and {back} of {most}");
        losses.push(right - wrong);
    }
    // The two maps differ most in the high frequencies, so small and far parts tell them apart best.
    let most = losses.iter().copied().fold(0.0, f64::max);
    assert!(most > 0.3 && losses.iter().all(|&loss| loss > 0.0), "the other direction is another map: {losses:?}");
    // Constants go to the same constants, whatever the units: metres on one side, centimetres on the other.
    let one = Array1::ones(a.basis.len());
    for value in transported(a, b, &FOUND.c_ab, &one) {
        assert!((value - 1.0).abs() < 0.05, "the constant 1 becomes {value}");
    }
}

#[test]
fn target_of_goes_from_a_to_b() {
    let [a, b] = &*PAIR;
    let errors = [error(&FOUND.a_to_b.target, &b.shape), error(&FOUND.b_to_a.target, &a.shape)];
    println!("woman standing → man lunging {:.2}, back {:.2} (1500 points, 60 eigenpairs)", errors[0], errors[1]);
    // Samples are 2.6 apart; a map of the wrong direction, or mirrored, is beyond 20.
    assert!(errors.iter().all(|&e| e < 8.0), "{errors:?}");

    // Indices of a map cannot be told from those of its inverse on one numbering; on another they can.
    let order = Random(8).permutation(642);
    let [one, other] = [blob(3), blob(3).renumbered(&order)].map(|s| prepared(s.shape(), &quick()));
    let found = matched(&one, &other, &MatchOptions::default());
    let right = (0..642).filter(|&i| found.a_to_b.target[i] == order[i]).count();
    let back = (0..642).filter(|&i| found.b_to_a.target[order[i] as usize] == i as u32).count();
    assert_eq!((right, back), (642, 642));
}

/// Coefficients of c random descriptors (k, c).
fn descriptors(k: usize, c: usize) -> Array2<f64> {
    let mut random = Random(6);
    Array2::from_shape_fn((k, c), |_| random.sign())
}

#[test]
fn solve_recovers_a_diagonal_map() {
    let k = 30;
    let lambda: Array1<f64> = (0..k).map(|i| i as f64 * 12.5).collect();
    let mut random = Random(2);
    let signs: Array1<f64> = (0..k).map(|_| random.sign().signum()).collect();
    let truth = Array2::from_diag(&signs);
    let g_a = descriptors(k, 40);
    let g_b = truth.dot(&g_a);
    let found = FunctionalMap::solve(g_a.view(), g_b.view(), lambda.view(), lambda.view());
    // Equal eigenvalues are not held back by the mask; what is left is the 1e-9 of the solve.
    let worst = (&found.matrix - &truth).iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert!(worst < 1e-6, "{worst}");
}

#[test]
fn solve_recovers_a_permuted_map_and_its_transpose_the_other_way() {
    let k = 24;
    let lambda_a: Array1<f64> = (0..k).map(|i| (i * i) as f64).collect();
    let order = Random(5).permutation(k);
    let mut truth = Array2::zeros((k, k));
    let mut lambda_b = Array1::zeros(k);
    for (j, &i) in order.iter().enumerate() {
        truth[(i as usize, j)] = 1.0;
        lambda_b[i as usize] = lambda_a[j];
    }
    let g_a = descriptors(k, 30);
    let g_b = truth.dot(&g_a);
    let solve = |from: (&Array2<f64>, &Array1<f64>), to: (&Array2<f64>, &Array1<f64>)| {
        FunctionalMap::solve(from.0.view(), to.0.view(), from.1.view(), to.1.view()).matrix
    };
    let there = solve((&g_a, &lambda_a), (&g_b, &lambda_b));
    let back = solve((&g_b, &lambda_b), (&g_a, &lambda_a));
    let worst = |m: &Array2<f64>| m.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert!(worst(&(&there - &truth)) < 1e-6 && worst(&(&back - &truth.t())) < 1e-6);
}

#[test]
fn solve_between_bases_of_different_size_has_a_row_per_function_on_b() {
    let (k_a, k_b) = (12, 20);
    let (lambda_a, lambda_b): (Array1<f64>, Array1<f64>) =
        ((0..k_a).map(|i| i as f64).collect(), (0..k_b).map(|i| i as f64).collect());
    let (g_a, g_b) = (descriptors(k_a, 25), descriptors(k_b, 25));
    let found = FunctionalMap::solve(g_a.view(), g_b.view(), lambda_a.view(), lambda_b.view());
    assert_eq!(found.matrix.dim(), (k_b, k_a));
    assert!(found.matrix.iter().all(|v| v.is_finite()));
}

#[test]
fn solve_without_any_descriptor_is_no_map() {
    let lambda: Array1<f64> = (0..10).map(f64::from).collect();
    let none = Array2::zeros((10, 5));
    let found = FunctionalMap::solve(none.view(), none.view(), lambda.view(), lambda.view());
    assert!(found.matrix.iter().all(|&v| v == 0.0));
}

/// Share of the points of sided parts that go to the same side, and to the other.
fn sides(target: &[u32], labels: &[u32]) -> [f64; 2] {
    // Labels 2, 3, 4, … are left upper arm, right upper arm, left forearm, …
    let sided: Vec<(u32, u32)> =
        target.iter().zip(labels).filter(|&(_, &l)| l >= 2).map(|(&t, &l)| (labels[t as usize], l)).collect();
    let share = |count: usize| count as f64 / sided.len() as f64;
    let same = sided.iter().filter(|&&(t, l)| t >= 2 && t % 2 == l % 2).count();
    let other = sided.iter().filter(|&&(t, l)| t >= 2 && t % 2 != l % 2).count();
    [share(same), share(other)]
}

#[test]
fn a_mirrored_body_is_not_matched_as_itself_but_with_its_sides_exchanged() {
    // A body in a mirror has its heart on the right: its left arm, number for number, is a right arm to look at. By descriptors alone it is itself.
    for file in shapes::BODIES {
        let original = body(file);
        let labels = original.labels().expect("labels").to_vec();
        let [original, mirror] = [soup(&original), soup(&original).mirrored()].map(|s| prepared(s.shape(), &quick()));
        let [same, other] = sides(&matched(&mirror, &original, &MatchOptions::default()).a_to_b.target, &labels);
        println!(
            "{file} in a mirror: {:.1} % of the limbs as themselves, {:.1} % exchanged",
            100.0 * same,
            100.0 * other
        );
        assert!(same < 0.05 && other > 0.9, "{file}: {same} {other}");
        let [same, other] = sides(&matched(&original, &original, &MatchOptions::default()).a_to_b.target, &labels);
        assert!(same > 0.99 && other < 0.01, "{file} with itself: {same} {other}");
    }
}

#[test]
fn a_mirrored_cloud_is_matched_with_its_sides_exchanged() {
    for file in shapes::BODIES {
        let original = body(file);
        let labels = original.labels().expect("labels").to_vec();
        let clouds = [soup(&original), soup(&original).mirrored()].map(|s| prepared(s.cloud().shape(), &quick()));
        let [original, mirror] = &clouds;
        let found = matched(mirror, original, &MatchOptions::default());
        let [same, other] = sides(&found.a_to_b.target, &labels);
        println!("{file} in a mirror, as a cloud: {same:.3} as themselves, {other:.3} exchanged");
        assert!(same < 0.05 && other > 0.9, "{file}: {same} {other}");
    }
}

#[test]
fn given_parts_are_a_wall() {
    let [a, b] = &*PAIR;
    let options = MatchOptions { parts: Parts::Given, ..Default::default() };
    let found = matched(a, b, &options);
    let (labels_a, labels_b) = (a.shape.labels().expect("labels"), b.shape.labels().expect("labels"));
    // Points that take part keep their label; the others follow the nearest that does, which may lie over a border.
    let mut over = [0, 0];
    for row in 0..a.points_used() {
        let i = a.support.uploaded(row);
        over[0] += usize::from(labels_a[i] != labels_b[found.a_to_b.target[i] as usize]);
    }
    for row in 0..b.points_used() {
        let i = b.support.uploaded(row);
        over[1] += usize::from(labels_b[i] != labels_a[found.b_to_a.target[i] as usize]);
    }
    assert_eq!(over, [0, 0]);
    let errors = [&FOUND, &found].map(|m| error(&m.a_to_b.target, &b.shape));
    println!("error without parts {:.2}, with {:.2}", errors[0], errors[1]);
    assert!(errors[1] < errors[0] + 0.3, "labels do not hurt: {errors:?}");
}

#[test]
fn labels_that_are_wrong_are_a_wall_all_the_same() {
    let shape = body("woman-standing.ply");
    let true_labels = shape.labels().expect("labels").to_vec();
    // Ten points of the head are called a foot.
    let (head, foot) = (true_labels[top_of(&shape)], true_labels[lowest_of(&shape)]);
    let mut labels = true_labels.clone();
    labels.iter_mut().filter(|label| **label == head).take(10).for_each(|label| *label = foot);
    let noisy = Shape::new(shape.points().to_vec(), shape.faces().to_vec(), Some(labels.clone())).expect("a shape");
    let whole = PrepareOptions { eigenpairs: 60, ..Default::default() };
    let (a, b) = (prepared(noisy, &whole), prepared(shape, &whole));
    for refine in [Refinement::None, Refinement::ZoomOut, Refinement::Best] {
        let found = matched(&a, &b, &MatchOptions { parts: Parts::Given, refine, ..Default::default() });
        let over = (0..5000).filter(|&i| labels[i] != true_labels[found.a_to_b.target[i] as usize]).count();
        assert_eq!(over, 0, "{refine:?}");
    }
}

fn top_of(shape: &Shape) -> usize {
    (0..shape.points().len()).max_by(|&i, &j| shape.points()[i][1].total_cmp(&shape.points()[j][1])).expect("points")
}

fn lowest_of(shape: &Shape) -> usize {
    (0..shape.points().len()).min_by(|&i, &j| shape.points()[i][1].total_cmp(&shape.points()[j][1])).expect("points")
}

#[test]
fn a_label_per_point_costs_no_more_than_one_for_all() {
    let shape = body("woman-standing.ply");
    let own = Shape::new(shape.points().to_vec(), shape.faces().to_vec(), Some((0..5000).collect())).expect("a shape");
    let shape = prepared(own, &PrepareOptions { eigenpairs: 60, ..Default::default() });
    let found = matched(&shape, &shape, &MatchOptions { parts: Parts::Given, ..Default::default() });
    assert!(found.a_to_b.target.iter().zip(0..).all(|(&j, i)| i == j));
}

#[test]
fn parts_that_only_one_scan_has_are_no_constraint() {
    let ball = blob(2);
    let labelled = |labels: Vec<u32>| {
        prepared(Shape::new(ball.points.clone(), ball.faces.clone(), Some(labels)).expect("a valid shape"), &quick())
    };
    let a = labelled((0..162).map(|i| if ball.points[i][0] > 0.0 { 1 } else { 2 }).collect());
    let b = labelled((0..162).map(|i| if ball.points[i][0] > 0.0 { 1 } else { 7 }).collect());
    let found = matched(&a, &b, &MatchOptions { parts: Parts::Given, ..Default::default() });
    let right = (0..162).filter(|&i| found.a_to_b.target[i as usize] == i).count();
    assert!(right > 155, "{right} of 162 points right");
}

#[test]
fn no_step_of_refinement_spoils_the_one_before() {
    let [a, b] = &*PAIR;
    let [none, zoomed] = [Refinement::None, Refinement::ZoomOut].map(|refine| {
        let found = matched(a, b, &MatchOptions { refine, ..Default::default() });
        error(&found.a_to_b.target, &b.shape)
    });
    let best = error(&FOUND.a_to_b.target, &b.shape);
    println!("error none {none:.2}, zoomout {zoomed:.2}, best {best:.2}");
    assert!(zoomed < none + 0.5 && best < zoomed + 0.2, "{none} {zoomed} {best}");
}

#[test]
fn the_best_refinement_is_better_than_zoomout_on_people() {
    let options = [PrepareOptions::default(), PrepareOptions { faces: FaceUse::Ignore, ..Default::default() }];
    for ((file, other), options) in
        [("woman-standing.ply", "man-lunging.ply"), ("man-standing.ply", "man-lunging.ply")].into_iter().zip(options)
    {
        let (a, b) = (prepared(body(file), &options), prepared(body(other), &options));
        let [zoomed, best] = [Refinement::ZoomOut, Refinement::Best].map(|refine| {
            let found = matched(&a, &b, &MatchOptions { refine, ..Default::default() });
            error(&found.a_to_b.target, &body(other))
        });
        println!("{file} → {other}: zoomout {zoomed:.2}, best {best:.2}");
        assert!(best < zoomed, "{file} → {other}: {zoomed} {best}");
    }
}

#[test]
fn turning_a_body_changes_no_match_and_neither_does_trying_again() {
    let [a, b] = &*PAIR;
    let again = matched(a, b, &MatchOptions::default());
    assert_eq!((&again.a_to_b, &again.b_to_a), (&FOUND.a_to_b, &FOUND.b_to_a));
    for options in [quick(), PrepareOptions { faces: FaceUse::Ignore, ..quick() }] {
        let [woman, man] = [body("woman-standing.ply"), body("man-lunging.ply")];
        let [a, b, lying] =
            [woman.clone(), man.clone(), soup(&man).moved(shapes::turn).shape()].map(|s| prepared(s, &options));
        let [upright, turned] = [&b, &lying].map(|b| matched(&a, b, &MatchOptions::default()));
        let same = upright.a_to_b.target.iter().zip(&turned.a_to_b.target).filter(|(x, y)| x == y).count();
        println!("{same} of 5000 points go to the same point of a body turned");
        assert!(same > 4900, "{same}");
    }
}

#[test]
fn confidence_is_high_where_there_and_back_ends_at_home() {
    let confident = FOUND.a_to_b.confidence.iter().filter(|&&c| c > 0.5).count();
    assert!(confident > 4000, "{confident} of 5000");
    let blob = prepared(blob(3).shape(), &quick());
    let itself = matched(&blob, &blob, &MatchOptions::default());
    assert!(itself.a_to_b.confidence.iter().all(|&c| c > 0.95));
}

#[test]
fn bases_of_different_size_use_the_smaller_and_say_so() {
    let shape = blob(2).shape();
    let [few, more] = [20, 40].map(|eigenpairs| {
        let kind = Some(LaplacianKind::Euclidean);
        prepared(shape.clone(), &PrepareOptions { eigenpairs, laplacian: kind, ..quick() })
    });
    let found = matched(&few, &more, &MatchOptions::default());
    assert_eq!((found.c_ab.matrix.dim(), found.c_ba.matrix.dim()), ((20, 20), (20, 20)));
    assert!(found.warnings.iter().any(|w| w.message.contains("20 and 40")), "{:?}", found.warnings);
}

#[test]
fn without_the_network_the_scale_of_an_operator_changes_no_map() {
    // An operator whose eigenvalues are all half as large again, as one on a cloud may have them: by Weyl's law that is its own affair.
    let shape = PreparedShape { embeddings: Vec::new(), ..prepared(blob(3).shape(), &quick()) };
    let mut scaled = shape.clone();
    scaled.basis.eigenvalues *= 1.5;
    let options = MatchOptions { refine: Refinement::None, ..Default::default() };
    let [expected, found] = [&shape, &scaled].map(|other| matched(&shape, other, &options).c_ab.matrix);
    let most = (&expected - &found).iter().fold(0.0_f64, |most, d| most.max(d.abs()));
    assert!(most < 1e-9, "{most:e}");
}
