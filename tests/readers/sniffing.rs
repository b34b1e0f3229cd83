use geose_fmap::{Format, read};

use crate::sample::{all_formats, assert_is_torus, off, parse, refused, torus};

#[test]
fn every_format_gives_back_exactly_what_was_written() {
    for (name, bytes) in all_formats() {
        assert_is_torus(&parse(bytes, name).unwrap_or_else(|e| panic!("{name}: {e}")));
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
fn the_extension_decides_where_bytes_do_not() {
    let headless = off(&torus()).replacen("OFF\n", "", 1);
    assert_is_torus(&parse(&headless, "scan.OFF").unwrap());
    assert_eq!(refused(parse(&headless, "scan")).0, "unknown-format");
}

#[test]
fn a_format_that_is_asked_for_is_not_guessed() {
    let (code, message, _) = refused(read(off(&torus()).as_bytes(), None, Some(Format::Ply)));
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
    assert!(message.contains("OFF, PLY, OBJ, GLB or glTF") && message.contains("PNG"), "{message}");
    for format in Format::ALL {
        let refusal = read(b"\x01\x02\x03 not a scan \xff\xfe", None, Some(format)).expect_err("garbage");
        assert!(["malformed-file", "missing-element"].contains(&refusal.code()), "{refusal}");
    }
}

#[test]
fn formats_are_named_by_their_extension() {
    for format in Format::ALL {
        assert_eq!(format.extension().parse::<Format>().unwrap(), format);
    }
    assert_eq!("dwg".parse::<Format>().unwrap_err().code(), "unknown-format-name");
}
