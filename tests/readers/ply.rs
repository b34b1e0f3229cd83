use crate::sample::{Sample, assert_is_torus, parse, ply_binary, ply_text, refused, repaired, torus};

/// A binary PLY of the torus with odd types, odd extras and labels.
fn elaborate(label: &str, labels: impl Fn(usize) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = format!(
        "ply\r\nformat binary_little_endian 1.0\r\nobj_info x\r\nelement camera 2\r\nproperty float32 f\r\n\
         property list uint16 int8 names\r\nelement vertex 64\r\nproperty uchar red\r\nproperty double x\r\nproperty double y\r\n\
         property {label} label\r\nproperty list uchar float w\r\nproperty double z\r\nelement nothing 4000000000\r\n\
         element face 128\r\nproperty list uint uint16 vertex_index\r\nproperty int8 flag\r\nend_header\r\n"
    )
    .into_bytes();
    for _ in 0..2 {
        bytes.extend([0, 0, 128, 63, 3, 0, 7, 8, 9]);
    }
    for (i, p) in torus().points.iter().enumerate() {
        bytes.push(200);
        bytes.extend(p[0].to_le_bytes());
        bytes.extend(p[1].to_le_bytes());
        bytes.extend(labels(i));
        bytes.push((i % 3) as u8);
        bytes.extend(std::iter::repeat_n(0, 4 * (i % 3)));
        bytes.extend(p[2].to_le_bytes());
    }
    for face in torus().faces {
        bytes.extend(3_u32.to_le_bytes());
        face.iter().for_each(|i| bytes.extend((*i as u16).to_le_bytes()));
        bytes.push(1);
    }
    bytes
}

#[test]
fn extra_elements_and_properties_of_any_type_are_passed_over() {
    assert_is_torus(&parse(elaborate("uchar", |_| vec![0]), "a.ply").unwrap());
}

#[test]
fn labels_of_any_integer_type_are_kept() {
    let expected: Vec<u32> = (0..64).map(|i| i / 5).collect();
    for (name, size) in [("char", 1), ("uint8", 1), ("short", 2), ("ushort", 2), ("int", 4), ("uint32", 4)] {
        let shape = parse(elaborate(name, |i| (i as u32 / 5).to_le_bytes()[..size].to_vec()), "a.ply").unwrap();
        assert_eq!(shape.labels(), Some(&expected[..]), "{name}");
    }
}

#[test]
fn labels_that_are_not_counts_are_reported_and_left_out() {
    let shape = parse(elaborate("char", |i| vec![if i == 9 { 255 } else { 1 }]), "a.ply").unwrap();
    assert_eq!(shape.labels(), None);
    assert_eq!(repaired(&shape, "labels-ignored"), 1);
    assert!(shape.repairs()[0].message.contains("label -1 of point 9"));
}

#[test]
fn windows_line_ends_are_read_in_text() {
    assert_is_torus(&parse(ply_text(&torus()).replace('\n', "\r\n"), "a.ply").unwrap());
}

#[test]
fn a_file_without_faces_is_a_cloud() {
    let cloud = Sample { faces: vec![], ..torus() };
    for bytes in [ply_text(&cloud).into_bytes(), ply_binary(&cloud, true)] {
        assert_eq!(parse(bytes, "a.ply").unwrap().faces(), [[0; 3]; 0]);
    }
}

#[test]
fn polygons_become_triangles() {
    let quads: String =
        torus().faces.chunks(2).map(|q| format!("4 {} {} {} {}\n", q[0][0], q[0][1], q[0][2], q[1][2])).collect();
    let text = ply_text(&Sample { faces: vec![], ..torus() }).replace("face 0", "face 64") + &quads;
    let shape = parse(text, "a.ply").unwrap();
    assert_eq!(shape.faces(), torus().faces);
    assert_eq!(repaired(&shape, "polygons-triangulated"), 64);
}

#[test]
fn a_file_cut_off_says_what_it_promised_and_where_it_ended() {
    let bytes = ply_binary(&torus(), false);
    let header = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let (code, message, details) = refused(parse(&bytes[..header + 12 * 41 + 5], "a.ply"));
    assert_eq!(code, "truncated-file");
    assert!(message.starts_with("PLY promises 64 vertices, the file ends after 41 (byte "), "{message}");
    assert_eq!(details["byte"], header + 12 * 41 + 5);

    let text: Vec<String> = ply_text(&torus()).lines().map(String::from).collect();
    let (_, message, _) = refused(parse(text[..10 + 64 + 3].join("\n"), "a.ply"));
    assert_eq!(message, "PLY promises 128 faces, the file ends after 3 (line 77); it may be cut off");
    assert_eq!(refused(parse(text[..6].join("\n"), "a.ply")).0, "malformed-file");
}

#[test]
fn counts_larger_than_the_file_cost_no_memory() {
    for bytes in [ply_text(&torus()).into_bytes(), ply_binary(&torus(), false), ply_binary(&torus(), true)] {
        for (honest, lie) in [("vertex 64", "vertex 4000000000"), ("face 128", "face 18446744073709551615")] {
            let lying = String::from_utf8_lossy(&bytes[..200]).replace(honest, lie).into_bytes();
            assert_eq!(refused(parse([&lying, &bytes[200..]].concat(), "a.ply")).0, "truncated-file");
        }
    }
    let list = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint double l\nproperty float x\n\
                property float y\nproperty float z\nend_header\n";
    assert_eq!(refused(parse([list.as_bytes(), &[255; 60]].concat(), "a.ply")).0, "truncated-file");
}

#[test]
fn wrong_numbers_and_short_lines_are_refused_with_their_line() {
    let with = |v: &str| refused(parse(ply_text(&torus()).replacen("\n3 0 0\n", v, 1), "a.ply"));
    assert_eq!(with("\n3 0 oops\n").1, "PLY, line 11: “oops” is not a number");
    assert_eq!(with("\n3 0\n").1, "PLY, line 11: a record of the element “vertex” needs 3 values, the line has 2");
    assert_eq!(with("\n3 inf 0\n").0, "not-finite");
    let with = |f: &str| refused(parse(ply_text(&torus()).replacen("3 0 8 9\n", f, 1), "a.ply"));
    assert_eq!(with("3 0 8 64\n").1, "PLY, line 75: face 0 names point 64, but the file has 64 points (0 to 63)");
    assert_eq!(with("3 0 8.5 9\n").1, "PLY, line 75: “8.5” is not a whole number");
    assert_eq!(with("-3 0 8 9\n").1, "PLY, line 75: “-3” is not a count");
}

#[test]
fn headers_that_make_no_sense_are_refused_with_their_line() {
    let with = |from: &str, to: &str| refused(parse(ply_text(&torus()).replacen(from, to, 1), "a.ply"));
    assert_eq!(with("property double y\n", "").1, "this PLY has no property “y” of the element “vertex”");
    assert_eq!(with("element vertex", "element point").1, "this PLY has no element “vertex”");
    assert_eq!(with("vertex_indices", "corners").1, "this PLY has no list “vertex_indices” of the element “face”");
    assert_eq!(with("format ascii 1.0\n", "").1, "this PLY has no line “format” in its header");
    assert_eq!(with("double x", "triple x").1, "PLY, line 5: “property triple x” is not a line a PLY header can have");
    assert_eq!(with("list uchar", "list float").0, "malformed-file");
    assert_eq!(with("element vertex 64\n", "").1, "PLY, line 4: a property stands before any element");
    assert_eq!(with("vertex 64", "vertex many").1, "PLY, line 4: “many” is not a count");
    assert_eq!(with("element face", "element vertex").0, "malformed-file");
}

#[test]
fn what_is_left_over_or_not_understood_is_reported() {
    assert_eq!(repaired(&parse(ply_text(&torus()) + "1 2 3\n", "a.ply").unwrap(), "trailing-data"), 5);
    let strips = ply_text(&Sample { faces: vec![], ..torus() }).replace("element face 0", "element tristrips 1")
        + "4 0 1 2 -1\n";
    assert_eq!(repaired(&parse(strips, "a.ply").unwrap(), "triangle-strips"), 1);
}

#[test]
fn types_of_any_width_are_passed_over_or_read() {
    for (name, size) in [
        ("bool", 1),
        ("int64", 8),
        ("uint64", 8),
        ("long", 8),
        ("int64_t", 8),
        ("half", 2),
        ("float16", 2),
        ("ubyte", 1),
    ] {
        let bytes = elaborate(name, |_| vec![0; size]);
        let unread = String::from_utf8_lossy(&bytes[..600]).replacen(" label", " stamp", 1).into_bytes();
        let header = unread.windows(10).position(|w| w == b"end_header").unwrap();
        let begin = bytes.windows(10).position(|w| w == b"end_header").unwrap();
        assert_is_torus(&parse([&unread[..header], &bytes[begin..]].concat(), "a.ply").unwrap());
    }
    let expected: Vec<u32> = (0..64).map(|i| i / 5).collect();
    for name in ["int64", "uint64"] {
        let shape = parse(elaborate(name, |i| (i as u64 / 5).to_le_bytes().to_vec()), "a.ply").unwrap();
        assert_eq!(shape.labels(), Some(&expected[..]), "{name}");
    }
    let shape = parse(elaborate("half", |i| vec![0, if i % 2 == 0 { 0 } else { 0x3C }]), "a.ply").unwrap();
    assert_eq!(&shape.labels().unwrap()[..3], [0, 1, 0]);
    let stamps = ply_text(&torus()).replacen(
        "property double x",
        "property int64 stamp\nproperty bool good\nproperty double x",
        1,
    );
    let (header, body) = stamps.split_once("end_header\n").unwrap();
    let body: Vec<String> = body
        .lines()
        .enumerate()
        .map(|(i, line)| if i < 64 { format!("5176470752{i:03} true {line}") } else { line.to_owned() })
        .collect();
    assert_is_torus(&parse(format!("{header}end_header\n{}\n", body.join("\n")), "a.ply").unwrap());
}

/// A property and its value for each point.
type Column = (&'static str, fn(usize) -> String);

/// A text PLY of the torus with these columns behind its coordinates.
fn with_columns(columns: &[Column]) -> String {
    let text = ply_text(&torus());
    let (header, body) = text.split_once("end_header\n").unwrap();
    let declared: String = columns.iter().map(|(name, _)| format!("property float {name}\n")).collect();
    let header = header.replacen("element face", &format!("{declared}element face"), 1);
    let rows = body.lines().enumerate().map(|(i, line)| match i {
        0..64 => columns.iter().fold(line.to_owned(), |row, (_, value)| row + " " + &value(i)) + "\n",
        _ => format!("{line}\n"),
    });
    format!("{header}end_header\n{}", rows.collect::<String>())
}

#[test]
fn labels_are_taken_under_what_programs_call_them() {
    let expected: Vec<u32> = (0..64).map(|i| i / 5).collect();
    for name in [
        "scalar_label",
        "scalar_Label",
        "segment_id",
        "class",
        "Classification",
        "part",
        "scalar_segment_id",
        "semantic",
    ] {
        let shape = parse(with_columns(&[(name, |i| format!("{}.000000", i / 5))]), "a.ply").unwrap();
        assert_eq!(shape.labels(), Some(&expected[..]), "{name}");
        assert_eq!(shape.repairs(), [], "{name}");
    }
    let both: [Column; 2] = [("class", |i| (i % 2).to_string()), ("label", |i| (i / 5).to_string())];
    let shape = parse(with_columns(&both), "a.ply").unwrap();
    assert_eq!(shape.labels(), Some(&expected[..]), "what is called label comes first");
    assert_eq!(repaired(&shape, "label-columns-ignored"), 1);
    assert!(shape.repairs()[0].message.contains("“label”") && shape.repairs()[0].message.ends_with("“class”"));
}

#[test]
fn columns_that_look_like_labels_and_are_not_taken_are_named() {
    let shape = parse(with_columns(&[("scalar_my_label_2", |i| i.to_string())]), "a.ply").unwrap();
    assert_eq!(shape.labels(), None);
    assert!(shape.repairs()[0].message.contains("“scalar_my_label_2”"), "{:?}", shape.repairs());
    let shape = parse(with_columns(&[("scalar_label", |i| format!("{i}.5"))]), "a.ply").unwrap();
    assert_eq!((shape.labels(), repaired(&shape, "labels-ignored")), (None, 1));
    let shape = parse(with_columns(&[("class", |_| "3".to_owned())]), "a.ply").unwrap();
    assert_eq!((shape.labels(), repaired(&shape, "label-columns-ignored")), (None, 1), "one value tells nothing apart");
}

#[test]
fn headers_as_they_come_are_read() {
    let text = ply_text(&torus());
    for (from, to) in [
        ("comment made", "made"),
        ("comment made by a test\n", ""),
        ("comment made by a test\n", "\n\nVCGLIB generated (2024)\n"),
        ("ply\n", "PLY \n"),
        ("end_header", "END_HEADER \t"),
        ("format ascii 1.0", "format ASCII 1.0"),
        ("element vertex", "Element Vertex"),
        ("property double x", "property double X"),
        ("property list uchar int vertex_indices", "property\tlist  uchar int vertex_index "),
    ] {
        let shape = parse(text.replacen(from, to, 1), "a.ply").unwrap_or_else(|e| panic!("{to:?}: {e}"));
        assert_eq!((shape.points(), shape.faces()), (&torus().points[..], &torus().faces[..]), "{to:?}");
        let strange = usize::from(to.starts_with("made") || to.contains("VCGLIB"));
        assert_eq!(repaired(&shape, "header-lines-ignored"), strange, "{to:?}");
    }
}

#[test]
fn data_begins_behind_the_line_end_that_the_header_uses() {
    // The first coordinate of a big-endian file may begin with the byte of a line feed.
    let mut moved = torus();
    moved.points[0] = [f64::from(f32::from_be_bytes([10, 0, 0, 1])), 1.0, 0.0];
    for end in ["\n", "\r", "\r\n"] {
        let bytes = ply_binary(&moved, true);
        let at = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let header = String::from_utf8_lossy(&bytes[..at]).replace('\n', end);
        let shape =
            parse([header.as_bytes(), &bytes[at..]].concat(), "a.ply").unwrap_or_else(|e| panic!("{end:?}: {e}"));
        assert_eq!((shape.points(), shape.faces()), (&moved.points[..], &moved.faces[..]), "{end:?}");
    }
}

#[test]
fn points_that_are_no_numbers_stay_points_of_the_file() {
    for nan in ["nan", "-nan", "-nan(ind)", "1.#IND"] {
        let ply = ply_text(&torus()).replacen("\n3 0 0\n", &format!("\n3 {nan} 0\n"), 1);
        let off = crate::sample::off(&torus()).replacen("\n3 0 0\n", &format!("\n3 {nan} 0\n"), 1);
        let obj = crate::sample::obj(&torus()).replacen("v 3 0 0\n", &format!("v 3 {nan} 0\n"), 1);
        for (text, name) in [(ply, "a.ply"), (off, "a.off"), (obj, "a.obj")] {
            let (code, message, details) = refused(parse(text, name));
            assert_eq!((code, &details["index"]), ("not-finite", &0.into()), "{name}, {nan}: {message}");
        }
    }
}
