//! Meshes of more vertices than are matched.

use super::*;

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
        // As a mesh: by default what nearly meets is a body in shells.
        let as_mesh = PrepareOptions { laplacian: Some(LaplacianKind::Cotangent), whole_scan: true, ..quick() };
        let large = prepared(mesh.shape(), &as_mesh);
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
