use geose_fmap::{Error, Shape, ShapeError};

use crate::sample::{Sample, repaired, torus};

fn shape(Sample { points, faces }: Sample) -> Result<Shape, Error> {
    Ok(Shape::new(points, faces, None)?)
}

/// The torus after a change to its points or faces.
fn changed(change: impl FnOnce(&mut Sample)) -> Result<Shape, Error> {
    let mut sample = torus();
    change(&mut sample);
    shape(sample)
}

fn refused(result: Result<Shape, Error>) -> (&'static str, serde_json::Value) {
    let error = result.expect_err("must be refused");
    (error.code(), error.details())
}

#[test]
fn fewer_than_fifty_points_are_too_few() {
    assert_eq!(Shape::new(torus().points[..50].to_vec(), vec![], None).map(|s| s.points().len()), Ok(50));
    let few = Shape::new(torus().points[..49].to_vec(), vec![], None);
    assert_eq!(few, Err(ShapeError::TooFewPoints { found: 49, needed: 50 }));
    assert_eq!(Shape::new(vec![], vec![], None).unwrap_err().code(), "too-few-points");
}

#[test]
fn coordinates_that_are_not_finite_are_counted_and_the_first_is_named() {
    for poison in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (code, details) = refused(changed(|s| [7, 9, 30].iter().for_each(|&i| s.points[i][1] = poison)));
        assert_eq!((code, &details["index"], &details["count"]), ("not-finite", &7.into(), &3.into()));
    }
}

#[test]
fn points_in_one_place_or_on_one_line_carry_no_surface() {
    assert_eq!(refused(changed(|s| s.points.fill([5.0, 6.0, 7.0]))).0, "all-points-equal");
    let line =
        |s: &mut Sample| s.points.iter_mut().enumerate().for_each(|(i, p)| *p = [0.1, 0.2, -0.3].map(|c| c * i as f64));
    assert_eq!(refused(changed(line)).0, "collinear-points");
    let rounded = |s: &mut Sample| {
        line(s);
        s.points.iter_mut().flatten().for_each(|c| *c = f64::from(*c as f32) + 100.0);
    };
    assert_eq!(refused(changed(rounded)).0, "collinear-points");
    let flat = changed(|s| s.points.iter_mut().for_each(|p| p[2] = 0.25 * p[0]));
    assert!(flat.is_ok(), "a sheet is a surface");
}

#[test]
fn huge_and_tiny_scans_are_refused_where_areas_overflow_and_read_where_not() {
    let scaled = |factor: f64| changed(|s| s.points.iter_mut().flatten().for_each(|c| *c *= factor));
    assert_eq!(refused(scaled(1e31)).0, "coordinate-too-large");
    assert_eq!(refused(scaled(1e300)).1["index"], 0);
    assert_eq!(refused(scaled(1e-31)).0, "extent-too-small");
    assert_eq!(refused(scaled(f64::MIN_POSITIVE / 1e3)).0, "extent-too-small");
    for factor in [1e-29, 1e-6, 1e6, 3e29] {
        assert_eq!(scaled(factor).unwrap().repairs(), [], "{factor}");
    }
}

#[test]
fn a_scan_far_from_the_origin_is_reported() {
    let moved = |by: f64| changed(|s| s.points.iter_mut().for_each(|p| p[0] += by));
    assert_eq!(repaired(&moved(1e4).unwrap(), "far-from-origin"), 0);
    assert_eq!(repaired(&moved(1e8).unwrap(), "far-from-origin"), 1);
    assert_eq!(refused(moved(1e25)).0, "all-points-equal");
}

#[test]
fn labels_must_be_one_per_point() {
    let labels = |n: u32| Shape::new(torus().points, torus().faces, Some((0..n).collect()));
    assert_eq!(labels(64).unwrap().labels().unwrap()[63], 63);
    assert_eq!(labels(63), Err(ShapeError::LabelCount { labels: 63, points: 64 }));
}

#[test]
fn a_face_that_names_a_missing_point_is_refused() {
    let (code, details) = refused(changed(|s| s.faces[5][1] = 64));
    assert_eq!(code, "face-index-out-of-range");
    assert_eq!(details, serde_json::json!({ "face": 5, "corner": 1, "index": 64, "points": 64 }));
}

#[test]
fn faces_without_area_stay_where_they_close_a_surface_and_are_counted() {
    let shape = changed(|s| {
        s.faces.extend([[1, 1, 2], [3, 4, 3], [5, 5, 5]]);
        s.points.push(s.points[8]);
        s.faces.push([0, 8, 64]); // two corners in one place
    })
    .unwrap();
    assert_eq!(shape.faces()[..128], torus().faces);
    assert_eq!(shape.faces()[128..], [[0, 8, 64]]);
    assert_eq!((repaired(&shape, "repeated-index-faces"), repaired(&shape, "zero-area-faces")), (3, 1));
    assert_eq!(repaired(&shape, "non-manifold-edges"), 0, "it has met its copy");
    let sliver = changed(|s| {
        s.points.extend([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-9, 0.0]]);
        s.faces.push([64, 65, 66]);
    });
    assert_eq!(sliver.unwrap().faces().len(), 129, "a sliver has an area");
}

#[test]
fn faces_without_area_that_are_joined_to_no_surface_are_left_out() {
    let shape = changed(|s| {
        s.points.extend([[0.0, 0.0, 0.0], [0.1, 0.1, 0.1], [0.3, 0.3, 0.3], [0.1, 0.1, 0.1]]);
        s.faces.extend([[64, 65, 66], [66, 65, 67]]); // on a line, up to rounding; two corners in one place
    })
    .unwrap();
    assert_eq!(shape.faces(), torus().faces);
    assert_eq!((repaired(&shape, "zero-area-pieces"), repaired(&shape, "zero-area-faces")), (2, 0));
    let line = changed(|s| {
        s.points.extend([[0.0, 0.0, 0.0], [0.1, 0.1, 0.1], [0.3, 0.3, 0.3]]);
        s.faces = vec![[64, 65, 66]];
    })
    .unwrap();
    assert_eq!((line.faces().len(), repaired(&line, "no-faces-left")), (0, 1));
}

#[test]
fn corners_of_triangle_soup_stay_apart_and_are_taken_as_joined() {
    let soup = changed(|s| {
        s.points = s.faces.iter().flatten().map(|&i| s.points[i as usize]).collect();
        s.faces = (0..128).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    })
    .unwrap();
    assert_eq!((soup.points().len(), soup.faces().len()), (384, 128));
    assert_eq!(repaired(&soup, "corners-joined"), 384 - 64);
    assert_eq!(soup.repairs().len(), 1, "one piece, every edge with two faces");
}

#[test]
fn a_mesh_without_a_single_good_face_becomes_a_cloud_and_says_so() {
    let shape = changed(|s| s.faces.iter_mut().for_each(|f| f[1] = f[0])).unwrap();
    assert!(shape.faces().is_empty());
    assert_eq!((repaired(&shape, "repeated-index-faces"), repaired(&shape, "no-faces-left")), (128, 1));
}

#[test]
fn duplicate_and_unreferenced_points_are_reported_and_kept() {
    let shape = changed(|s| s.points.extend([s.points[3], s.points[3], [9.0, 0.0, 0.0], [9.0, -0.0, 0.0]])).unwrap();
    assert_eq!(shape.points().len(), 68);
    assert_eq!((repaired(&shape, "duplicate-points"), repaired(&shape, "unreferenced-points")), (3, 4));
    let cloud = changed(|s| s.faces.clear()).unwrap();
    assert_eq!(cloud.repairs(), [], "a cloud refers to no point");
}

#[test]
fn edges_with_more_than_two_faces_are_reported() {
    let shape = changed(|s| {
        s.points.push([5.0, 5.0, 5.0]);
        s.faces.push([0, 8, 64]);
    })
    .unwrap();
    assert_eq!(repaired(&shape, "non-manifold-edges"), 1);
    assert_eq!(shape.faces().len(), 129);
}

#[test]
fn neighbours_that_disagree_about_the_outside_are_reported() {
    let shape = changed(|s| s.faces[40].swap(1, 2)).unwrap();
    assert_eq!(repaired(&shape, "inconsistent-winding"), 3);
    let inside_out = changed(|s| s.faces.iter_mut().for_each(|f| f.swap(1, 2))).unwrap();
    assert_eq!(inside_out.repairs(), []);
}

#[test]
fn separate_pieces_are_counted() {
    let shape = changed(|s| {
        let Sample { points, faces } = torus();
        for k in 1..3_u32 {
            s.points.extend(points.iter().map(|[x, y, z]| [x + 10.0 * f64::from(k), *y, *z]));
            s.faces.extend(faces.iter().map(|f| f.map(|i| i + 64 * k)));
        }
    });
    assert_eq!(repaired(&shape.unwrap(), "separate-pieces"), 3);
}

#[test]
fn flat_arrays_make_the_same_shape() {
    let Sample { points, faces } = torus();
    let (flat, corners) = (points.as_flattened(), faces.as_flattened());
    assert_eq!(Shape::from_arrays(flat, corners, None), Shape::new(points.clone(), faces.clone(), None));
    let labels = vec![3; 64];
    assert_eq!(Shape::from_arrays(flat, &[], Some(&labels)).unwrap().labels(), Some(&labels[..]));
    assert_eq!(
        Shape::from_arrays(&flat[1..], corners, None),
        Err(ShapeError::RaggedArray { array: "positions", length: 191 })
    );
    assert_eq!(
        Shape::from_arrays(flat, &corners[2..], None),
        Err(ShapeError::RaggedArray { array: "faces", length: 382 })
    );
    assert_eq!(Shape::from_arrays(&[], &[], None).unwrap_err().code(), "too-few-points");
}

#[test]
fn every_repair_has_a_sentence_and_dropping_faces_keeps_the_points() {
    let shape = changed(|s| {
        s.faces.push([1, 1, 2]);
        s.points.push(s.points[0]);
    })
    .unwrap();
    assert!(shape.repairs().iter().all(|r| r.count > 0 && r.message.contains(' ') && !r.code.contains(' ')));
    assert_eq!(shape.repairs()[0].message, "1 face naming the same point twice left out");
    let cloud = shape.clone().without_faces();
    assert_eq!((cloud.points(), cloud.faces().len()), (shape.points(), 0));
}
