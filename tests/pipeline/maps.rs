//! Maps between bodies, in any pose of the whole, any unit, and with every operator.

use super::*;

#[test]
fn a_body_finds_itself_in_a_shuffled_copy_without_faces() {
    for (seed, file) in [BODIES[0], BODIES[3]].into_iter().enumerate() {
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
fn only_a_match_without_weights_warns_that_it_had_none() {
    let untrained = |found: &Match| found.warnings.iter().any(|w| w.code == "no-network");
    let with = matched(&SMALL, &SMALL);
    assert!(!untrained(&with) && with.weights.is_some());
    let bare = PreparedShape { embeddings: Vec::new(), ..SMALL.clone() };
    let without = matched(&bare, &SMALL);
    assert!(untrained(&without) && without.weights.is_none());
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
