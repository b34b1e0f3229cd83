use geose_fmap::Shape;

use crate::sample::{Sample, parse, refused, repaired, soup, stl_binary, stl_text, torus};

fn assert_is_loose_torus(shape: &Shape) {
    let Sample { points, faces } = soup(&torus());
    assert_eq!((shape.points(), shape.faces()), (&points[..], &faces[..]));
    assert_eq!((shape.repairs().len(), repaired(shape, "corners-joined")), (1, 384 - 64));
}

#[test]
fn corners_keep_the_order_and_number_of_the_file_and_the_repair_says_how_many_are_joined() {
    for bytes in [stl_text(&torus()).into_bytes(), stl_binary(&torus())] {
        let shape = parse(bytes, "a.stl").unwrap();
        assert_is_loose_torus(&shape);
        assert!(shape.repairs()[0].message.starts_with("320 of the 384 corners of loose triangles"));
    }
}

#[test]
fn a_binary_file_is_binary_whatever_its_header_begins_with() {
    for header in ["solid", "solid \n", "SOLID facet normal 0 0 1\n outer loop\n", "", "COLOR=\0\0\0\0"] {
        let mut bytes = stl_binary(&torus());
        bytes[..80].fill(0);
        bytes[..header.len()].copy_from_slice(header.as_bytes());
        assert_is_loose_torus(&parse(&bytes, "a.stl").unwrap());
        assert_eq!(refused(parse(&bytes[..bytes.len() - 1], "a.stl")).0, "truncated-file", "{header}");
    }
}

#[test]
fn text_of_any_case_indentation_and_line_end_is_read() {
    let text = stl_text(&torus());
    assert_is_loose_torus(&parse(text.to_uppercase(), "a.stl").unwrap());
    assert_is_loose_torus(&parse(text.replace("  ", "\t").replace('\n', "\r\n"), "a.stl").unwrap());
    assert_is_loose_torus(&parse(text.replace("  ", "").replace('\n', "\n\n"), "a.stl").unwrap());
    assert_is_loose_torus(&parse(format!("\n {text}"), "a").unwrap());
    assert_is_loose_torus(&parse(text.replace(" made by a test", ""), "a").unwrap());
}

#[test]
fn several_solids_are_joined() {
    let mut moved = torus();
    moved.points.iter_mut().for_each(|p| p[0] += 10.0);
    let shape = parse(stl_text(&torus()) + &stl_text(&moved), "a.stl").unwrap();
    assert_eq!((shape.points().len(), repaired(&shape, "separate-pieces")), (768, 2));
}

#[test]
fn loops_of_other_than_three_corners_become_triangles_or_are_counted() {
    let mut text = String::from("solid\n");
    let corner = |i: u32| torus().points[i as usize].map(|c| c.to_string()).join(" ");
    for q in torus().faces.chunks(2) {
        let corners = [q[0][0], q[0][1], q[0][2], q[1][2]].map(|i| format!("vertex {}\n", corner(i)));
        text += &format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat());
    }
    text += &format!("facet normal 0 0 0\nouter loop\nvertex {}\nendloop\nendfacet\nendsolid\n", corner(0));
    let shape = parse(text, "a.stl").unwrap();
    assert_eq!((shape.points().len(), shape.faces().len()), (257, 128));
    assert_eq!((repaired(&shape, "polygons-triangulated"), repaired(&shape, "short-faces")), (64, 1));
    assert_eq!((repaired(&shape, "duplicate-points"), repaired(&shape, "separate-pieces")), (193, 0));
}

#[test]
fn a_file_cut_off_says_what_it_promised_and_where_it_ended() {
    let (code, message, details) = refused(parse(&stl_binary(&torus())[..84 + 50 * 41 + 7], "a.stl"));
    assert_eq!(code, "truncated-file");
    assert_eq!(message, "STL promises 128 triangles, the file ends after 41 (byte 2141); it may be cut off");
    assert_eq!((&details["promised"], &details["found"], &details["byte"]), (&128.into(), &41.into(), &2141.into()));
    assert_eq!(refused(parse([0; 40], "a.stl")).2["promised"], 84);

    let lines: Vec<String> = stl_text(&torus()).lines().map(String::from).collect();
    for (end, last) in
        [(1 + 7 * 12, ""), (1 + 7 * 12 + 3, ""), (1 + 7 * 12 + 3, "\nvertex 1 2"), (1 + 7 * 12 + 5, "\nendlo")]
    {
        let (code, message, details) = refused(parse(lines[..end].join("\n") + last, "a.stl"));
        assert_eq!(code, "truncated-file", "{message}");
        let line = end + usize::from(!last.is_empty());
        assert_eq!(
            message,
            format!("STL, line {line}: the file ends after 12 facets without endsolid; it may be cut off")
        );
        assert_eq!((&details["found"], &details["line"]), (&12.into(), &line.into()));
    }
}

#[test]
fn counts_larger_or_smaller_than_the_file_are_noticed() {
    let with = |count: u32| {
        let mut bytes = stl_binary(&torus());
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        parse(bytes, "a.stl")
    };
    for lie in [129, 70_000, u32::MAX >> 8] {
        assert_eq!(refused(with(lie)).0, "truncated-file");
    }
    let shape = with(120).unwrap();
    assert_eq!((shape.faces().len(), repaired(&shape, "trailing-data")), (120, 400));
    assert_eq!(refused(with(0)).0, "missing-element");
}

#[test]
fn what_is_not_stl_is_refused_with_its_line() {
    let with = |from: &str, to: &str| refused(parse(stl_text(&torus()).replacen(from, to, 1), "a.stl"));
    assert_eq!(with("vertex 3 0 0", "vertex 3 zero 0").1, "STL, line 4: “zero” is not a number");
    assert_eq!(with("vertex 3 0 0", "vertex 3 0").1, "STL, line 4: a vertex needs 3 values, the line has 2");
    assert_eq!(with("vertex 3 0 0", "vertex 3 nan 0").0, "not-finite");
    assert_eq!(with("outer loop", "inner loop").1, "STL, line 3: “inner loop” is not a line a text STL can have");
    assert_eq!(with("endloop\n", "\n").1, "STL, line 8: “endfacet” stands where vertex or endloop must");
    assert_eq!(refused(parse("solid empty\nendsolid empty\n", "a.stl")).1, "this STL has no facet with vertices");
}
