//! A piece of a body is taken for what it is: how much of a body, at which scale, and which points of the other scan have a partner on it.

mod shapes;

use geose_fmap::pipeline::{ScaleSource, ShapeKind};
use geose_fmap::{FaceUse, LaplacianKind, MatchOptions, Matcher, PrepareOptions, PreparedShape, Shape, UNMATCHED};

use shapes::{Random, body, distance};

/// Labels of the sample bodies from here on are those of legs.
const LEGS: u32 = 8;

/// A face's normal, twice as long as its area is large.
fn normal(whole: &Shape, face: &[u32; 3]) -> [f64; 3] {
    let [p, q, r] = face.map(|v| whole.points()[v as usize]);
    let [u, v]: [[f64; 3]; 2] = [q, r].map(|x| std::array::from_fn(|c| x[c] - p[c]));
    std::array::from_fn(|c| u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3])
}

/// The share of a body's area that is not legs.
fn upper_share(whole: &Shape) -> f64 {
    let area = |faces: &mut dyn Iterator<Item = &[u32; 3]>| -> f64 {
        faces.map(|face| distance(normal(whole, face), [0.0; 3])).sum()
    };
    let labels = whole.labels().expect("labels");
    let upper = |face: &&[u32; 3]| face.iter().all(|&v| labels[v as usize] < LEGS);
    area(&mut whole.faces().iter().filter(upper)) / area(&mut whole.faces().iter())
}

/// What has no legs, `scale` times as large, and which points of the whole these are.
fn upper(whole: &Shape, scale: f64) -> (Shape, Vec<u32>) {
    let labels = whole.labels().expect("labels");
    piece(whole, scale, |face| face.iter().all(|&v| labels[v as usize] < LEGS))
}

/// The faces that are `wanted`, `scale` times as large, and which points of the whole theirs are.
fn piece(whole: &Shape, scale: f64, wanted: impl Fn(&[u32; 3]) -> bool) -> (Shape, Vec<u32>) {
    let faces = whole.faces().iter().filter(|face| wanted(face));
    let mut kept: Vec<u32> = faces.clone().flatten().copied().collect();
    kept.sort_unstable();
    kept.dedup();
    let row = |v: u32| kept.binary_search(&v).expect("kept") as u32;
    let faces = faces.map(|face| face.map(row)).collect();
    let points = kept.iter().map(|&v| whole.points()[v as usize].map(|x| scale * x)).collect();
    (Shape::new(points, faces, None).expect("a piece"), kept)
}

fn prepared(matcher: &Matcher, shape: Shape) -> PreparedShape {
    matcher.prepare(shape, &PrepareOptions { points: 1500, ..PrepareOptions::default() }).expect("prepared")
}

#[test]
fn half_a_body_is_matched_at_the_size_of_the_whole() {
    let whole = body("woman-standing.ply");
    let share = upper_share(&whole);
    let matcher = Matcher::new();
    let (piece, kept) = upper(&whole, 2.0);
    let (a, b) = (prepared(&matcher, piece), prepared(&matcher, whole.clone()));
    // How much of a body it is the network says roughly; the match corrects it.
    assert!((a.info.share / share).ln().abs() < 0.3, "{} {share}", a.info.share);
    assert!((a.info.scale / b.info.scale / 2.0).ln().abs() < 0.15, "{} {}", a.info.scale, b.info.scale);
    assert_eq!((b.info.share, b.extent()), (1.0, None));
    let extent = a.extent().expect("a piece");
    assert!(extent.contains(" % of a body: head, torso, left arm, right arm"), "{extent}");
    assert!(!extent.contains("shank"), "{extent}");

    let matched = matcher.match_shapes(&a, &b, &MatchOptions::default()).expect("matched");
    assert_eq!(matched.scale.found, ScaleSource::Match);
    assert!((matched.scale.ratio / 2.0 - 1.0).abs() < 0.06, "{:?}", matched.scale);
    // Whatever is on the piece is on the whole.
    assert!(matched.overlap[0].iter().all(|&overlap| overlap == 1.0));
    let near = |(i, &target): (usize, &u32)| {
        let right = whole.points()[kept[i] as usize];
        target != UNMATCHED && distance(whole.points()[target as usize], right) < 0.1
    };
    let right = matched.a_to_b.target.iter().enumerate().filter(|&found| near(found)).count();
    assert!(right as f64 > 0.8 * kept.len() as f64, "{right} of {}", kept.len());
    // And the legs of the whole have no partner.
    let labels = whole.labels().expect("labels");
    let alone = |legs: bool| {
        let of = matched.b_to_a.target.iter().zip(labels).filter(|(_, label)| (**label >= LEGS) == legs);
        let (all, alone) = of.fold((0, 0), |(all, alone), (&t, _)| (all + 1, alone + u32::from(t == UNMATCHED)));
        f64::from(alone) / f64::from(all)
    };
    assert!(alone(true) > 0.6 && alone(false) < 0.1, "{} {}", alone(true), alone(false));
    let said = |code: &str| matched.warnings.iter().any(|warning| warning.code == code);
    assert!(!said("lengths-changed") && !said("out-of-distribution"), "{:?}", matched.warnings);
}

/// Of the points with a partner the share that goes to the part with their label, and of those with labels that are `lost` and of the others the share left alone.
fn by_labels(targets: &[u32], from: &[u32], to: &[u32], lost: impl Fn(u32) -> bool) -> [f64; 3] {
    let share = |wanted: &dyn Fn(u32) -> bool, found: &dyn Fn(u32, u32) -> bool| {
        let of = targets.iter().zip(from).filter(|(_, label)| wanted(**label));
        let (all, found) = of.fold((0, 0), |(all, sum), (&t, &l)| (all + 1, sum + u32::from(found(t, l))));
        f64::from(found) / f64::from(all)
    };
    let same = share(&|label| !lost(label), &|t, label| t != UNMATCHED && to[t as usize] == label);
    let alone = |t: u32, _: u32| t == UNMATCHED;
    [same, share(&lost, &alone), share(&|label| !lost(label), &alone)]
}

#[test]
fn a_turned_bust_and_another_body_are_matched_either_way_round() {
    // Another person in another pose, as a cloud that was turned.
    let [woman, man] = ["woman-standing.ply", "man-lunging.ply"].map(body);
    let (bust, kept) = upper(&woman, 1.0);
    let turned = bust.points().iter().map(|&[x, y, z]| [0.6 * x - 0.8 * z, 0.8 * x + 0.6 * z, -y]).collect();
    let labels = |shape: &Shape| shape.labels().expect("labels").to_vec();
    let (of_woman, of_man) = (labels(&woman), labels(&man));
    let of_bust: Vec<u32> = kept.iter().map(|&v| of_woman[v as usize]).collect();
    let matcher = Matcher::new();
    let cloud = man.clone().without_faces();
    let [a, b, cloud] =
        [Shape::new(turned, Vec::new(), None).expect("a cloud"), man, cloud].map(|shape| prepared(&matcher, shape));
    assert!(a.info.share < 0.8 && b.info.share == 1.0, "{} {}", a.info.share, b.info.share);
    for (first, second) in [(&a, &b), (&b, &a)] {
        let matched = matcher.match_shapes(first, second, &MatchOptions::default()).expect("matched");
        let [there, back] = [&matched.a_to_b.target, &matched.b_to_a.target];
        let [to_man, to_bust] = if first.info.share < 1.0 { [there, back] } else { [back, there] };
        let [same, ..] = by_labels(to_man, &of_bust, &of_man, |_| false);
        let [same_back, legs_alone, others_alone] = by_labels(to_bust, &of_man, &of_bust, |label| label >= LEGS);
        assert!(same > 0.85 && same_back > 0.75, "{same} {same_back}");
        assert!(legs_alone > 0.6 && others_alone < 0.15, "{legs_alone} {others_alone}");
        let codes: Vec<&str> = matched.warnings.iter().map(|warning| &*warning.code).collect();
        assert!(codes.is_empty(), "whoever is first, what has no partner is no reason for doubt: {codes:?}");
    }
    // A mesh without borders lacks nothing; of a cloud that looks whole that is likely, and not certain.
    assert_eq!(cloud.info.share, 1.0);
    let [of_mesh, of_cloud] = [&b, &cloud].map(|whole| {
        let matched = matcher.match_shapes(&a, whole, &MatchOptions::default()).expect("matched");
        let left = matched.a_to_b.target.iter().filter(|&&target| target == UNMATCHED).count();
        (matched.overlap[0].iter().filter(|&&overlap| overlap < 1.0).count(), left as f64 / kept.len() as f64)
    });
    assert_eq!(of_mesh, (0, 0.0));
    assert!(of_cloud.0 > 0 && of_cloud.1 < 0.05, "{of_cloud:?}");
}

#[test]
fn two_pieces_are_matched_where_both_are_there() {
    // One without legs, and one without what is above the waist but the torso and an arm.
    let [woman, man] = ["woman-standing.ply", "man-lunging.ply"].map(body);
    let on = |shape: &Shape, wanted: &dyn Fn(u32) -> bool| {
        let labels = shape.labels().expect("labels").to_vec();
        let (piece, kept) = piece(shape, 1.0, |face| face.iter().all(|&v| wanted(labels[v as usize])));
        (piece, kept.iter().map(|&v| labels[v as usize]).collect::<Vec<u32>>())
    };
    let lacks = |label: u32| [0, 2, 4, 6].contains(&label);
    let (above, of_above) = on(&woman, &|label| label < LEGS);
    let (below, of_below) = on(&man, &|label| !lacks(label));
    let matcher = Matcher::new();
    let [a, b] = [above, below].map(|shape| prepared(&matcher, shape));
    let matched = matcher.match_shapes(&a, &b, &MatchOptions::default()).expect("matched");
    let [same, alone, others] = by_labels(&matched.a_to_b.target, &of_above, &of_below, lacks);
    let [same_back, legs_alone, others_back] =
        by_labels(&matched.b_to_a.target, &of_below, &of_above, |label| label >= LEGS);
    println!("{} {}: {same} {alone} {others}, {same_back} {legs_alone} {others_back}", a.info.share, b.info.share);
    assert!(same > 0.7 && same_back > 0.7, "{same} {same_back}");
    assert!(
        alone > 0.5 && legs_alone > 0.5 && others < 0.2 && others_back < 0.2,
        "{alone} {legs_alone} {others} {others_back}"
    );
}

#[test]
fn what_a_nearly_whole_body_lacks_has_no_partner_on_it() {
    // A body that has lost a forearm is whole to the network. Beside a piece that has it, it is known to have borders.
    let whole = body("woman-standing.ply");
    let labels = whole.labels().expect("labels");
    let lost = |v: u32| [4, 6].contains(&labels[v as usize]);
    let (piece, kept) = upper(&whole, 1.0);
    let (nearly, _) = self::piece(&whole, 1.0, |face| !face.iter().any(|&v| lost(v)));
    let matcher = Matcher::new();
    let (a, b) = (prepared(&matcher, piece), prepared(&matcher, nearly));
    assert!(a.info.share < 1.0 && b.info.share == 1.0, "{} {}", a.info.share, b.info.share);
    let matched = matcher.match_shapes(&a, &b, &MatchOptions::default()).expect("matched");
    let alone = |is_lost: bool| {
        let of = kept.iter().zip(&matched.a_to_b.target).filter(|(v, _)| lost(**v) == is_lost);
        let (all, alone) = of.fold((0, 0), |(all, alone), (_, &t)| (all + 1, alone + u32::from(t == UNMATCHED)));
        f64::from(alone) / f64::from(all)
    };
    assert!(alone(true) > 0.5 && alone(false) < 0.1, "{} {}", alone(true), alone(false));
}

#[test]
fn a_mesh_has_borders_where_it_ends_and_not_along_a_seam() {
    let whole = body("woman-standing.ply");
    let (bust, _) = upper(&whole, 1.0);
    // Every face has three vertices of its own, as a file with a texture may have them along its seams.
    let corners = whole.faces().iter().flatten().map(|&v| whole.points()[v as usize]).collect();
    let faces = (0..whole.faces().len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let seamed = Shape::new(corners, faces, None).expect("a mesh");
    let few = PrepareOptions { points: 400, share: Some(1.0), whole_scan: true, ..PrepareOptions::default() };
    let cloud = PrepareOptions { faces: FaceUse::Ignore, ..few.clone() };
    let borders = |shape: &Shape, options: &PrepareOptions| {
        Matcher::new().prepare(shape.clone(), options).expect("prepared").info.borders
    };
    assert!(borders(&bust, &few) && !borders(&bust, &cloud));
    assert!(!borders(&whole, &few) && !borders(&seamed, &few));
}

#[test]
fn who_knows_how_much_of_a_body_it_is_says_so() {
    let whole = body("woman-standing.ply");
    let share = upper_share(&whole);
    let matcher = Matcher::new();
    let (piece, _) = upper(&whole, 1.0);
    let known = |share: f64| PrepareOptions { points: 1500, share: Some(share), ..PrepareOptions::default() };
    let [b, right, taken_for_whole] = [(&whole, 1.0), (&piece, share), (&piece, 1.0)]
        .map(|(shape, share)| matcher.prepare(shape.clone(), &known(share)).expect("prepared"));
    assert_eq!((right.info.share, taken_for_whole.info.share), (share, 1.0));
    assert!((right.info.scale / b.info.scale).ln().abs() < 0.02, "{} {}", right.info.scale, b.info.scale);
    assert!((taken_for_whole.info.scale / right.info.scale - share.sqrt()).abs() < 1e-9);
    assert!(
        matcher
            .prepare(whole, &known(0.01))
            .is_err_and(|error| error.to_string().contains("share must be between 0.05 and 1"))
    );
}

#[test]
fn fragments_of_one_view_are_no_other_things() {
    // Seen from behind, and something hides a stripe below the knees: the feet are fragments of their own.
    let whole = body("woman-standing.ply");
    let heights = || whole.points().iter().map(|point| point[1]);
    let (low, high) = (heights().fold(f64::MAX, f64::min), heights().fold(f64::MIN, f64::max));
    let height = |v: u32| (whole.points()[v as usize][1] - low) / (high - low);
    let seen = |face: &[u32; 3]| {
        let normal = normal(&whole, face);
        let middle = face.iter().map(|&v| height(v)).sum::<f64>() / 3.0;
        normal[2] < -0.15 * distance(normal, [0.0; 3]) && (middle - 0.25).abs() >= 0.02
    };
    let (view, kept) = piece(&whole, 1.0, seen);
    let matcher = Matcher::new();
    let (a, b) = (prepared(&matcher, view), prepared(&matcher, whole.clone()));
    assert!(a.info.share < 1.0 && a.repairs.iter().all(|repair| repair.code != "others-set-aside"), "{:?}", a.repairs);
    let matched = matcher.match_shapes(&a, &b, &MatchOptions::default()).expect("matched");
    let below = || kept.iter().zip(&matched.a_to_b.target).filter(|(v, _)| height(**v) < 0.2);
    let right = below().filter(|(_, target)| **target != UNMATCHED && height(**target) < 0.25).count();
    assert!(below().count() > 100 && right as f64 > 0.7 * below().count() as f64, "{right} of {}", below().count());
}

#[test]
fn a_mesh_full_of_holes_is_taken_as_a_cloud_where_that_looks_more_like_a_body() {
    let whole = body("man-lunging.ply");
    let mut random = Random(2);
    let mut middle = || whole.points()[(random.bits() % whole.points().len() as u64) as usize];
    let middles: Vec<[f64; 3]> = (0..13).map(|_| middle()).collect();
    let stays = |v: u32| middles.iter().all(|&middle| distance(whole.points()[v as usize], middle) > 0.16);
    let (holed, kept) = piece(&whole, 1.0, |face| face.iter().all(|&v| stays(v)));
    let matcher = Matcher::new();
    let as_mesh =
        PrepareOptions { laplacian: Some(LaplacianKind::Cotangent), points: 1500, ..PrepareOptions::default() };
    let mesh = matcher.prepare(holed.clone(), &as_mesh).expect("prepared");
    let (cloud, b) = (prepared(&matcher, holed), prepared(&matcher, whole.clone()));
    let said = |shape: &PreparedShape| shape.repairs.iter().any(|repair| repair.code == "taken-as-cloud");
    assert!(said(&cloud) && !said(&mesh) && !said(&b), "an operator asked for by name is that operator");
    assert_eq!([&cloud, &mesh, &b].map(|shape| shape.info.kind), [ShapeKind::Cloud, ShapeKind::Mesh, ShapeKind::Mesh]);
    let near = |(&v, &target): (&u32, &u32)| {
        target != UNMATCHED && distance(whole.points()[target as usize], whole.points()[v as usize]) < 0.1
    };
    let [by_cloud, by_mesh] = [&cloud, &mesh].map(|a| {
        let matched = matcher.match_shapes(a, &b, &MatchOptions::default()).expect("matched");
        kept.iter().zip(&matched.a_to_b.target).filter(|&found| near(found)).count() as f64 / kept.len() as f64
    });
    assert!(by_cloud > 0.6 && by_cloud > by_mesh + 0.1, "{by_cloud} {by_mesh}");
}
