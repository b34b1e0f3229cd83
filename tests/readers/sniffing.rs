use geose_fmap::{Format, read};

use crate::sample::{
    all_files, all_formats, assert_is_torus, csv, off, parse, refused, stl_binary, stl_text, torus, xyz,
};

#[test]
fn every_format_gives_back_exactly_what_was_written() {
    for (name, bytes, expected) in all_files() {
        let shape = parse(bytes, name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((shape.points(), shape.faces()), (&expected.points[..], &expected.faces[..]), "{name}");
        let said: Vec<_> = shape.repairs().iter().map(|r| r.code.as_str()).collect();
        assert_eq!(said, if name.ends_with("stl") { vec!["corners-joined"] } else { vec![] }, "{name}");
    }
}

#[test]
fn every_format_is_known_by_its_bytes_whatever_it_is_called() {
    for (name, bytes) in all_formats() {
        for wrong in [None, Some("scan.txt"), Some("scan.ply"), Some("scan.off")] {
            assert_is_torus(&read(&bytes, wrong, None).unwrap_or_else(|e| panic!("{name} as {wrong:?}: {e}")));
        }
    }
}

#[test]
fn an_stl_is_known_by_its_first_word_or_by_its_length_and_a_table_by_its_looks() {
    let mut unmarked = stl_binary(&torus());
    unmarked[..80].fill(b'x');
    for bytes in [stl_text(&torus()).into_bytes(), stl_binary(&torus()), unmarked.clone()] {
        for wrong in [None, Some("scan.obj"), Some("scan.ply")] {
            assert_eq!(read(&bytes, wrong, None).unwrap().faces().len(), 128);
        }
    }
    assert_eq!(refused(parse(&unmarked[..1000], "scan")).0, "unknown-format");
    assert_eq!(refused(parse(&unmarked[..1000], "scan.STL")).0, "truncated-file");
    for text in [xyz(&torus()), csv(&torus())] {
        for name in ["scan", "scan.txt", "scan.asc"] {
            assert_eq!(parse(&text, name).unwrap().points(), torus().points);
        }
        assert_eq!(refused(parse(&text, "scan.ply")).0, "malformed-file", "a table announces nothing, so a name wins");
    }
    for prose in ["Dear reader,\n1 2\n", "1 2 three\n4 5 6\n", "2024-01-01 report\n"] {
        assert_eq!(refused(parse(prose, "scan")).0, "unknown-format");
    }
}

#[test]
fn the_extension_decides_where_bytes_do_not() {
    let headless = off(&torus()).replacen("OFF\n", "", 1);
    assert_is_torus(&parse(&headless, "scan.OFF").unwrap());
    // Without a name it is taken for a table of points, until the faces have four columns.
    let (code, message, _) = refused(parse(&headless, "scan"));
    assert_eq!(
        (code, message.as_str()),
        ("malformed-file", "XYZ, line 66: the line has 4 columns, and the first point has 3")
    );
}

#[test]
fn a_format_that_is_asked_for_is_not_guessed() {
    let (code, message, _) =
        refused(read(off(&torus()).as_bytes(), None, Some(Format::Ply)).map_err(geose_fmap::Error::from));
    assert_eq!(code, "malformed-file");
    assert_eq!(message, "PLY, line 1: the file begins with “OFF·64 128 0·3 0” where ply must stand");
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    assert_is_torus(&parse(["\u{feff}", &off(&torus())].concat(), "a").unwrap());
}

#[test]
fn nothing_and_garbage_are_refused_with_what_was_expected() {
    assert_eq!(refused(parse("", "a.ply")).0, "empty-file");
    let (code, message, _) = refused(parse([0x89, b'P', b'N', b'G', 13, 10, 26, 10], "a.png"));
    assert_eq!(code, "unknown-format");
    assert!(message.contains("STL, GLB, glTF, XYZ, PTS or CSV") && message.contains("PNG"), "{message}");
    for format in Format::ALL {
        let refusal = read(b"\x01\x02\x03 not a scan \xff\xfe", None, Some(format)).expect_err("garbage");
        assert!(
            ["malformed-file", "missing-element", "truncated-file", "bad-number"].contains(&refusal.code()),
            "{refusal}"
        );
    }
}

#[test]
fn formats_are_named_by_their_extension() {
    for format in Format::ALL {
        assert_eq!(format.extension().parse::<Format>().unwrap(), format);
    }
    assert_eq!("dwg".parse::<Format>().unwrap_err().code(), "unknown-format-name");
}
