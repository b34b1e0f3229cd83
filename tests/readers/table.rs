use geose_fmap::Shape;

use crate::sample::{csv, parse, pts, refused, repaired, torus, xyz};

fn assert_is_cloud(shape: &Shape) {
    assert_eq!((shape.points(), shape.faces().len()), (&torus().points[..], 0));
}

/// A row per point of the torus, under what stands before.
fn rows(before: &str, row: impl Fn([f64; 3]) -> String) -> String {
    torus().points.into_iter().fold(before.to_owned(), |text, p| text + &row(p) + "\n")
}

#[test]
fn any_separator_and_line_end_is_read() {
    for separator in [" ", "   ", "\t", " \t ", ",", ", ", " ,", ";", "; "] {
        let text = rows("", |p| p.map(|c| c.to_string()).join(separator));
        for text in [text.clone(), text.replace('\n', "\r\n"), text.replace('\n', "\r"), text.trim_end().to_owned()] {
            for name in ["a.xyz", "a.pts", "a.csv", "a.txt"] {
                let shape = parse(&text, name).unwrap_or_else(|e| panic!("{separator:?} {name}: {e}"));
                assert_is_cloud(&shape);
                assert_eq!(shape.repairs(), []);
            }
        }
    }
}

#[test]
fn comments_and_blank_lines_are_passed_over() {
    let text = xyz(&torus()).replacen('\n', " # the first\n\n# x marks the spot\n// and\n% so on\n", 1);
    let shape = parse(format!("# a cloud\n{text}"), "a.xyz").unwrap();
    assert_is_cloud(&shape);
    assert_eq!(shape.repairs(), []);
}

#[test]
fn columns_beside_the_coordinates_are_ignored_and_said_so() {
    let shape = parse(rows("", |[x, y, z]| format!("{x} {y} {z} 0.5 10 20 grey")), "a.xyz").unwrap();
    assert_is_cloud(&shape);
    assert_eq!((shape.repairs().len(), repaired(&shape, "columns-ignored")), (1, 4));
    assert_eq!(shape.repairs()[0].message, "4 columns beside x, y and z not read");
    let shape = parse(rows("X;Y;Z;nx\n", |[x, y, z]| format!("{x};{y};{z};")), "a.csv").unwrap();
    assert_is_cloud(&shape);
    assert_eq!(shape.repairs()[0].message, "1 column beside x, y and z not read: nx");
}

#[test]
fn a_header_says_where_the_coordinates_are() {
    let row = |[x, y, z]: [f64; 3]| format!("7,{z},{x},red,{y}");
    for header in
        ["id,z,x,colour,y\n", "\"id\",\"Z\",\"X\",\"colour\",\"Y\"\n", "//id,z,x,colour,y\n", "# id z x colour y\n"]
    {
        let shape = parse(rows(header, row), "a.csv").unwrap_or_else(|e| panic!("{header}: {e}"));
        assert_is_cloud(&shape);
        assert_eq!(shape.repairs()[0].message, "2 columns beside x, y and z not read: id, colour");
    }
    // As pandas writes it: the index has no name.
    assert_is_cloud(&parse(rows(",x,y,z\n", |[x, y, z]| format!("0,{x},{y},{z}")), "a.csv").unwrap());
    let (code, message, _) = refused(parse(rows("id,x,y,z,w\n", |[x, y, z]| format!("{x},{y},{z},1")), "a.csv"));
    assert_eq!(
        (code, message.as_str()),
        ("malformed-file", "CSV, line 1: the header names 5 columns, the first point has 4")
    );
}

#[test]
fn a_title_that_names_no_columns_is_passed_over_and_said_so() {
    let shape = parse(format!("Scan of a torus\n{}", xyz(&torus())), "a.xyz").unwrap();
    assert_is_cloud(&shape);
    assert_eq!(
        shape.repairs()[0].message,
        "line 1 (“Scan of a torus”) names no x, y and z, so the first three columns are taken for them"
    );
    assert_eq!(refused(parse(format!("one\ntwo\n{}", xyz(&torus())), "a.xyz")).0, "short-line");
}

#[test]
fn a_count_is_checked_against_what_is_there() {
    for name in ["a.pts", "a.xyz"] {
        assert_eq!(parse(pts(&torus()), name).unwrap().repairs(), []);
        assert_eq!(parse(format!("64\nx y z\n{}", xyz(&torus())), name).unwrap().repairs(), []);
        assert_eq!(parse(format!("x y z\n64\n{}", xyz(&torus())), name).unwrap().repairs(), []);
    }
    let (code, message, _) = refused(parse(format!("65\n{}", xyz(&torus())), "a.pts"));
    assert_eq!(code, "truncated-file");
    assert_eq!(message, "PTS promises 65 points, the file ends after 64 (line 65); it may be cut off");
    for lie in ["4000000000", "9223372036854775807"] {
        assert_eq!(refused(parse(format!("{lie}\n{}", xyz(&torus())), "a.pts")).0, "truncated-file");
    }
    let shape = parse(format!("60\n{}", xyz(&torus())), "a.pts").unwrap();
    assert_is_cloud(&shape);
    assert_eq!(repaired(&shape, "count-wrong"), 4);
    assert_eq!(shape.repairs()[0].message, "this PTS announces 60 points and has 64; all of them are read");
}

#[test]
fn several_counted_scans_are_joined() {
    let shape = parse(pts(&torus()) + &pts(&torus()), "a.pts").unwrap();
    assert_eq!((shape.points().len(), repaired(&shape, "duplicate-points")), (128, 64));
    assert_eq!(shape.repairs().len(), 1);
    assert_eq!(refused(parse(pts(&torus()) + "64\n1 2 3\n", "a.pts")).2["promised"], 128);
}

#[test]
fn a_last_line_that_breaks_off_is_noticed() {
    let (code, message, _) = refused(parse(xyz(&torus()) + "1 2", "a.xyz"));
    assert_eq!(code, "truncated-file");
    assert_eq!(
        message,
        "XYZ, line 65: the file ends after 64 points without the rest of its last line; it may be cut off"
    );
}

#[test]
fn wrong_numbers_and_lines_are_refused_with_their_place() {
    let with = |line: &str| refused(parse(xyz(&torus()).replacen("3 0 0", line, 1), "a.xyz"));
    assert_eq!(with("3 zero 0").1, "XYZ, line 1: “zero” is not a number");
    assert_eq!(with("3,5 0,0 0,1").1, "XYZ, line 1: “3,5” is not a number (decimals are written with a point)");
    assert_eq!(with("3,5;0,0;0,1").1, "XYZ, line 1: “3,5” is not a number (decimals are written with a point)");
    assert_eq!(with("3 nan 0").0, "not-finite");
    assert_eq!(with("3 0").1, "XYZ, line 1: a point needs 3 values, the line has 2");
    assert_eq!(with("3 0 0\n1 2").1, "XYZ, line 2: a point needs 3 values, the line has 2");
    assert_eq!(with("3 0 0\n1 2 3 4").1, "XYZ, line 2: the line has 4 columns, and the first point has 3");
    assert_eq!(with("3 0 0\n12").1, "XYZ, line 2: a point needs 3 values, the line has 1");
    assert_eq!(
        refused(parse(csv(&torus()).replacen("3,0,0", "3,,0", 1), "a.csv")).1,
        "CSV, line 2: “” is not a number"
    );
    assert_eq!(refused(parse("# nothing\n\n", "a.csv")).1, "this CSV has no line with the coordinates of a point");
    assert_eq!(refused(parse("0\n", "a.pts")).0, "missing-element");
}
