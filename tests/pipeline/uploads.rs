//! Every point of an upload has a target, whatever the upload is made of.

use super::*;

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
fn several_pieces_all_have_targets_and_far_vertices_without_faces_have_none() {
    let mut stray = blob(3);
    stray.points.splice(0..0, [[5.0, 5.0, 5.0]]);
    stray.faces.iter_mut().flatten().for_each(|i| *i += 1);
    stray.points.extend([[0.0, 3.0, 0.0], [-4.0, 0.0, 0.0]]);
    let pieces = blob(3).beside(&icosphere(2).moved(|[x, y, z]| [0.4 * x + 5.0, 0.4 * y, 0.4 * z]));
    let [whole, stray, pieces] = [blob(3), stray, pieces].map(|soup| prepared(soup.shape(), &quick()));
    assert_eq!([&whole, &stray, &pieces].map(|p| p.info.pieces), [1, 1, 2]);
    // The network may take two balls for a piece of somebody, on which not every point has a partner.
    for (from, to) in [(&whole, &pieces), (&pieces, &whole), (&pieces, &pieces)] {
        let found = matched(from, to);
        let mut known = found.a_to_b.target.iter().zip(&found.overlap[0]);
        assert!(known.all(|(&target, &overlap)| (target == UNMATCHED) == (overlap < 0.1)));
    }
    assert!(matched(&whole, &pieces).warnings.iter().any(|w| w.message.contains("2 pieces")));
    let found = matched(&stray, &whole);
    for (i, (&target, &confidence)) in found.a_to_b.target.iter().zip(&found.a_to_b.confidence).enumerate() {
        let far = i == 0 || i > whole.shape.points().len();
        assert_eq!((target == UNMATCHED, confidence == 0.0), (far, far), "vertex {i}");
    }
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
