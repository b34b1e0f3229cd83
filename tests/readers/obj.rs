use crate::sample::{assert_is_torus, obj, parse, refused, repaired, torus};

#[test]
fn texture_and_normal_indices_are_passed_over() {
    for (from, to) in [("{}", "{}/7"), ("{}", "{}//3"), ("{}", "{}/9/1")] {
        let mut text = String::from("mtllib a.mtl\no body\nvt 0 0\nvn 0 0 1\n");
        torus().points.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z} 0.5 0.5 0.5\n"));
        text += "g skin\nusemtl red\ns 1\n";
        let corner = |i: u32| to.replace(from, &(i + 1).to_string());
        torus().faces.iter().for_each(|f| text += &format!("f {} {} {}\n", corner(f[0]), corner(f[1]), corner(f[2])));
        assert_is_torus(&parse(text, "a").unwrap());
    }
}

#[test]
fn negative_indices_count_back_from_the_last_point() {
    let mut text = obj(&torus()).split_inclusive('\n').filter(|l| l.starts_with('v')).collect::<String>();
    torus()
        .faces
        .iter()
        .for_each(|f| text += &format!("f {} {} {}\n", f[0] as i64 - 64, f[1] as i64 - 64, f[2] as i64 - 64));
    assert_is_torus(&parse(text, "a.obj").unwrap());
}

#[test]
fn windows_line_ends_comments_and_continued_lines_are_read() {
    let text =
        obj(&torus()).replacen("v 3 0 0\n", "# a comment\nv 3 \\\n0 \\\n 0 # here too\n", 1).replace('\n', "\r\n");
    assert_is_torus(&parse(text, "a.obj").unwrap());
}

#[test]
fn several_objects_become_one_scan_in_the_order_of_their_v_lines() {
    let second: String = torus().points.iter().map(|[x, y, z]| format!("v {} {y} {z}\n", x + 10.0)).collect();
    let faces: String =
        torus().faces.iter().map(|f| format!("f {} {} {}\n", f[0] + 65, f[1] + 65, f[2] + 65)).collect();
    let shape = parse(format!("o one\n{}o two\n{second}{faces}", obj(&torus())), "a.obj").unwrap();
    assert_eq!((shape.points().len(), shape.faces().len()), (128, 256));
    assert_eq!(shape.points()[64 + 17][0], torus().points[17][0] + 10.0);
    assert_eq!(repaired(&shape, "separate-pieces"), 2);
}

#[test]
fn quads_and_larger_polygons_become_triangles() {
    let mut text = obj(&torus()).split_inclusive('\n').filter(|l| l.starts_with('v')).collect::<String>();
    for q in torus().faces.chunks(2) {
        text += &format!("f {} {} {} {}\n", q[0][0] + 1, q[0][1] + 1, q[0][2] + 1, q[1][2] + 1);
    }
    text += "f 1 2\n";
    let shape = parse(text, "a.obj").unwrap();
    assert_eq!(shape.faces(), torus().faces);
    assert_eq!((repaired(&shape, "polygons-triangulated"), repaired(&shape, "short-faces")), (64, 1));
}

#[test]
fn faces_may_stand_before_their_points() {
    let (faces, points): (Vec<_>, Vec<_>) = obj(&torus()).lines().map(str::to_owned).partition(|l| l.starts_with('f'));
    assert_is_torus(&parse([faces, points].concat().join("\n"), "a.obj").unwrap());
}

#[test]
fn bad_indices_are_refused_as_they_are_written() {
    let with = |face: &str| refused(parse(obj(&torus()).replacen("f 1 9 10", face, 1), "a.obj"));
    assert_eq!(with("f 1 9 65").1, "OBJ, line 65: face 0 names point 65, but the file has 64 points (1 to 64)");
    assert_eq!(with("f 1 0 10").1, "OBJ, line 65: face 0 names point 0, but the file has 64 points (1 to 64)");
    assert_eq!(with("f 1 -65 10").2["index"], -65);
    assert_eq!(with("f 1 9 99999999999999999999").0, "bad-number");
    assert_eq!(with("f 1 9 9223372036854775807").0, "face-index-out-of-range");
    assert_eq!(with("f 1 /2 10").0, "bad-number");
}

#[test]
fn wrong_and_missing_coordinates_are_refused_with_their_line() {
    let with = |v: &str| refused(parse(obj(&torus()).replacen("v 3 0 0", v, 1), "a.obj"));
    assert_eq!(with("v 3 zero 0").1, "OBJ, line 1: “zero” is not a number");
    assert_eq!(with("v 3 0").1, "OBJ, line 1: a vertex needs 3 values, the line has 2");
    assert_eq!(
        with("v 3 -nan(ind) 0").1,
        "1 of the scan's points have a coordinate that is not a finite number; the first is point 0: leave those points out when saving"
    );
    assert_eq!(refused(parse("# nothing\nf 1 2 3\n", "a.obj")).0, "missing-element");
}
