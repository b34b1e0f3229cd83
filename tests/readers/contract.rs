//! What scans that come in may be like, clause by clause, and what each reader makes of it. What only one format has is tested beside
//! its name: negative indices and objects in `obj.rs`, node transforms and quantised attributes in `gltf.rs`, labels in `ply.rs`,
//! solids in `stl.rs`, separators and headers in `table.rs`.

use serde_json::json;

use crate::sample::{
    Sample, csv, data_uri, glb, gltf_data, gltf_document, obj, off, parse, ply_binary, ply_text, pts, soup, stl_binary,
    stl_text, torus, xyz,
};

/// What a format can keep of a mesh.
#[derive(Clone, Copy, PartialEq)]
enum Keeps {
    Mesh,
    /// Triangles with corners of their own.
    Soup,
    Points,
}

type WritePolygons = fn(&[[f64; 3]], &[Vec<u32>]) -> Vec<u8>;

/// A format or a variant of one.
struct Reader {
    name: &'static str,
    keeps: Keeps,
    write: fn(&Sample) -> Vec<u8>,
    /// The same for faces of any number of corners, where the format has them.
    polygons: Option<WritePolygons>,
    /// A count in the file and what a lie in its place looks like.
    count: Option<(&'static [u8], &'static [u8])>,
    /// Whether a file that is cut off can be told from a whole one wherever it is cut, or only within a line.
    notices_any_cut: bool,
}

const READERS: [Reader; 12] = [
    Reader {
        name: "text.off",
        keeps: Keeps::Mesh,
        write: |s| off(s).into_bytes(),
        polygons: Some(|points, polygons| {
            let cloud = off(&Sample { points: points.to_vec(), faces: vec![] });
            let counted = cloud.replacen(" 0 0", &format!(" {} 0", polygons.len()), 1);
            polygons.iter().fold(counted, |text, p| text + &format!("{} {}\n", p.len(), joined(p, 0))).into_bytes()
        }),
        count: Some((b"64 128 0", b"4000000000 128 0")),
        notices_any_cut: true,
    },
    Reader {
        name: "text.obj",
        keeps: Keeps::Mesh,
        write: |s| obj(s).into_bytes(),
        polygons: Some(|points, polygons| {
            let cloud = obj(&Sample { points: points.to_vec(), faces: vec![] });
            polygons.iter().fold(cloud, |text, p| text + &format!("f {}\n", joined(p, 1))).into_bytes()
        }),
        count: None,
        notices_any_cut: false,
    },
    Reader {
        name: "text.ply",
        keeps: Keeps::Mesh,
        write: |s| ply_text(s).into_bytes(),
        polygons: Some(|points, polygons| {
            let cloud = ply_text(&Sample { points: points.to_vec(), faces: vec![] });
            let counted = cloud.replacen("face 0", &format!("face {}", polygons.len()), 1);
            polygons.iter().fold(counted, |text, p| text + &format!("{} {}\n", p.len(), joined(p, 0))).into_bytes()
        }),
        count: Some((b"vertex 64", b"vertex 18446744073709551615")),
        notices_any_cut: true,
    },
    Reader {
        name: "little.ply",
        keeps: Keeps::Mesh,
        write: |s| ply_binary(s, false),
        polygons: Some(|points, polygons| binary_polygons(points, polygons, false)),
        count: Some((b"vertex 64", b"vertex 4000000000")),
        notices_any_cut: true,
    },
    Reader {
        name: "big.ply",
        keeps: Keeps::Mesh,
        write: |s| ply_binary(s, true),
        polygons: Some(|points, polygons| binary_polygons(points, polygons, true)),
        count: Some((b"face 128", b"face 4000000000")),
        notices_any_cut: true,
    },
    Reader {
        name: "binary.glb",
        keeps: Keeps::Mesh,
        write: |s| glb(&gltf_document(s), &gltf_data(s)),
        polygons: None,
        count: Some((b"\"count\":64,", b"\"count\":99,")),
        notices_any_cut: true,
    },
    Reader {
        name: "text.gltf",
        keeps: Keeps::Mesh,
        write: |s| {
            let mut document = gltf_document(s);
            document["buffers"][0]["uri"] = json!(data_uri(&gltf_data(s)));
            document.to_string().into_bytes()
        },
        polygons: None,
        count: Some((b"\"count\":384,", b"\"count\":399,")),
        notices_any_cut: true,
    },
    Reader {
        name: "text.stl",
        keeps: Keeps::Soup,
        write: |s| stl_text(s).into_bytes(),
        polygons: Some(|points, polygons| {
            let place = |&i: &u32| format!("vertex {}\n", points[i as usize].map(|c| c.to_string()).join(" "));
            let facets = polygons.iter().map(|p| {
                let corners: String = p.iter().map(place).collect();
                format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
            });
            format!("solid\n{}endsolid\n", facets.collect::<String>()).into_bytes()
        }),
        count: None,
        notices_any_cut: true,
    },
    Reader {
        name: "binary.stl",
        keeps: Keeps::Soup,
        write: stl_binary,
        polygons: None,
        count: Some((&[128, 0, 0, 0], &[0, 0, 0, 239])),
        notices_any_cut: true,
    },
    Reader {
        name: "a.xyz",
        keeps: Keeps::Points,
        write: |s| xyz(s).into_bytes(),
        polygons: None,
        count: None,
        notices_any_cut: false,
    },
    Reader {
        name: "a.pts",
        keeps: Keeps::Points,
        write: |s| pts(s).into_bytes(),
        polygons: None,
        count: Some((b"64\n", b"4000000000\n")),
        notices_any_cut: true,
    },
    Reader {
        name: "a.csv",
        keeps: Keeps::Points,
        write: |s| csv(s).into_bytes(),
        polygons: None,
        count: None,
        notices_any_cut: false,
    },
];

fn joined(corners: &[u32], first: u32) -> String {
    corners.iter().map(|i| (i + first).to_string()).collect::<Vec<_>>().join(" ")
}

fn binary_polygons(points: &[[f64; 3]], polygons: &[Vec<u32>], big: bool) -> Vec<u8> {
    let cloud = ply_binary(&Sample { points: points.to_vec(), faces: vec![] }, big);
    let mut bytes = replaced(&cloud, b"face 0", format!("face {}", polygons.len()).as_bytes());
    for polygon in polygons {
        bytes.push(polygon.len() as u8);
        polygon.iter().for_each(|i| bytes.extend(if big { i.to_be_bytes() } else { i.to_le_bytes() }));
    }
    bytes
}

fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|w| w == from).expect("what is to be replaced");
    [&bytes[..at], to, &bytes[at + from.len()..]].concat()
}

/// What must come of a file.
enum Outcome {
    /// A shape about which there is nothing to say (but that the corners of soup are joined).
    Fine,
    /// A shape with a repair of this code and count.
    Said(&'static str, usize),
    /// A shape with a repair of this code.
    Mentioned(&'static str),
    /// An error with one of these codes.
    Refused(&'static [&'static str]),
    /// The format cannot hold such a thing.
    CannotBe,
}
use Outcome::{CannotBe, Fine, Mentioned, Refused, Said};

fn check(reader: &Reader, clause: &str, bytes: &[u8], outcome: &Outcome) {
    let what = format!("{clause} in {}", reader.name);
    let result = parse(bytes, reader.name);
    let codes = |shape: &geose_fmap::Shape| -> Vec<(String, usize)> {
        shape.repairs().iter().map(|r| (r.code.clone(), r.count)).collect()
    };
    match (outcome, result) {
        (Refused(expected), Err(error)) => {
            assert!(expected.contains(&error.code()), "{what}: {} ({error})", error.code());
            assert!(error.to_string().contains(' ') && error.details().is_object(), "{what}");
        }
        (Refused(expected), Ok(shape)) => panic!("{what}: must be {expected:?}, but is read: {:?}", codes(&shape)),
        (_, Err(error)) => panic!("{what}: {error}"),
        (Fine, Ok(shape)) => {
            let said: Vec<_> = codes(&shape).into_iter().filter(|(code, _)| code != "corners-joined").collect();
            assert_eq!(said, [], "{what}");
        }
        (Said(code, count), Ok(shape)) => {
            assert!(codes(&shape).contains(&((*code).to_owned(), *count)), "{what}: {:?}", codes(&shape));
        }
        (Mentioned(code), Ok(shape)) => {
            assert!(codes(&shape).iter().any(|(c, _)| c == code), "{what}: {:?}", codes(&shape));
        }
        (CannotBe, Ok(_)) => unreachable!("is not written"),
    }
}

/// A clause: what is done to a good scan, and what must come of it as a mesh, as soup and as points.
type Clause = (&'static str, fn(&mut Sample), [Outcome; 3]);

fn times(s: &mut Sample, factor: f64) {
    s.points.iter_mut().flatten().for_each(|c| *c *= factor);
}

#[rustfmt::skip]
const CLAUSES: [Clause; 22] = [
    ("a good scan", |_| {}, [Fine, Fine, Fine]),
    ("NaN", |s| s.points[7][1] = f64::NAN, [Refused(&["not-finite"]), Refused(&["not-finite"]), Said("points-without-place", 1)]),
    ("infinity", |s| s.points[7][2] = f64::NEG_INFINITY, [Refused(&["not-finite"]), Refused(&["not-finite"]), Said("points-without-place", 1)]),
    ("no points", |s| *s = Sample { points: vec![], faces: vec![] }, [
        Refused(&["too-few-points", "missing-element", "empty-file", "malformed-file"]),
        Refused(&["missing-element"]),
        Refused(&["missing-element", "empty-file"]),
    ]),
    ("fewer than fifty points", |s| { s.points.truncate(49); s.faces.truncate(16) },
        [Refused(&["too-few-points"]), Refused(&["too-few-points"]), Refused(&["too-few-points"])]),
    ("all points equal", |s| s.points.fill([5.0, 6.0, 7.0]),
        [Refused(&["all-points-equal"]), Refused(&["all-points-equal"]), Refused(&["all-points-equal"])]),
    ("collinear points", |s| s.points.iter_mut().enumerate().for_each(|(i, p)| *p = [0.1, 0.2, -0.3].map(|c| c * i as f64)),
        [Refused(&["collinear-points"]), Refused(&["collinear-points"]), Refused(&["collinear-points"])]),
    ("duplicate points", |s| s.points.extend([s.points[3], s.points[3]]),
        [Said("duplicate-points", 2), Said("corners-joined", 320), Said("duplicate-points", 2)]),
    ("unreferenced vertices", |s| s.points.push([0.0, 0.0, 5.0]), [Said("unreferenced-points", 1), Fine, Fine]),
    ("a face without area", |s| { s.points.extend([[4.0, 0.0, 0.0], [5.0, 0.0, 0.0]]); s.faces.push([0, 64, 65]) },
        [Said("zero-area-faces", 1), Said("zero-area-faces", 1), Fine]),
    ("a face without area apart from all others", |s| { s.points.extend([[4.0, 0.0, 0.0], [5.0, 0.0, 0.0], [6.0, 0.0, 0.0]]); s.faces.push([64, 65, 66]) },
        [Said("zero-area-pieces", 1), Said("zero-area-pieces", 1), Fine]),
    ("a repeated index", |s| s.faces.push([1, 1, 2]), [Said("repeated-index-faces", 1), Said("zero-area-faces", 1), Fine]),
    ("no good face at all", |s| s.faces.iter_mut().for_each(|f| f[1] = f[0]), [Said("no-faces-left", 1), Said("no-faces-left", 1), Fine]),
    ("an index out of range", |s| s.faces[5][1] = 64, [Refused(&["face-index-out-of-range"]), CannotBe, CannotBe]),
    ("a non-manifold edge", |s| { s.points.push([5.0, 5.0, 5.0]); s.faces.push([0, 8, 64]) },
        [Said("non-manifold-edges", 1), Said("non-manifold-edges", 1), Fine]),
    ("inconsistent winding", |s| s.faces[40].swap(1, 2), [Said("inconsistent-winding", 3), Said("inconsistent-winding", 3), Fine]),
    ("separate pieces", |s| {
        let other = torus();
        s.points.extend(other.points.iter().map(|[x, y, z]| [x + 10.0, *y, *z]));
        s.faces.extend(other.faces.iter().map(|f| f.map(|i| i + 64)));
    }, [Said("separate-pieces", 2), Said("separate-pieces", 2), Fine]),
    ("huge coordinates", |s| times(s, 1e31),
        [Refused(&["coordinate-too-large"]), Refused(&["coordinate-too-large"]), Refused(&["coordinate-too-large"])]),
    ("large coordinates", |s| times(s, 1e25), [Fine, Fine, Fine]),
    ("tiny coordinates", |s| times(s, 1e-32),
        [Refused(&["extent-too-small"]), Refused(&["extent-too-small"]), Refused(&["extent-too-small"])]),
    ("small coordinates", |s| times(s, 1e-25), [Fine, Fine, Fine]),
    ("a scan far from the origin", |s| s.points.iter_mut().for_each(|p| p[0] += 1e7),
        [Mentioned("far-from-origin"), Mentioned("far-from-origin"), Mentioned("far-from-origin")]),
];

#[test]
fn every_reader_keeps_every_clause() {
    for (clause, change, outcomes) in &CLAUSES {
        for reader in &READERS {
            let outcome = &outcomes[reader.keeps as usize];
            if matches!(outcome, CannotBe) {
                continue;
            }
            let mut sample = torus();
            change(&mut sample);
            check(reader, clause, &(reader.write)(&sample), outcome);
        }
    }
}

#[test]
fn every_text_reader_takes_the_line_ends_of_every_system() {
    for reader in &READERS {
        let bytes = (reader.write)(&torus());
        let Some(text) = String::from_utf8(bytes).ok().filter(|text| !text.contains('\0')) else { continue };
        let said = parse(&text, reader.name).expect("the original");
        for end in ["\r\n", "\r"] {
            let shape = parse(text.replace('\n', end), reader.name).unwrap_or_else(|e| panic!("{}: {e}", reader.name));
            assert_eq!(shape, said, "{}", reader.name);
        }
    }
}

#[test]
fn every_reader_of_polygons_cuts_quads_and_larger_ones_into_triangles() {
    // 62 quads, a hexagon that goes on along its first edge, and two triangles.
    let quads: Vec<[u32; 4]> = torus().faces.chunks(2).map(|q| [q[0][0], q[0][1], q[0][2], q[1][2]]).collect();
    let mut polygons: Vec<Vec<u32>> = quads[1..].iter().map(|q| q.to_vec()).collect();
    polygons.push(torus().faces[0].to_vec());
    polygons.push(torus().faces[1].to_vec());
    let last = polygons[0].clone();
    polygons[0] = vec![last[0], last[1], last[2], last[3], last[0], last[1]];
    for reader in &READERS {
        let Some(write) = reader.polygons else { continue };
        let shape =
            parse(write(&torus().points, &polygons), reader.name).unwrap_or_else(|e| panic!("{}: {e}", reader.name));
        let cut = shape.repairs().iter().find(|r| r.code == "polygons-triangulated").map(|r| r.count);
        assert_eq!(cut, Some(63), "{}: {:?}", reader.name, shape.repairs());
        let least = 62 * 2 + 2;
        assert!(shape.faces().len() >= least, "{}: {} faces", reader.name, shape.faces().len());
    }
}

#[test]
fn every_reader_notices_a_count_larger_than_the_file() {
    for reader in &READERS {
        let Some((count, lie)) = reader.count else { continue };
        let bytes = replaced(&(reader.write)(&torus()), count, lie);
        check(reader, "a count larger than the file", &bytes, &Refused(&["truncated-file", "malformed-file"]));
    }
}

#[test]
fn every_reader_notices_a_file_that_is_cut_off() {
    for reader in &READERS {
        let bytes = (reader.write)(&torus());
        let length = bytes.trim_ascii_end().len();
        let refused = Refused(&[
            "truncated-file",
            "malformed-file",
            "short-line",
            "bad-number",
            "missing-element",
            "unknown-format",
        ]);
        if reader.notices_any_cut {
            // The very last number may lose digits unnoticed.
            for end in (1..length - 20).step_by(7) {
                check(reader, &format!("cut at byte {end}"), &bytes[..end], &refused);
            }
        } else {
            // Without counts only a line that breaks off shows it.
            let line = bytes[..length * 3 / 10].iter().rposition(|&b| b == b'\n').expect("lines");
            let end = bytes[..line].iter().rposition(|b| b" ,".contains(b)).expect("fields");
            check(reader, "cut within a line", &bytes[..end], &refused);
        }
    }
}

#[test]
fn soup_is_what_a_mesh_becomes_and_the_points_of_tables_stay_in_order() {
    for reader in &READERS {
        let shape = parse((reader.write)(&torus()), reader.name).expect("a good scan");
        let expected = match reader.keeps {
            Keeps::Mesh => torus(),
            Keeps::Soup => soup(&torus()),
            Keeps::Points => Sample { faces: vec![], ..torus() },
        };
        assert_eq!((shape.points(), shape.faces()), (&expected.points[..], &expected.faces[..]), "{}", reader.name);
    }
}
