//! A small torus, and the same torus written in every format.
#![allow(dead_code, reason = "each test file uses its own part of these")]

use geose_fmap::{Error, Shape, read};
use serde_json::{Value, json};

/// Points and triangles of a scan.
#[derive(Clone)]
pub struct Sample {
    pub points: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
}

/// 64 points, 128 triangles, closed, one piece; every coordinate is exact in f32.
pub fn torus() -> Sample {
    let n = 8_u32;
    let turn = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let radius = 2.0 + turn(j).cos();
            let point = [radius * turn(i).cos(), radius * turn(i).sin(), turn(j).sin()];
            points.push(point.map(|c| f64::from(c as f32)));
            let at = |i: u32, j: u32| (i % n) * n + j % n;
            faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Sample { points, faces }
}

pub fn parse(bytes: impl AsRef<[u8]>, name: &str) -> Result<Shape, Error> {
    read(bytes.as_ref(), Some(name), None).map_err(Error::from)
}

/// Exactly the torus, and nothing to say about it.
pub fn assert_is_torus(shape: &Shape) {
    assert_eq!(shape.points(), torus().points);
    assert_eq!(shape.faces(), torus().faces);
    assert_eq!(shape.repairs(), []);
}

/// The count of the repair with this code; 0 if there is none.
pub fn repaired(shape: &Shape, code: &str) -> usize {
    shape.repairs().iter().find(|r| r.code == code).map_or(0, |r| r.count)
}

/// Code, sentence and details of the error that must be there.
pub fn refused(result: Result<Shape, Error>) -> (&'static str, String, Value) {
    let error = result.expect_err("must be refused");
    (error.code(), error.to_string(), error.details())
}

pub fn off(Sample { points, faces }: &Sample) -> String {
    let mut text = format!("OFF\n{} {} 0\n", points.len(), faces.len());
    points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    faces.iter().for_each(|[a, b, c]| text += &format!("3 {a} {b} {c}\n"));
    text
}

pub fn obj(Sample { points, faces }: &Sample) -> String {
    let mut text = String::new();
    points.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
    faces.iter().for_each(|f| text += &format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1));
    text
}

pub fn ply_text(Sample { points, faces }: &Sample) -> String {
    let mut text = ply_header("ascii", "double", points.len(), faces.len());
    points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    faces.iter().for_each(|[a, b, c]| text += &format!("3 {a} {b} {c}\n"));
    text
}

pub fn ply_binary(Sample { points, faces }: &Sample, big: bool) -> Vec<u8> {
    let encoding = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_header(encoding, "float", points.len(), faces.len()).into_bytes();
    let word = |mut w: [u8; 4]| {
        if big {
            w.reverse();
        }
        w
    };
    points.iter().flatten().for_each(|&c| bytes.extend(word((c as f32).to_le_bytes())));
    for face in faces {
        bytes.push(3);
        face.iter().for_each(|i| bytes.extend(word(i.to_le_bytes())));
    }
    bytes
}

fn ply_header(encoding: &str, float: &str, points: usize, faces: usize) -> String {
    format!(
        "ply\nformat {encoding} 1.0\ncomment made by a test\nelement vertex {points}\nproperty {float} x\nproperty {float} y\n\
         property {float} z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

/// Positions as f32, then indices as u32.
pub fn gltf_data(Sample { points, faces }: &Sample) -> Vec<u8> {
    let positions = points.iter().flatten().flat_map(|&c| (c as f32).to_le_bytes());
    positions.chain(faces.iter().flatten().flat_map(|i| i.to_le_bytes())).collect()
}

/// The document that goes with [`gltf_data`].
pub fn gltf_document(Sample { points, faces }: &Sample) -> Value {
    let (split, end) = (12 * points.len(), 12 * points.len() + 12 * faces.len());
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": points.len(), "type": "VEC3" },
            { "bufferView": 1, "componentType": 5125, "count": 3 * faces.len(), "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": split },
            { "buffer": 0, "byteOffset": split, "byteLength": end - split },
        ],
        "buffers": [{ "byteLength": end }],
    })
}

pub fn glb(document: &Value, data: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = (12 + 8 + json.len() + 8 + data.len()) as u32;
    let mut bytes = b"glTF".to_vec();
    bytes.extend([2, length].map(u32::to_le_bytes).concat());
    for (kind, chunk) in [(b"JSON", json.as_slice()), (b"BIN\0", data)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// The triangles of a scan with three points of their own each, as an STL gives them back.
pub fn soup(Sample { points, faces }: &Sample) -> Sample {
    Sample {
        points: faces.iter().flatten().map(|&i| points[i as usize]).collect(),
        faces: (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    }
}

pub fn stl_text(Sample { points, faces }: &Sample) -> String {
    let mut text = String::from("solid made by a test\n");
    for face in faces {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for [x, y, z] in face.map(|i| points[i as usize]) {
            text += &format!("      vertex {x} {y} {z}\n");
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid made by a test\n"
}

/// With a header that begins like a text STL, as several programs write it.
pub fn stl_binary(Sample { points, faces }: &Sample) -> Vec<u8> {
    let mut bytes = format!("{:<80}", "solid but binary").into_bytes();
    bytes.extend((faces.len() as u32).to_le_bytes());
    for face in faces {
        bytes.extend([0; 12]);
        face.iter().flat_map(|&i| points[i as usize]).for_each(|c| bytes.extend((c as f32).to_le_bytes()));
        bytes.extend([7, 0]);
    }
    bytes
}

pub fn xyz(Sample { points, .. }: &Sample) -> String {
    points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect()
}

pub fn pts(sample: &Sample) -> String {
    format!("{}\n{}", sample.points.len(), xyz(sample))
}

pub fn csv(Sample { points, .. }: &Sample) -> String {
    let rows: String = points.iter().map(|[x, y, z]| format!("{x},{y},{z}\n")).collect();
    format!("x,y,z\n{rows}")
}

/// One valid file of every format and variant, with a name, and what must be read of it.
pub fn all_files() -> Vec<(&'static str, Vec<u8>, Sample)> {
    let torus = torus();
    let cloud = Sample { faces: vec![], ..torus.clone() };
    let mut files: Vec<_> = all_formats().into_iter().map(|(name, bytes)| (name, bytes, torus.clone())).collect();
    files.extend([
        ("text.stl", stl_text(&torus).into_bytes(), soup(&torus)),
        ("binary.stl", stl_binary(&torus), soup(&torus)),
        ("a.xyz", xyz(&torus).into_bytes(), cloud.clone()),
        ("a.pts", pts(&torus).into_bytes(), cloud.clone()),
        ("a.csv", csv(&torus).into_bytes(), cloud),
    ]);
    files
}

/// One valid file of every format and variant that keeps points and faces as they are, with a name.
pub fn all_formats() -> Vec<(&'static str, Vec<u8>)> {
    let torus = torus();
    let mut embedded = gltf_document(&torus);
    embedded["buffers"][0]["uri"] = json!(data_uri(&gltf_data(&torus)));
    vec![
        ("a.off", off(&torus).into_bytes()),
        ("a.obj", obj(&torus).into_bytes()),
        ("text.ply", ply_text(&torus).into_bytes()),
        ("little.ply", ply_binary(&torus, false)),
        ("big.ply", ply_binary(&torus, true)),
        ("a.glb", glb(&gltf_document(&torus), &gltf_data(&torus))),
        ("a.gltf", embedded.to_string().into_bytes()),
    ]
}

pub fn data_uri(data: &[u8]) -> String {
    let letters: Vec<char> = ('A'..='Z').chain('a'..='z').chain('0'..='9').chain(['+', '/']).collect();
    let mut uri = "data:application/octet-stream;base64,".to_owned();
    for group in data.chunks(3) {
        let bits = group.iter().fold(0_usize, |bits, b| bits << 8 | usize::from(*b)) << (8 * (3 - group.len()));
        for i in 0..4 {
            uri.push(if i <= group.len() { letters[bits >> (18 - 6 * i) & 63] } else { '=' });
        }
    }
    uri
}
