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
    for lie in [129, 140, 70_000, u32::MAX >> 8] {
        assert_eq!(refused(with(lie)).0, "truncated-file");
    }
    let shape = with(120).unwrap();
    assert_eq!((shape.faces().len(), repaired(&shape, "count-wrong")), (128, 8));
    let mut bytes = stl_binary(&torus());
    bytes.extend([7; 21]);
    let shape = parse(&bytes, "a.stl").unwrap();
    assert_eq!((shape.faces().len(), repaired(&shape, "trailing-data")), (128, 21));
    // Fifty bytes that can be no triangle of this body.
    bytes.truncate(bytes.len() - 21);
    bytes.extend([0x7E; 50]);
    let shape = parse(&bytes, "a.stl").unwrap();
    assert_eq!((shape.faces().len(), repaired(&shape, "trailing-data")), (128, 50));
}

#[test]
fn a_binary_file_whose_count_was_never_filled_in_is_read_whole() {
    for count in [0, u32::MAX, i32::MAX as u32] {
        for header in ["solid", "exported"] {
            let mut bytes = stl_binary(&torus());
            bytes[..80].fill(b' ');
            bytes[..header.len()].copy_from_slice(header.as_bytes());
            bytes[80..84].copy_from_slice(&count.to_le_bytes());
            for name in ["a.stl", "a"] {
                let shape = parse(&bytes, name).unwrap_or_else(|e| panic!("{count} {header} {name}: {e}"));
                assert_eq!(shape.points(), soup(&torus()).points);
                assert_eq!(repaired(&shape, "count-wrong"), count.abs_diff(128) as usize);
            }
            let cut = refused(parse(&bytes[..bytes.len() - 20], "a.stl"));
            assert_eq!(cut.0, "truncated-file", "{}", cut.1);
        }
    }
    assert_eq!(refused(parse([0; 84], "a.stl")).0, "missing-element");
}

#[test]
fn text_is_a_stream_of_words_whatever_lines_they_stand_in() {
    let text = stl_text(&torus());
    let bare = text.replace(" made by a test", "");
    for (what, text) in [
        ("end loop", text.replace("endloop", "end loop").replace("endfacet", "end facet")),
        ("end solid with a name", text.replace("endsolid", "end solid")),
        ("endsolid and a name in one word", text.replace("endsolid made", "endsolidmade")),
        ("solid and a name in one word", text.replacen("solid made", "solidmade", 1)),
        ("one line", text.replace('\n', " ")),
        ("one line without names", bare.replace('\n', " ")),
        ("one line in capitals", text.replace('\n', "\t").to_uppercase()),
        ("a word in every line", bare.split_whitespace().collect::<Vec<_>>().join("\r\n")),
        ("OUTER LOOP in capitals", text.replace("outer loop", "OUTER LOOP").replace("vertex", "VERTEX")),
        ("normals that are no numbers", text.replace("normal 0 0 0", "normal -nan(ind) nan 1.#IND")),
        ("normals with decimal commas", text.replace("normal 0 0 0", "normal 0,5 0,5 0,7")),
        ("facets without normals", text.replace("facet normal 0 0 0", "facet")),
        ("a name that has keywords in it", text.replace("made by a test", "solid facet of a solid loop")),
        ("the name of the end has the word solid", text.replace("endsolid made by a test", "endsolid my solid body")),
        ("comments", text.replacen("outer", "# a comment\nouter", 1)),
    ] {
        let shape = parse(&text, "a.stl").unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_is_loose_torus(&shape);
    }
}

#[test]
fn what_follows_the_last_solid_is_passed_over_and_said_so() {
    let shape = parse(stl_text(&torus()) + "exported in 3 s\n\x1A\n", "a.stl").unwrap();
    assert_eq!((shape.faces().len(), repaired(&shape, "trailing-data")), (128, 2));
}

#[test]
fn several_solids_in_one_line_are_joined() {
    let mut moved = torus();
    moved.points.iter_mut().for_each(|p| p[0] += 10.0);
    let text = (stl_text(&torus()) + &stl_text(&moved)).replace('\n', " ");
    assert_eq!(parse(text, "a.stl").unwrap().points().len(), 768);
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
