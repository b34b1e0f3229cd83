use geose_fmap::Shape;

use crate::sample::{parse, pts, refused, repaired, torus, xyz};

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
    let shape = parse(format!("one\ntwo\n{}", xyz(&torus())), "a.xyz").unwrap();
    assert!(shape.repairs()[0].message.starts_with("line 2 (“two”) names no x"));
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
    let placeless = parse(xyz(&torus()).replacen("3 0 0", "3 nan 0", 1), "a.xyz").expect("a cloud");
    assert_eq!((placeless.placeless(), repaired(&placeless, "points-without-place")), (&[0][..], 1));
    assert_eq!(with("3 0").1, "XYZ, line 1: a point needs 3 values, the line has 2");
    assert_eq!(with("3 0 0\n1 2").1, "XYZ, line 2: a point needs 3 values, the line has 2");
    assert_eq!(with("3 0 0\n1 2 3 4").1, "XYZ, line 2: the line has 4 columns, and the first point has 3");
    assert_eq!(with("3 0 0\n12").1, "XYZ, line 2: a point needs 3 values, the line has 1");
    assert_eq!(refused(parse("# nothing\n\n", "a.csv")).1, "this CSV has no line with the coordinates of a point");
    assert_eq!(refused(parse("0\n", "a.pts")).0, "missing-element");
}

/// The same row of every point under its number.
fn numbered(before: &str, row: impl Fn(usize, [String; 3]) -> String) -> String {
    let rows = torus().points.into_iter().enumerate().map(|(i, p)| row(i, p.map(|c| c.to_string())) + "\n");
    before.to_owned() + &rows.collect::<String>()
}

#[test]
fn coordinates_are_found_under_decorated_headings() {
    for (heading, order) in [
        ("x coord, y coord, z coord, scalar", "xyzs"),
        ("\"Normals:0\",\"Normals:1\",\"Normals:2\",\"Points:0\",\"Points:1\",\"Points:2\"", "nnnxyz"),
        ("id,X [mm],Y [mm],Z [mm]", "sxyz"),
        ("frame,pos_x,pos_y,pos_z", "fxyz"),
        ("X(m),Y(m),Z(m),nx,ny,nz", "xyznnn"),
        ("nx,ny,nz,x,y,z", "nnnxyz"),
        ("R,G,B,PositionX,PositionY,PositionZ", "nnnxyz"),
        ("Northing,Easting,Elevation", "yxz"),
        ("# exported\n# columns = id,x,y,z,ow,ox,oy,oz,vis,label,desc", "sxyznnnsstt"),
        ("Points:0;Points:1;Points:2;gr\u{f6}\u{df}e", "xyzs"),
        ("made by a scanner\nx,y,z\n[mm],[mm],[mm]", "xyz"),
    ] {
        let separator = if heading.contains(';') { ";" } else { "," };
        let text = numbered(&format!("{heading}\n"), |i, [x, y, z]| {
            let field = |c: char| match c {
                'x' => x.clone(),
                'y' => y.clone(),
                'z' => z.clone(),
                'n' => format!("0.{}", i % 7 + 1),
                's' => i.to_string(),
                'f' => "4".to_owned(),
                _ => "F-1".to_owned(),
            };
            order.chars().map(field).collect::<Vec<_>>().join(separator)
        });
        for text in [text.clone(), text.replace('\n', "\r\n"), text.replace(separator, "\t")] {
            let shape = parse(&text, "a.csv").unwrap_or_else(|e| panic!("{heading}: {e}"));
            assert_eq!(shape.points(), torus().points, "{heading}");
        }
    }
}

#[test]
fn columns_that_cannot_be_told_apart_are_refused_with_their_headings() {
    for heading in ["left_x,left_y,left_z,right_x,right_y,right_z", "a,b,c,d,e,f", "nx,ny,nz,r,g,b"] {
        let text = numbered(&format!("{heading}\n"), |i, [x, y, z]| format!("{x},{y},{z},{z},{x},0.{i}"));
        let (code, message, details) = refused(parse(text, "a.csv"));
        assert_eq!((code, &details["line"]), ("ambiguous-columns", &1.into()), "{message}");
        let first = heading.split(',').next().unwrap();
        assert!(
            message.contains(&format!("“{first}”")) && message.contains("call those three x, y and z"),
            "{message}"
        );
    }
    let text = numbered("lat,lon,alt\n", |_, [x, y, z]| format!("{x},{y},{z}"));
    assert_eq!(refused(parse(text, "a.csv")).0, "ambiguous-columns");
}

#[test]
fn row_numbers_without_a_heading_are_no_coordinates() {
    for first in [0, 1] {
        for (before, name) in [("", "a.csv"), ("", "a.txt"), ("64\n", "a.pts"), ("a title\n", "a.xyz")] {
            for separator in [",", " ", "\t", ";"] {
                let text = numbered(before, |i, [x, y, z]| [(i + first).to_string(), x, y, z].join(separator));
                let shape = parse(text, name).unwrap_or_else(|e| panic!("{before:?} {name} {separator:?}: {e}"));
                assert_is_cloud(&shape);
                assert_eq!(repaired(&shape, "row-numbers-ignored"), 1);
            }
        }
    }
    // Headings of everything but the row numbers, as R writes them.
    assert_is_cloud(
        &parse(numbered("\"x\" \"y\" \"z\"\n", |i, p| format!("\"{}\" {}", i + 1, p.join(" "))), "a.txt").unwrap(),
    );
    // Headings that are numbers, as pandas writes them.
    assert_is_cloud(&parse(numbered(",0,1,2\n", |i, p| format!("{i},{}", p.join(","))), "a.csv").unwrap());
    let decimals = |p: [String; 3]| p.map(|c| if c.contains('.') { c } else { c + ".0" }).join(",");
    assert_is_cloud(&parse(numbered("0,1,2\n", |_, p| decimals(p)), "a.csv").unwrap());
    // A frame's number, and names.
    assert_is_cloud(&parse(numbered("", |_, p| format!("17 {}", p.join(" "))), "a.xyz").unwrap());
    assert_is_cloud(&parse(numbered("", |i, p| format!("P{i},{}", p.join(","))), "a.csv").unwrap());
}

#[test]
fn row_numbers_with_gaps_or_in_any_order_are_no_coordinates() {
    let number: [fn(usize) -> String; 6] = [
        |i| (i + usize::from(i > 30)).to_string(),
        |i| (63 - i).to_string(),
        |i| (1000 + 7 * i).to_string(),
        |i| (37 * i % 64).to_string(),
        |i| (i / 8).to_string(),
        // As numpy saves a table, all columns alike.
        |i| format!("{:.18e}", 2 * i),
    ];
    let plain = |p: [String; 3], by: &str| p.join(by);
    for (k, number) in number.into_iter().enumerate() {
        for by in [",", " ", "\t", ";"] {
            let text = numbered("", |i, p| number(i) + by + &plain(p, by));
            let shape = parse(text, "a.csv").unwrap_or_else(|e| panic!("{k} {by:?}: {e}"));
            assert_is_cloud(&shape);
            assert_eq!((repaired(&shape, "row-numbers-ignored"), shape.repairs().len()), (1, 1), "{k} {by:?}");
            let text = numbered("", |i, p| number(i) + by + &plain(p.clone(), by) + by + &plain(p, by));
            assert_is_cloud(&parse(text, "a.txt").unwrap());
        }
        // With decimal commas, and what R and pandas write of some rows of a table.
        let comma = |p: [String; 3]| plain(p, ";").replace('.', ",");
        let commas = numbered("", |i, p| format!("{};{}", number(i).replace('.', ","), comma(p)));
        assert_is_cloud(&parse(commas, "a.csv").unwrap());
        let quoted = numbered("\"x\" \"y\" \"z\"\n", |i, p| format!("\"{}\" {}", number(i), plain(p, " ")));
        assert_is_cloud(&parse(quoted, "a.txt").unwrap());
        let nameless = numbered(",0,1,2\n", |i, p| format!("{},{}", number(i), plain(p, ",")));
        assert_is_cloud(&parse(nameless, "a.csv").unwrap());
    }
    // A coordinate may be zero everywhere, if it is written with decimals like the others.
    let flat = numbered("", |i, [x, y, _]| format!("{} {x} {y} 0.000", 2 * i));
    assert_eq!(repaired(&parse(flat, "a.xyz").unwrap(), "row-numbers-ignored"), 1);
}

#[test]
fn a_first_column_is_a_coordinate_where_others_are_whole_numbers_too() {
    let first = |text: String| {
        let shape = parse(text, "a.xyz").unwrap();
        assert_eq!(repaired(&shape, "row-numbers-ignored"), 0);
        shape.points().iter().map(|p| p[0]).collect::<Vec<_>>()
    };
    let numbers: Vec<f64> = (0..64).map(|i| f64::from(3 * i)).collect();
    assert_eq!(first((0..64).map(|i| format!("{} {} {} {}\n", 3 * i, i % 8, i * i % 11, i % 3)).collect()), numbers);
    // Of a grid, with colours; with a coordinate that is measured nowhere; with nothing beside.
    assert_eq!(first(numbered("", |i, [_, y, z]| format!("{} {y} {z} 200 {i} 7", 3 * i))), numbers);
    let missing = |i: usize| if i == 9 { "nan" } else { "4" };
    assert_eq!(
        first((0..64).map(|i| format!("{} {} {} {}\n", 3 * i, i % 8, i * i % 11, missing(i))).collect()),
        numbers
    );
    assert_eq!(first(numbered("", |i, [_, y, z]| format!("{} {y} {z}", 3 * i))), numbers);
}

#[test]
fn a_first_column_that_only_begins_like_row_numbers_is_a_coordinate() {
    let text: String = (0..96).map(|i| format!("{} {} {} 9\n", i % 48, i / 48, i % 5)).collect();
    let shape = parse(text, "a.xyz").unwrap();
    assert_eq!((shape.points()[1], shape.points()[50]), ([1.0, 0.0, 1.0], [2.0, 1.0, 0.0]));
}

#[test]
fn decimal_commas_are_read_where_they_can_be_nothing_else() {
    let comma =
        |p: [String; 3], quote: &str, by: &str| p.map(|c| format!("{quote}{}{quote}", c.replace('.', ","))).join(by);
    for (quote, by) in [("\"", ","), ("", ";"), ("", "\t"), ("", " "), ("\"", ";")] {
        for before in ["", "x,y,z\n"] {
            let text = numbered(&before.replace(',', by), |_, p| comma(p, quote, by));
            let shape = parse(text, "a.csv").unwrap_or_else(|e| panic!("{quote}{by}: {e}"));
            assert_is_cloud(&shape);
        }
    }
    // Between commas they cut the numbers in two.
    let fixed = |p: [String; 3]| p.map(|c| format!("{:.6}", c.parse::<f64>().unwrap()).replace('.', ","));
    for before in ["x, y, z\n", ""] {
        for by in [", ", ","] {
            let (code, message, _) = refused(parse(numbered(before, |_, p| fixed(p).join(by)), "a.csv"));
            assert_eq!(code, "bad-number", "{message}");
            assert!(message.contains("“3,000000” is not a number (decimals are written with a point)"), "{message}");
        }
    }
    // Three digits behind every comma may be thousands.
    let thousands: String =
        (1..99).map(|i| format!("\"{i},{:03}\",\"{},100\",\"{},200\"\n", i * 7, i % 7 + 1, i % 5 + 1)).collect();
    let (code, message, _) = refused(parse(thousands, "a.csv"));
    assert_eq!(code, "bad-number", "{message}");
}

/// Whether exactly this point is no number.
fn assert_is_nan(text: String, name: &str, index: u32) {
    let shape = parse(&text, name).expect("a cloud");
    assert_eq!((shape.placeless(), repaired(&shape, "points-without-place")), (&[index][..], 1));
}

#[test]
fn rows_without_a_value_stay_points_that_are_no_numbers() {
    for missing in ["nan", "NaN", "-nan(ind)", "1.#QNAN", "#N/A", "N/A", "NULL", "#DIV/0!", "inf"] {
        let row = |by: &'static str| {
            move |i: usize, [x, y, z]: [String; 3]| [x, if i == 9 { missing.to_owned() } else { y }, z].join(by)
        };
        assert_is_nan(numbered("", row(" ")), "a.xyz", 9);
        assert_is_nan(numbered("x;y;z\n", row(";")), "a.csv", 9);
        assert_is_nan(numbered("", row(",")), "a.csv", 9);
    }
    for by in [",", ";", "\t"] {
        assert_is_nan(numbered("", |i, [x, y, z]| [x, if i == 0 { String::new() } else { y }, z].join(by)), "a.csv", 0);
    }
    let short = parse(numbered("", |i, p| if i == 9 { "1,2".to_owned() } else { p.join(",") }), "a.csv");
    assert_eq!(refused(short).0, "short-line", "a row that lacks a column is another thing");
}

#[test]
fn text_within_quotation_marks_may_hold_separators() {
    let text = numbered("name,x,y,z\n", |i, p| format!("\"Smith, J. {i}\",{}", p.join(",")));
    assert_is_cloud(&parse(text, "a.csv").unwrap());
    let text = numbered("x,y,z,place\n", |_, p| format!("{},New York", p.join(",")));
    assert_is_cloud(&parse(text, "a.csv").unwrap());
}
