//! From scan to map: a body finds itself, in any pose of the whole and any unit; every size of upload gives a whole map; what cannot be done
//! is said; a prepared shape survives its bytes.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;
use std::sync::LazyLock;

use geose_fmap::{
    BlockError, Correspondence, EdgeDistances, Error, FaceUse, GROUP_OF_PART, GROUPS, LaplacianKind, Match,
    MatchOptions, PARTS, Parts, PrepareOptions, PreparedShape, Progress, Refinement, Shape, ShapeKind, Stage,
    UNMATCHED, match_shapes, mean_error, prepare, read,
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

#[test]
fn a_body_finds_itself_in_a_shuffled_copy_without_faces() {
    for (seed, file) in BODIES.into_iter().enumerate() {
        let a = body(file);
        let order = Random(seed as u64).permutation(a.points().len());
        let copy = soup(&a).renumbered(&order).cloud().shape();
        let distances = EdgeDistances::new(&a);
        let (a, b) = (prepared(a, &PrepareOptions::default()), prepared(copy, &PrepareOptions::default()));
        let found = assert_match(file, &a, &b);
        // Both ways, measured on the mesh: where does each point of the copy land, and where does each point end up, named as on the mesh.
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(i, &new)| place[new as usize] = i as u32);
        let there: Vec<_> = found.a_to_b.target.iter().zip(0..).map(|(&t, i)| (place[t as usize], i)).collect();
        let back: Vec<_> = found.b_to_a.target.iter().zip(&place).map(|(&t, &i)| (t, i)).collect();
        let errors = [mean_error(&distances, &there), mean_error(&distances, &back)];
        println!("{file} onto its shuffled cloud: {:.2} and back {:.2} (×100/√area)", errors[0], errors[1]);
        assert!(errors[0] <= 1.0, "{file}: {errors:?}");
    }
}

#[test]
fn turning_and_scaling_a_body_changes_none_of_its_map() {
    let (a, b) = (body("woman-standing.ply"), body("man-lunging.ply"));
    // In metres y-up, and in millimetres lying somewhere.
    let elsewhere = soup(&b).moved(|p| turn(p).map(|x| 1000.0 * x - 300.0)).shape();
    let sampled = PrepareOptions { points: 2000, ..as_cloud() };
    for (name, options) in [("mesh", PrepareOptions::default()), ("sampled cloud", sampled)] {
        let [a, b, elsewhere] = [&a, &b, &elsewhere].map(|s| prepared(s.clone(), &options));
        let (one, other) = (matched(&a, &b), matched(&a, &elsewhere));
        let same = one.a_to_b.target.iter().zip(&other.a_to_b.target).filter(|(x, y)| x == y).count();
        let share = same as f64 / one.a_to_b.target.len() as f64;
        println!("{name}: {:.2} % of the points keep their target", 100.0 * share);
        assert!(share >= 0.995, "{name}: {share}");
    }
}

#[test]
fn the_same_pair_gives_the_same_map_again() {
    let options = PrepareOptions { points: 800, eigenpairs: 60, ..as_cloud() };
    let bytes = || {
        let [a, b] = ["woman-striding.ply", "man-standing.ply"].map(|file| prepared(body(file), &options));
        let found = matched(&a, &b);
        (found.a_to_b.target, found.a_to_b.confidence, found.b_to_a.target, found.c_ab)
    };
    assert!(bytes() == bytes());
}

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

#[test]
fn a_prepared_shape_comes_back_from_its_bytes() {
    let cloud = prepared(fibonacci_sphere(300).shape(), &PrepareOptions { points: 100, ..quick() });
    for shape in [&*SMALL, &*BODY, &cloud] {
        let back = PreparedShape::from_bytes(&shape.to_bytes().expect("bytes")).expect("a prepared shape");
        assert_eq!((&back.info, &back.repairs), (&shape.info, &shape.repairs));
        assert!(back.basis == shape.basis && back.features == shape.features);
        assert!((&back.support, &back.coarse) == (&shape.support, &shape.coarse));
        assert!(back.shape.points() == shape.shape.points() && back.shape.faces() == shape.shape.faces());
        assert!(back.shape.labels() == shape.shape.labels());
    }
    let back = PreparedShape::from_bytes(&SMALL.to_bytes().expect("bytes")).expect("a prepared shape");
    let options = MatchOptions::default();
    let [one, other] = [&*SMALL, &back].map(|shape| matched_with(shape, &BODY, &options).expect("a match"));
    assert_eq!(one.a_to_b, other.a_to_b, "and matches as before");
}

#[test]
fn parts_in_a_block_are_as_given_or_else_the_likeliest_for_the_network() {
    let parts_of = |shape: &PreparedShape| -> serde_json::Value {
        let bytes = shape.to_bytes().expect("bytes");
        let (_, header) = SafeTensors::read_metadata(&bytes).expect("a header");
        let likeliest =
            SafeTensors::deserialize(&bytes).expect("tensors").tensor("partLabels").expect("parts").data().to_vec();
        let probabilities = &shape.embedding.as_ref().expect("an embedding").parts;
        assert_eq!((likeliest.len(), probabilities.ncols()), (shape.points_used(), PARTS.len()));
        for (&part, row) in likeliest.iter().zip(probabilities.rows()) {
            assert!(row.iter().all(|&p| p <= row[part as usize]) && (row.sum() - 1.0).abs() < 1e-5, "{part} of {row}");
        }
        serde_json::from_str(&header.metadata().as_ref().expect("metadata")["parts"]).expect("JSON")
    };
    let given = serde_json::json!({ "names": ["part 0", "part 1", "part 2"], "source": "given" });
    assert_eq!(parts_of(&SMALL), given);
    let mut numbered = SMALL.clone();
    for labels in [None, Some((0..163).map(|i| 1000 * i).collect())] {
        numbered.shape =
            Shape::new(SMALL.shape.points().to_vec(), SMALL.shape.faces().to_vec(), labels).expect("valid");
        let groups = serde_json::json!({ "names": GROUPS, "of": GROUP_OF_PART });
        let predicted = serde_json::json!({ "names": PARTS, "source": "predicted", "groups": groups });
        assert_eq!(parts_of(&numbered), predicted);
    }
}

#[test]
fn only_a_match_without_weights_warns_that_it_had_none() {
    let untrained = |found: &Match| found.warnings.iter().any(|w| w.starts_with("matched without a trained network"));
    let with = matched(&SMALL, &SMALL);
    assert!(!untrained(&with) && with.weights["name"].is_string() && with.weights["version"].is_string());
    let bare = PreparedShape { embedding: None, ..SMALL.clone() };
    let without = matched(&bare, &SMALL);
    assert!(untrained(&without) && without.weights.is_null());
}

/// A block that is no longer what was written is refused, or at least can be matched without a panic.
fn survive(bytes: &[u8]) -> Result<(), BlockError> {
    let shape = PreparedShape::from_bytes(bytes)?;
    for (a, b) in [(&shape, &*SMALL), (&*SMALL, &shape)] {
        if let Ok(found) = matched_with(a, b, &MatchOptions { landmarks: vec![[0, 0]], ..Default::default() }) {
            assert_eq!(found.a_to_b.target.len(), a.shape.points().len());
        }
    }
    Ok(())
}

#[test]
fn a_block_cut_anywhere_is_refused() {
    let bytes = BODY.to_bytes().expect("bytes");
    for end in (0..bytes.len()).step_by(1000).chain(bytes.len() - 20..bytes.len()) {
        let error = PreparedShape::from_bytes(&bytes[..end]).expect_err("cut short");
        assert_eq!(error.code(), "invalid-block", "cut at {end}");
    }
    let small = SMALL.to_bytes().expect("bytes");
    for end in 0..small.len().min(4000) {
        assert!(PreparedShape::from_bytes(&small[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn a_block_with_flipped_bytes_never_panics() {
    let bytes = SMALL.to_bytes().expect("bytes");
    let header = 8 + u64::from_le_bytes(bytes[..8].try_into().expect("eight")) as usize;
    let mut random = Random(12);
    let mut refused = 0;
    for round in 0..500 {
        let mut broken = bytes.clone();
        // A third in the header, where every byte has a meaning.
        let at = random.below(if round % 3 == 0 { header } else { bytes.len() });
        broken[at] ^= 1 << random.below(8);
        if round % 2 == 0 {
            broken[at] = random.bits() as u8;
        }
        refused += usize::from(survive(&broken).is_err());
    }
    println!("{refused} of 500 broken blocks refused");
    assert!(refused > 100, "{refused}");
}

#[test]
fn bytes_that_were_never_a_block_are_refused() {
    let mut other_version = SMALL.to_bytes().expect("bytes");
    let at = other_version.windows(16).position(|w| w == b"geose-prepared 5").expect("the format");
    other_version[at + 15] = b'1';
    let huge = [&u64::MAX.to_le_bytes()[..], &[b'{'; 100]].concat();
    let empty = [&2u64.to_le_bytes()[..], b"{}"].concat();
    for bytes in [&[][..], b"ply\nformat ascii 1.0\n", &[0; 64], &huge, &empty, &other_version] {
        let error = PreparedShape::from_bytes(bytes).expect_err("refused");
        assert_eq!(error.code(), "invalid-block");
        assert!(error.to_string().len() > 40, "a sentence: {error}");
    }
}

#[test]
fn small_shapes_match() {
    let ball = |n| prepared(fibonacci_sphere(n).moved(|[x, y, z]| [1.7 * x, 1.2 * y, z]).shape(), &quick());
    let mesh = prepared(blob(2).shape(), &quick());
    for n in [50, 61, 200] {
        let cloud = ball(n);
        assert_eq!(cloud.info.eigenpairs, 60.min(n - 2));
        assert_match(&format!("{n} points with themselves"), &cloud, &cloud);
        assert_match(&format!("{n} points with a mesh"), &cloud, &mesh);
    }
    let few = prepared(blob(2).shape(), &PrepareOptions { eigenpairs: 10, ..quick() });
    assert_match("10 eigenpairs", &few, &mesh);
}

#[test]
fn sampled_meshes_and_clouds_give_every_uploaded_point_a_target() {
    let shape = body("woman-striding.ply");
    let sampled =
        |shape: &Shape, options: PrepareOptions| prepared(shape.clone(), &PrepareOptions { points: 1000, ..options });
    let mesh = sampled(&shape, quick());
    let cloud = sampled(&shape, PrepareOptions { eigenpairs: 60, ..as_cloud() });
    assert_eq!((mesh.points_used(), mesh.info.kind, mesh.basis.len()), (1000, ShapeKind::Mesh, 5000));
    assert_eq!((cloud.points_used(), cloud.info.kind, cloud.basis.len()), (1000, ShapeKind::Cloud, 1000));
    let other = prepared(blob(3).shape(), &quick());
    let distances = EdgeDistances::new(&shape);
    for (name, a, b) in
        [("sampled mesh", &mesh, &mesh), ("mesh and cloud", &mesh, &cloud), ("cloud and mesh", &cloud, &mesh)]
    {
        let found = assert_match(name, a, b);
        let pairs: Vec<_> = found.a_to_b.target.iter().copied().zip(0..).collect();
        let error = mean_error(&distances, &pairs);
        println!("{name}, 1000 of 5000: {error:.2}");
        // Half the spacing of 1000 samples is about 1.6 already.
        assert!(error < 4.0, "{name}: {error}");
    }
    assert_match("sampled with whole", &cloud, &other);
    assert_match("whole with sampled", &other, &mesh);
}

#[test]
fn up_to_half_as_many_points_again_stay_whole() {
    let shape = fibonacci_sphere(150).shape();
    let used = |points| prepared(shape.clone(), &PrepareOptions { points, eigenpairs: 10, ..quick() }).points_used();
    assert_eq!([100, 99, 150, 50].map(used), [150, 99, 150, 50]);
}

#[test]
fn vertices_without_faces_and_several_pieces_still_have_targets() {
    let mut stray = blob(3);
    stray.points.splice(0..0, [[5.0, 5.0, 5.0]]);
    stray.faces.iter_mut().flatten().for_each(|i| *i += 1);
    stray.points.extend([[0.0, 3.0, 0.0], [-4.0, 0.0, 0.0]]);
    let pieces = blob(3).beside(&icosphere(2).moved(|[x, y, z]| [0.4 * x + 5.0, 0.4 * y, 0.4 * z]));
    let (whole, stray, pieces) =
        (prepared(blob(3).shape(), &quick()), prepared(stray.shape(), &quick()), prepared(pieces.shape(), &quick()));
    assert_eq!([&whole, &stray, &pieces].map(|p| p.info.pieces), [1, 1, 2]);
    for (name, other) in [("strays", &stray), ("pieces", &pieces)] {
        assert_match(name, &whole, other);
        assert_match(name, other, &whole);
        assert_match(name, other, other);
    }
    assert!(matched(&whole, &pieces).warnings.iter().any(|w| w.contains("2 pieces")));
    // Nothing is ever matched onto a vertex that is not part of the surface.
    let onto_strays = matched(&whole, &stray).a_to_b.target;
    assert!(onto_strays.iter().all(|&t| t != 0 && t <= whole.shape.points().len() as u32));
}

/// The mesh as a binary STL holds it.
fn stl(soup: &Soup) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((soup.faces.len() as u32).to_le_bytes());
    for face in &soup.faces {
        bytes.extend([0; 12]);
        face.iter().flat_map(|&i| soup.points[i as usize]).for_each(|c| bytes.extend((c as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn triangle_soup_is_matched_on_its_surface_and_every_uploaded_corner_has_a_target() {
    let whole = blob(3);
    let shape = read(&stl(&whole), Some("blob.stl"), None).expect("an STL");
    let corners = whole.faces.as_flattened();
    assert_eq!(shape.points().len(), corners.len());
    let joined = shape.repairs().iter().find(|r| r.code == "corners-joined").map(|r| r.count);
    assert_eq!(joined, Some(corners.len() - whole.points.len()));

    let rounded = whole.moved(|p| p.map(|c| f64::from(c as f32))).shape();
    for points in [5000, 300] {
        let options = PrepareOptions { points, ..quick() };
        let (mesh, loose) = (prepared(rounded.clone(), &options), prepared(shape.clone(), &options));
        assert_eq!((loose.info.kind, loose.info.pieces), (ShapeKind::Mesh, 1));
        assert_eq!((loose.info.laplacian, loose.info.points_used), (mesh.info.laplacian, mesh.info.points_used));
        assert!((loose.info.scale / mesh.info.scale - 1.0).abs() < 1e-12, "same area, so same mass");
        for (k, (one, other)) in loose.basis.eigenvalues.iter().zip(&mesh.basis.eigenvalues).enumerate().skip(1) {
            assert!((one / other - 1.0).abs() < 1e-6, "eigenvalue {k} with {points} points");
        }
        let places = loose.matchable();
        assert!((places.basis.mass.sum() - 1.0).abs() < 1e-12 && places.basis.mass.iter().all(|&m| m > 0.0));
        // Corners of one place have one row, of whose eigenfunctions none is left at zero.
        let mut row_of = vec![None; whole.points.len()];
        for (corner, &vertex) in corners.iter().enumerate() {
            let row = loose.support.row_of(corner);
            assert_eq!(*row_of[vertex as usize].get_or_insert(row), row);
            assert!(places.basis.eigenvectors.row(row).iter().any(|&v| v.abs() > 1e-6));
        }
        let found = assert_match("soup onto mesh", &loose, &mesh);
        assert_eq!(found.a_to_b.target.len(), corners.len());
        let right = corners.iter().zip(&found.a_to_b.target).filter(|(vertex, target)| vertex == target).count();
        println!("{points} points: {right} of {} corners find their vertex", corners.len());
        assert!(points == 300 || right * 100 > corners.len() * 99, "{right} of {}", corners.len());
        let back = matched(&mesh, &loose);
        let right = (0..whole.points.len()).filter(|&i| corners[back.a_to_b.target[i] as usize] as usize == i).count();
        assert!(points == 300 || right * 100 > whole.points.len() * 99, "{right}");
    }
}

#[test]
fn triangle_soup_of_many_corners_stays_a_mesh_while_its_vertices_are_few() {
    let whole = torus(2.0, 0.7, 100, 60);
    let shape = read(&stl(&whole), Some("torus.stl"), None).expect("an STL");
    assert_eq!(shape.points().len(), 36_000);
    let loose = prepared(shape, &PrepareOptions { points: 1000, eigenpairs: 20, ..PrepareOptions::default() });
    assert_eq!((loose.info.kind, loose.info.points_used), (ShapeKind::Mesh, 1000));
    assert!(loose.repairs.iter().all(|r| r.code != "mesh-taken-as-cloud"));
}

#[test]
fn copies_of_the_points_of_a_cloud_change_nothing_but_their_number() {
    let once = fibonacci_sphere(400).moved(|[x, y, z]| [x, 1.5 * y, (1.0 + 0.3 * y) * z]);
    let five = Soup { points: (0..5).flat_map(|_| once.points.clone()).collect(), faces: vec![] };
    let [once, five] = [once, five].map(|soup| prepared(soup.shape(), &quick()));
    assert_eq!((once.info.points_used, five.info.points_used), (400, 400));
    assert_eq!(once.basis.eigenvalues, five.basis.eigenvalues);
    let found = assert_match("copies onto a cloud", &five, &once);
    assert_eq!(found.a_to_b.target.len(), 2000);
    assert_eq!(found.a_to_b.target[..400], found.a_to_b.target[1600..]);
}

#[test]
fn thirty_identical_pieces_prepare_and_match() {
    let mut many = Soup { points: vec![], faces: vec![] };
    for i in 0..30 {
        many =
            many.beside(&icosphere(1).moved(|[x, y, z]| [x + 3.0 * f64::from(i % 6), y + 3.0 * f64::from(i / 6), z]));
    }
    let many = prepared(many.shape(), &quick());
    assert_eq!(many.info.pieces, 30);
    assert_match("thirty balls", &many, &many);
}

#[test]
fn options_out_of_range_are_refused() {
    let shape = fibonacci_sphere(100).shape();
    let defaults = PrepareOptions::default();
    let bad = [
        PrepareOptions { points: 0, ..defaults.clone() },
        PrepareOptions { points: 49, ..defaults.clone() },
        PrepareOptions { eigenpairs: 0, ..defaults.clone() },
        PrepareOptions { eigenpairs: 9, ..defaults.clone() },
        PrepareOptions { eigenpairs: 1001, ..defaults.clone() },
    ];
    for options in bad {
        let error = prepare(shape.clone(), None, &options, &mut Progress::silent()).expect_err("refused");
        assert_eq!(error.code(), "invalid-option", "{options:?}");
    }
    let cotangent = PrepareOptions { laplacian: Some(LaplacianKind::Cotangent), ..defaults };
    let error = prepare(shape, None, &cotangent, &mut Progress::silent()).expect_err("refused");
    assert_eq!(error.code(), "needs-faces");
}

#[test]
fn match_options_that_cannot_be_are_refused() {
    let small = &*SMALL;
    let bare = prepared(blob(2).shape(), &quick());
    let refused = |a: &PreparedShape, b: &PreparedShape, options: MatchOptions| {
        matched_with(a, b, &options).map(|_| ()).expect_err("refused")
    };
    let n = small.shape.points().len() as u32;
    // Not a point of A, nor of B, and points that would have two partners.
    for pair in [[n, 0], [0, 162], [u32::MAX, 0], [1, 2], [2, 1]] {
        let error = refused(small, &bare, MatchOptions { landmarks: vec![[1, 1], pair], ..Default::default() });
        assert_eq!(error.code(), "invalid-option", "{pair:?}");
    }
    let given = refused(small, &bare, MatchOptions { parts: Parts::Given, ..Default::default() });
    assert_eq!((given.code(), given.details()["scan"].as_str()), ("no-labels", Some("b")));
}

#[test]
fn every_laplacian_and_refinement_matches_in_any_unit() {
    let [a, b] = [blob(3), blob(3).moved(turn).moved(|p| p.map(|x| 1000.0 * x))].map(|s| s.shape());
    for kind in LaplacianKind::ALL {
        let options = PrepareOptions { laplacian: Some(kind), ..quick() };
        let [a, b] = [&a, &b].map(|s| prepared(s.clone(), &options));
        assert_eq!(a.info.laplacian, kind);
        let scale = b.info.scale / a.info.scale;
        assert!((scale - 1000.0).abs() < 1e-3, "{kind}: {scale}");
        for refine in [Refinement::None, Refinement::ZoomOut, Refinement::Best] {
            let found = matched_with(&a, &b, &MatchOptions { refine, ..Default::default() }).expect("a match");
            assert_whole(kind.name(), &found.a_to_b, &a, &b);
            let right = found.a_to_b.target.iter().zip(0..).filter(|&(&t, i)| t == i).count();
            println!("{kind}, {refine:?}: {right} of {} points right", a.points_used());
            assert!(100 * right > 99 * a.points_used(), "{kind}, {refine:?}: {right} right");
        }
    }
}

#[test]
fn a_few_stray_faces_do_not_make_a_mesh() {
    let body = body(BODIES[0]);
    let stray = Shape::new(body.points().to_vec(), body.faces()[..40].to_vec(), None).expect("a valid shape");
    let shape = prepared(stray, &quick());
    assert_eq!((shape.info.kind, shape.points_used()), (ShapeKind::Cloud, 5000));
    assert!(shape.repairs.iter().any(|repair| repair.code == "faces-set-aside" && repair.count == 40));
    // Triangles that lie on twelve places only.
    let corners = icosphere(0);
    let repeated = (0..5).flat_map(|_| corners.faces.clone()).flatten().map(|i| corners.points[i as usize]);
    let points: Vec<_> = repeated.collect();
    let faces = (0..points.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let shape = Shape::new(points, faces, None).expect("a valid shape");
    let error = prepare(shape, None, &quick(), &mut Progress::silent()).expect_err("twelve places");
    assert_eq!(error.code(), "too-few-points");
}

#[test]
fn crumbs_and_strays_are_set_aside_and_change_nothing_for_the_body() {
    let clean = body(BODIES[0]);
    let mut random = Random(3);
    let mut place = || std::array::from_fn::<f64, 3, _>(|c| [2.0, 1.8, 2.0][c] * (random.unit() - [0.5, 0.0, 0.5][c]));
    let mut strewn = soup(&clean);
    for _ in 0..60 {
        let (first, centre) = (strewn.points.len() as u32, place());
        let corner = |c: usize| std::array::from_fn(|a| centre[a] + if a == c { 0.01 } else { 0.0 });
        strewn.points.extend([centre, corner(0), corner(1), corner(2)]);
        strewn.faces.extend([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(|i| first + i)));
    }
    let mut cloud = soup(&clean).cloud();
    cloud.points.extend((0..150).map(|_| place()));
    let other = prepared(body(BODIES[2]), &PrepareOptions::default());
    let alone = assert_match("the body alone", &prepared(clean.clone(), &PrepareOptions::default()), &other);
    for (name, scan) in [("crumbs", strewn.shape()), ("strays", cloud.shape())] {
        let n = scan.points().len();
        let shape = prepared(scan, &PrepareOptions::default());
        let aside = shape.repairs.iter().find(|repair| repair.code == "crumbs-set-aside").expect("said");
        println!("{name}: {}", aside.message);
        assert_eq!(shape.info.pieces, 1);
        let found = matched(&shape, &other);
        let unmatched = (5000..n).filter(|&i| found.a_to_b.target[i] == UNMATCHED).count();
        // Strays close to the body cannot be told from it.
        assert!(unmatched * 10 > (n - 5000) * 7, "{name}: {unmatched} of {} unmatched", n - 5000);
        let lost = (0..5000).filter(|&i| found.a_to_b.target[i] == UNMATCHED).count();
        assert!(lost < 25, "{name}: {lost} of the body unmatched");
        assert!((0..n).all(|i| (found.a_to_b.target[i] == UNMATCHED) == (found.a_to_b.confidence[i] == 0.0)));
        assert!(found.b_to_a.target.iter().all(|&i| i < 5000), "{name}: nothing goes to what was set aside");
        let distances = EdgeDistances::new(&other.shape);
        let error = |map: &Match| {
            let pairs = (0..5000).map(|i| (map.a_to_b.target[i as usize], i)).filter(|&(j, _)| j != UNMATCHED);
            mean_error(&distances, &pairs.collect::<Vec<_>>())
        };
        println!("{name}: error {:.2}, alone {:.2}", error(&found), error(&alone));
        assert!(error(&found) < error(&alone) + 1.0, "{name}: {}", error(&found));
    }
}

#[test]
fn copies_go_with_the_first_point_at_their_place() {
    const COPIES: usize = 30_000;
    let with_copies = |count: usize| {
        let mut cloud = soup(&body(BODIES[0])).cloud();
        cloud.points.extend(std::iter::repeat_n([0.0, 0.0, 3.0], count)); // a stray
        cloud.points.extend(std::iter::repeat_n(cloud.points[0], count));
        prepared(cloud.shape(), &as_cloud())
    };
    let (single, cloud, other) = (with_copies(1), with_copies(COPIES), prepared(body(BODIES[2]), &as_cloud()));
    let aside = cloud.repairs.iter().find(|repair| repair.code == "crumbs-set-aside").expect("said");
    assert_eq!(aside.count, COPIES);
    let (found, alone) = (matched(&cloud, &other), matched(&single, &other));
    let (body, copies) = found.a_to_b.target.split_at(5000);
    assert!(*body == alone.a_to_b.target[..5000] && found.b_to_a == alone.b_to_a, "copies change nothing");
    assert!(found.b_to_a.target.iter().all(|&i| i < 5000), "nothing goes to a copy");
    assert!(copies[..COPIES].iter().all(|&target| target == UNMATCHED));
    assert!(found.a_to_b.confidence[5000..][..COPIES].iter().all(|&confidence| confidence == 0.0));
    assert!(copies[COPIES..].iter().all(|&target| target == body[0]));
    // With labels, also those of another part at one place.
    let half = |i: usize| u32::from(i >= 5000 + COPIES + COPIES / 2);
    let labels = (0..cloud.shape.points().len()).map(half).collect();
    let labelled = Shape::new(cloud.shape.points().to_vec(), vec![], Some(labels)).expect("a valid shape");
    let labels = (0..5000).map(|i| u32::from(i >= 2500)).collect();
    let other = Shape::new(other.shape.points().to_vec(), vec![], Some(labels)).expect("a valid shape");
    let given = MatchOptions { parts: Parts::Given, ..Default::default() };
    let found = matched_with(&prepared(labelled, &as_cloud()), &prepared(other, &as_cloud()), &given).expect("a match");
    let copies = &found.a_to_b.target[5000 + COPIES..];
    assert!(copies[..COPIES / 2].iter().all(|&target| target == found.a_to_b.target[0]));
    assert!(copies[COPIES / 2..].iter().all(|&target| target == copies[COPIES / 2]));
}

#[test]
fn of_loose_triangles_every_corner_of_a_far_crumb_is_unmatched() {
    let clean = soup(&body(BODIES[0]));
    let mut crumbs = clean.clone();
    for k in 0..10 {
        let (first, centre) = (crumbs.points.len() as u32, [1.5 + 0.1 * f64::from(k), 0.5, 1.0]);
        let corner = |c: usize| std::array::from_fn(|a| centre[a] + if a == c { 0.01 } else { 0.0 });
        crumbs.points.extend([centre, corner(0), corner(1), corner(2)]);
        crumbs.faces.extend([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(|i| first + i)));
    }
    let corners: Vec<[f64; 3]> = crumbs.faces.iter().flatten().map(|&i| crumbs.points[i as usize]).collect();
    let faces = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let of_body = 3 * clean.faces.len();
    let loose = prepared(Soup { points: corners, faces }.shape(), &quick());
    let aside = loose.repairs.iter().find(|repair| repair.code == "crumbs-set-aside").expect("said");
    assert_eq!((aside.count, loose.info.pieces), (120, 1));
    let other = prepared(body(BODIES[1]), &quick());
    let found = matched(&loose, &other);
    let (body, crumbs) = found.a_to_b.target.split_at(of_body);
    assert!(crumbs.iter().all(|&target| target == UNMATCHED));
    assert!(found.b_to_a.target.iter().all(|&i| (i as usize) < of_body));
    let mut targets = vec![UNMATCHED; 5000];
    for (&corner, &target) in clean.faces.iter().flatten().zip(body) {
        let of_corner = &mut targets[corner as usize];
        assert!(target < 5000 && (*of_corner == UNMATCHED || *of_corner == target), "corners at one place part");
        *of_corner = target;
    }
}

#[test]
fn a_part_matched_onto_the_whole_is_doubted_and_whole_bodies_are_not() {
    let [woman, man] = [body(BODIES[0]), body(BODIES[3])];
    let mut upper = soup(&woman);
    let waist = 1.0;
    upper.faces.retain(|face| face.iter().all(|&i| upper.points[i as usize][1] > waist));
    let kept: Vec<u32> = (0..5000).filter(|&i| upper.points[i as usize][1] > waist).collect();
    let mut row = vec![u32::MAX; 5000];
    kept.iter().zip(0..).for_each(|(&i, r)| row[i as usize] = r);
    let faces = upper.faces.iter().map(|face| face.map(|i| row[i as usize])).collect();
    let upper = Soup { points: kept.iter().map(|&i| upper.points[i as usize]).collect(), faces };
    let options = PrepareOptions::default();
    let [woman, man, upper] = [woman, man, upper.shape()].map(|shape| prepared(shape, &options));
    let doubted = |a: &PreparedShape, b: &PreparedShape| {
        let warnings = matched(a, b).warnings;
        println!("{warnings:?}");
        warnings.iter().any(|warning| warning.contains("changes lengths"))
    };
    assert!(!doubted(&woman, &man) && !doubted(&man, &woman));
    assert!(doubted(&upper, &man));
}

#[test]
fn of_many_pieces_alike_none_is_a_crumb() {
    let ball = icosphere(1);
    let mut many = Soup { points: vec![], faces: vec![] };
    for i in 0..150_u32 {
        let (first, x) = (many.points.len() as u32, 10.0 * f64::from(i));
        many.points.extend(ball.points.iter().map(|p| [p[0] + x, p[1], p[2]]));
        many.faces.extend(ball.faces.iter().map(|face| face.map(|v| v + first)));
    }
    for scan in [many.shape(), many.cloud().shape()] {
        let shape = prepared(scan, &PrepareOptions { eigenpairs: 20, ..PrepareOptions::default() });
        assert!(shape.repairs.iter().all(|repair| repair.code != "crumbs-set-aside"));
        assert_eq!(shape.info.pieces, 150);
    }
}

#[test]
fn samples_are_the_farthest_points_one_by_one() {
    let shape = body(BODIES[1]);
    let options = PrepareOptions { points: 300, ..quick() };
    let samples = prepared(shape.clone(), &options).support.used.expect("a sampled mesh");
    let mut nearest = vec![f64::INFINITY; shape.points().len()];
    for pair in samples.windows(2) {
        for (d, &p) in nearest.iter_mut().zip(shape.points()) {
            *d = d.min(distance(p, shape.points()[pair[0] as usize]));
        }
        let farthest = (0..nearest.len()).fold(0, |best, i| if nearest[i] > nearest[best] { i } else { best });
        assert_eq!(pair[1] as usize, farthest);
    }
    assert_eq!(samples.len(), 300);
}

#[test]
fn what_cannot_fit_is_refused_before_any_work() {
    let shape = fibonacci_sphere(300_000).shape();
    for (points, eigenpairs) in [(190_000, 1000), (300_000, 1000)] {
        let options = PrepareOptions { points, eigenpairs, ..Default::default() };
        let mut progress = Progress::new(|stage, fraction| {
            assert!(stage == Stage::Sample && fraction == 0.0, "{stage:?} {fraction}");
            true
        });
        let error = prepare(shape.clone(), None, &options, &mut progress).expect_err("too large");
        assert_eq!(error.code(), "too-large");
    }
    for points in [10, 3_000_000_000] {
        let options = PrepareOptions { points, ..Default::default() };
        let error = prepare(shape.clone(), None, &options, &mut Progress::silent()).expect_err("out of range");
        assert_eq!(error.code(), "invalid-option");
    }
}

#[test]
fn a_large_mesh_is_matched_by_a_simplified_one_and_every_vertex_finds_its_own() {
    let fine = body(BODIES[0]);
    let large = subdivided(&subdivided(&soup(&fine))).shape(); // 80 thousand vertices; the first 5000 are those of the body
    let (a, b) =
        (prepared(large.clone(), &PrepareOptions::default()), prepared(fine.clone(), &PrepareOptions::default()));
    assert_eq!((a.info.kind, a.info.laplacian, a.points_used()), (ShapeKind::Mesh, LaplacianKind::Cotangent, 5000));
    assert!(a.repairs.iter().any(|repair| repair.code == "mesh-simplified"));
    assert!((a.info.scale / b.info.scale - 1.0).abs() < 0.01, "{} {}", a.info.scale, b.info.scale);
    println!("{} carriers", a.basis.len());
    let at_unit_area = |shape: &PreparedShape, j: usize| shape.basis.eigenvalues[j] * shape.info.scale.powi(2);
    let worst = (1..60).map(|j| (at_unit_area(&a, j) / at_unit_area(&b, j) - 1.0).abs()).fold(0.0, f64::max);
    println!("eigenvalues 1 to 59 of the large mesh differ by up to {:.2} %", 100.0 * worst);
    assert!(worst < 0.04, "{worst}");
    let found = assert_match("large onto small", &a, &b);
    let pairs: Vec<_> = (0..5000).map(|i| (found.a_to_b.target[i as usize], i)).collect();
    let there = mean_error(&EdgeDistances::new(&fine), &pairs);
    let pairs: Vec<_> = (0..5000).map(|i| (found.b_to_a.target[i as usize], i)).collect();
    let back = mean_error(&EdgeDistances::new(&large), &pairs);
    println!("error there {there:.2}, back {back:.2}");
    assert!(there < 1.0 && back < 1.0, "{there} {back}");
    // Lifted, not rounded to the samples: many more vertices are hit than take part.
    let mut hit = found.b_to_a.target.clone();
    hit.sort_unstable();
    hit.dedup();
    assert!(hit.len() > 3500, "{}", hit.len());
    let mut hit: Vec<u32> = found.a_to_b.target.clone();
    hit.sort_unstable();
    hit.dedup();
    assert!(hit.len() > 4000, "{}", hit.len());
}

#[test]
fn a_crumb_between_two_pieces_of_a_large_mesh_does_not_join_them() {
    let balls = icosphere(6).beside(&icosphere(5).moved(|[x, y, z]| [x + 2.2, y, z])); // 51 thousand vertices
    let strip = sheet(16, 8).moved(|[x, y, z]| [1.02 + 0.16 * x / 15.0, 0.4 * (y / 7.0 - 0.5), z]);
    for (name, mesh) in [("apart", balls.clone()), ("with a strip between them", balls.beside(&strip))] {
        let large = prepared(mesh.shape(), &quick());
        assert!(large.repairs.iter().any(|repair| repair.code == "mesh-simplified"), "{name}");
        assert_eq!(large.info.pieces, 2, "{name}");
    }
}

/// An uneven egg with a whisker of some radius and length on top; radii and heights of whatever lies above 1 are those of the whisker.
fn egg_with_whisker(radius: f64, length: f64, rings: u32, around: u32) -> Soup {
    const EGG: u32 = 300;
    let turns = (1..EGG).map(|i| PI * f64::from(i) / f64::from(EGG));
    let egg = turns.filter(|turn| *turn < PI / 2.0 || turn.sin() > radius).map(|turn| (turn.sin(), -turn.cos()));
    let whisker = (0..rings).map(|i| (radius, 1.0 + length * f64::from(i) / f64::from(rings)));
    let profile: Vec<(f64, f64)> = egg.chain(whisker).collect();
    let last = profile.len() as u32 - 1;
    let mut soup = Soup { points: vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0 + length]], faces: vec![] };
    let at = |ring: u32, k: u32| 2 + ring * around + k % around;
    for (ring, &(r, z)) in (0..).zip(&profile) {
        for k in 0..around {
            let (s, c) = (TAU * f64::from(k) / f64::from(around)).sin_cos();
            soup.points.push([r * c, r * s, z]);
            if ring < last {
                soup.faces.push([at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)]);
                soup.faces.push([at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)]);
            }
        }
    }
    soup.faces.extend((0..around).flat_map(|k| [[0, at(0, k + 1), at(0, k)], [1, at(last, k), at(last, k + 1)]]));
    soup.moved(|[x, y, z]| {
        if z >= 1.0 {
            return [x, y, z];
        }
        let bump = (-((x - 0.7).powi(2) + (y - 0.3).powi(2) + (z - 0.4).powi(2)) / 0.1).exp();
        [x + 0.2 * bump, 0.8 * y, if z > 0.0 { z } else { 1.2 * z }]
    })
}

#[test]
fn a_whisker_of_a_large_mesh_stays_on_the_body_and_finds_itself() {
    let large = prepared(egg_with_whisker(0.005, 1.5, 150, 80).shape(), &PrepareOptions::default());
    assert!(large.repairs.iter().any(|repair| repair.code == "mesh-simplified"));
    assert!(large.repairs.iter().all(|repair| repair.code != "thin-parts-lost"));
    assert_eq!(large.info.pieces, 1);
    assert!(large.basis.mass.iter().all(|&mass| mass > 0.0), "every carrier carries");
    let found = assert_match("a whisker", &large, &large);
    let points = large.shape.points();
    let whisker: Vec<usize> = (0..points.len()).filter(|&i| points[i][2] > 1.05).collect();
    let off = whisker.iter().map(|&i| distance(points[i], points[found.a_to_b.target[i] as usize]));
    let off = off.sum::<f64>() / whisker.len() as f64;
    println!("{} points of the whisker are {off:.4} off", whisker.len());
    assert!(off < 0.02, "{off}");
}

#[test]
fn a_thread_that_no_simplified_mesh_has_room_for_is_said_to_be_lost() {
    let large = prepared(egg_with_whisker(0.0005, 200.0, 15_000, 4).shape(), &quick());
    assert_eq!(large.info.pieces, 1);
    assert!(large.basis.mass.iter().all(|&mass| mass > 0.0), "every carrier carries");
    let lost = large.repairs.iter().find(|repair| repair.code == "thin-parts-lost").expect("said");
    println!("{}", lost.message);
    assert_match("a thread", &large, &large);
    // A thread and nothing else.
    let thread = torus(30.0, 0.0005, 20_000, 4);
    let error = prepare(thread.shape(), None, &quick(), &mut Progress::silent()).expect_err("nothing is left of it");
    assert_eq!(error.code(), "too-few-points");
}

#[test]
#[ignore = "needs the evaluation sets: set GEOSE_EVAL_DIR and pass --include-ignored"]
fn four_faust_scans_load_prepare_and_match() {
    let set = PathBuf::from(std::env::var_os("GEOSE_EVAL_DIR").expect("GEOSE_EVAL_DIR names a folder")).join("faust_r");
    let load = |name: &str| {
        let shape = scan(&set.join(format!("shapes/{name}.off")));
        let truth = std::fs::read_to_string(set.join(format!("corres/{name}.vts"))).expect("ground truth");
        let truth: Vec<u32> = truth.split_whitespace().map(|v| v.parse::<u32>().expect("a vertex") - 1).collect();
        (shape, truth)
    };
    for (a, b) in [("tr_reg_080", "tr_reg_094"), ("tr_reg_085", "tr_reg_091")] {
        let ((shape_a, truth_a), (shape_b, truth_b)) = (load(a), load(b));
        let distances = EdgeDistances::new(&shape_b);
        for (name, options) in [("mesh", PrepareOptions::default()), ("cloud", as_cloud())] {
            let (a_prepared, b_prepared) = (prepared(shape_a.clone(), &options), prepared(shape_b.clone(), &options));
            let found = assert_match(name, &a_prepared, &b_prepared);
            let pairs: Vec<_> =
                truth_a.iter().zip(&truth_b).map(|(&i, &j)| (found.a_to_b.target[i as usize], j)).collect();
            let error = mean_error(&distances, &pairs);
            println!("{a} onto {b} as {name}: {error:.2} (×100/√area)");
            assert!(error < 4.0, "{a} onto {b} as {name}: {error}");
        }
    }
}
