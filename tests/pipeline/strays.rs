//! Pieces that are not of the body are set aside.

use super::*;

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
    for (name, scan) in [("strays", strewn.shape()), ("strays", cloud.shape())] {
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
    let mut strays = clean.clone();
    for k in 0..10 {
        let (first, centre) = (strays.points.len() as u32, [1.5 + 0.1 * f64::from(k), 0.5, 1.0]);
        let corner = |c: usize| std::array::from_fn(|a| centre[a] + if a == c { 0.01 } else { 0.0 });
        strays.points.extend([centre, corner(0), corner(1), corner(2)]);
        strays.faces.extend([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(|i| first + i)));
    }
    let corners: Vec<[f64; 3]> = strays.faces.iter().flatten().map(|&i| strays.points[i as usize]).collect();
    let faces = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let of_body = 3 * clean.faces.len();
    let loose = prepared(Soup { points: corners, faces }.shape(), &quick());
    let aside = loose.repairs.iter().find(|repair| repair.code == "crumbs-set-aside").expect("said");
    assert_eq!((aside.count, loose.info.pieces), (120, 1));
    let other = prepared(body(BODIES[1]), &quick());
    let found = matched(&loose, &other);
    let (body, strays) = found.a_to_b.target.split_at(of_body);
    assert!(strays.iter().all(|&target| target == UNMATCHED));
    assert!(found.b_to_a.target.iter().all(|&i| (i as usize) < of_body));
    let mut targets = vec![UNMATCHED; 5000];
    for (&corner, &target) in clean.faces.iter().flatten().zip(body) {
        let of_corner = &mut targets[corner as usize];
        assert!(target < 5000 && (*of_corner == UNMATCHED || *of_corner == target), "corners at one place part");
        *of_corner = target;
    }
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
fn vertices_in_no_face_are_unmatched_far_from_the_surface_and_go_with_the_nearest_point_near_it() {
    let clean = blob(3);
    let n = clean.points.len();
    let mut scan = clean.clone();
    let mut random = Random(4);
    // Out to twice the body, then a hair above every tenth vertex.
    scan.points.extend((0..40).map(|_| {
        let p = [random.sign(), random.sign(), random.sign()];
        let length = distance(p, [0.0; 3]).max(0.1);
        p.map(|x| (1.7 + random.unit()) * x / length)
    }));
    scan.points.extend(clean.points.iter().step_by(10).map(|p| p.map(|x| 1.002 * x)));
    let shape = prepared(scan.shape(), &quick());
    let said = |code: &str| shape.repairs.iter().find(|repair| repair.code == code).map(|repair| repair.count);
    assert_eq!((said("far-from-surface"), said("crumbs-set-aside")), (Some(40), None));
    assert_eq!(said("unreferenced-points"), Some(scan.points.len() - n));
    let other = prepared(clean.moved(turn).shape(), &quick());
    let found = matched(&shape, &other);
    let (target, confidence) = (&found.a_to_b.target, &found.a_to_b.confidence);
    assert!(target[n..n + 40].iter().all(|&t| t == UNMATCHED) && confidence[n..n + 40].iter().all(|&c| c == 0.0));
    assert!(found.b_to_a.target.iter().all(|&i| !(n..n + 40).contains(&(i as usize))), "nothing goes to them");
    let near = n + 40;
    for (i, on_surface) in (near..scan.points.len()).zip((0..n).step_by(10)) {
        assert_eq!((target[i], confidence[i]), (target[on_surface], confidence[on_surface]));
    }
}
