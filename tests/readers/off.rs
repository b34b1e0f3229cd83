use crate::sample::{Sample, assert_is_torus, off, parse, refused, repaired, torus};

#[test]
fn comments_blank_lines_and_windows_line_ends_are_passed_over() {
    let text = off(&torus()).replacen("OFF\n", "# by hand\n\nOFF # header\n\n# counts:\n", 1).replace('\n', "\r\n");
    assert_is_torus(&parse(text, "a.off").unwrap());
}

#[test]
fn counts_may_stand_on_the_header_line_with_or_without_a_space() {
    for glue in [" ", ""] {
        assert_is_torus(&parse(off(&torus()).replacen('\n', glue, 1), "a.off").unwrap());
    }
}

#[test]
fn colours_normals_and_face_colours_are_passed_over() {
    for keyword in ["COFF", "NOFF", "CNOFF", "STOFF"] {
        let mut text = format!("{keyword}\n64 128 0\n");
        torus().points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z} 0.5 0.25 1 1\n"));
        torus().faces.iter().for_each(|[a, b, c]| text += &format!("3 {a} {b} {c} 255 0 0\n"));
        assert_is_torus(&parse(text, "a").unwrap());
    }
}

#[test]
fn a_file_without_faces_is_a_cloud() {
    let cloud = parse(off(&Sample { faces: vec![], ..torus() }), "a.off").unwrap();
    assert_eq!((cloud.points().len(), cloud.faces().len()), (64, 0));
    assert_eq!(cloud.repairs(), []);
}

#[test]
fn polygons_become_triangles_and_the_count_is_reported() {
    let mut text = String::from("OFF\n64 66 0\n");
    torus().points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    torus().faces.chunks(2).for_each(|q| text += &format!("4 {} {} {} {}\n", q[0][0], q[0][1], q[0][2], q[1][2]));
    text += "2 0 1\n1 5\n";
    let shape = parse(text, "a.off").unwrap();
    assert_eq!(shape.faces(), torus().faces);
    assert_eq!(repaired(&shape, "polygons-triangulated"), 64);
    assert_eq!(repaired(&shape, "short-faces"), 2);
}

#[test]
fn lines_after_the_last_face_are_reported() {
    let shape = parse(off(&torus()) + "3 0 1 2\n0 0 0\n", "a.off").unwrap();
    assert_eq!(repaired(&shape, "trailing-data"), 2);
}

#[test]
fn a_file_cut_off_says_what_it_promised_and_where_it_ended() {
    let text: Vec<String> = off(&torus()).lines().map(String::from).collect();
    let (code, message, details) = refused(parse(text[..40].join("\n"), "a.off"));
    assert_eq!(code, "truncated-file");
    assert_eq!(message, "OFF promises 64 vertices, the file ends after 38 (line 40); it may be cut off");
    assert_eq!((&details["promised"], &details["found"], &details["line"]), (&64.into(), &38.into(), &40.into()));
    let (_, message, _) = refused(parse(text[..100].join("\n") + " \n3 4", "a.off"));
    assert_eq!(message, "OFF promises 128 faces, the file ends after 34 (line 101); it may be cut off");
}

#[test]
fn counts_larger_than_the_file_cost_no_memory() {
    for counts in ["4000000000 0 0", "18446744073709551615 1 1", "64 9223372036854775807 0"] {
        let text = off(&torus()).replacen("64 128 0", counts, 1);
        let code = refused(parse(text, "a.off")).0;
        assert!(["truncated-file", "bad-number"].contains(&code), "{code}");
    }
    assert_eq!(refused(parse("OFF\n-5 3 0\n", "a.off")).0, "bad-number");
}

#[test]
fn wrong_numbers_are_quoted_with_their_line() {
    let text = off(&torus()).replacen("3 0 0", "3,25 0 0", 1);
    let (code, message, details) = refused(parse(text, "a.off"));
    assert_eq!(code, "bad-number");
    assert_eq!(message, "OFF, line 3: “3,25” is not a number (decimals are written with a point)");
    assert_eq!(details["line"], 3);
}

#[test]
fn a_short_line_in_the_middle_is_refused() {
    let (code, message, _) = refused(parse(off(&torus()).replacen("3 0 0\n", "3 0\n", 1), "a.off"));
    assert_eq!(code, "short-line");
    assert_eq!(message, "OFF, line 3: a vertex needs 3 values, the line has 2");
    assert_eq!(refused(parse(off(&torus()).replacen("\n3 ", "\n900 ", 2), "a.off")).0, "short-line");
}

#[test]
fn a_face_that_names_a_missing_point_is_refused_with_its_line() {
    let (code, message, _) = refused(parse(off(&torus()).replacen("3 0 8 9\n", "3 0 8 64\n", 1), "a.off"));
    assert_eq!(code, "face-index-out-of-range");
    assert_eq!(message, "OFF, line 67: face 0 names point 64, but the file has 64 points (0 to 63)");
    assert_eq!(refused(parse(off(&torus()).replacen("3 0 8 9\n", "3 0 -8 9\n", 1), "a.off")).2["index"], -8);
}

#[test]
fn other_variants_are_named() {
    assert_eq!(
        refused(parse("OFF BINARY\n\0\0\0", "a.off")).1,
        "binary OFF cannot be read; save it as text OFF or as PLY"
    );
    assert_eq!(refused(parse("4OFF\n64 0 0\n", "a.off")).0, "unsupported-variant");
}
