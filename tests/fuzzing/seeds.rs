//! Files that readers start from: a lattice, a torus and a piece of a sample body in all that a format can be, small.

use std::collections::HashMap;

use geose_fmap::{Format, read};
use serde_json::{Value, json};

use super::readers::NAMES;
use crate::body_on_joints::Body;
use crate::compressed_torus::{CORNERS, EXPONENTS, FLOATS0, FLOATS1, SEQUENCE, SHORTS0, View, packed};
use crate::sample::{self, Sample, gltf_data, gltf_document, torus};

/// 4 × 4 × 4 points, and the triangles of one side.
fn lattice() -> Sample {
    let points = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16].map(f64::from)).collect();
    let squares = (0..3).flat_map(|j| (0..3).map(move |i| 4 * j + i));
    Sample { points, faces: squares.flat_map(|i| [[i, i + 1, i + 5], [i, i + 5, i + 4]]).collect() }
}

/// The first points of a sample body that hang together, up to 60.
fn piece_of_body() -> Sample {
    let bytes = include_bytes!("../../www/public/samples/man-standing.ply");
    let body = read(bytes, None, Some(Format::Ply)).expect("a sample body");
    let mut number = HashMap::from([(body.faces()[0][0], 0)]);
    let mut faces = Vec::new();
    let mut order = vec![body.faces()[0][0]];
    while order.len() < 60 {
        for face in
            body.faces().iter().filter(|face| face.iter().any(|i| number.contains_key(i))).copied().collect::<Vec<_>>()
        {
            for i in face {
                number.entry(i).or_insert_with(|| {
                    order.push(i);
                    order.len() as u32 - 1
                });
            }
            faces.push(face.map(|i| number[&i]));
            if order.len() >= 60 {
                break;
            }
        }
    }
    // Three digits: what is short is mutated often.
    let short = |p: [f64; 3]| p.map(|c| (c * 1000.0).round() / 1000.0);
    Sample { points: order.iter().map(|&i| short(body.points()[i as usize])).collect(), faces }
}

fn samples() -> [Sample; 3] {
    [lattice(), torus(), piece_of_body()]
}

/// All files as bytes.
fn bytes(texts: impl IntoIterator<Item = String>) -> Vec<Vec<u8>> {
    texts.into_iter().map(String::into_bytes).collect()
}

pub fn off() -> Vec<Vec<u8>> {
    let plain = sample::off(&lattice());
    let coloured = plain
        .lines()
        .enumerate()
        .map(|(i, line)| if i < 2 { format!("{line}\n") } else { format!("{line} 255 0 0 255\n") });
    let mut files: Vec<String> = samples().iter().map(sample::off).collect();
    files.extend([
        coloured.collect::<String>().replacen("OFF", "COFF", 1),
        plain.replacen("OFF\n", "OFF", 1),
        plain.replacen("OFF\n", "# by hand\n\nOFF # header\n\n# counts:\n", 1).replace('\n', "\r\n"),
        plain.replacen(" 18 0", " 1 0", 1).replacen("3 0 1 5", "8 0 1 2 3 7 6 5 4", 1),
        plain.replacen("OFF", "STCNOFF", 1),
        "OFF BINARY\n\0\0\0".to_owned(),
    ]);
    bytes(files)
}

pub fn ply() -> Vec<Vec<u8>> {
    let mut files: Vec<Vec<u8>> = samples().iter().map(|s| sample::ply_text(s).into_bytes()).collect();
    files.extend(samples().iter().flat_map(|s| [false, true].map(|big| sample::ply_binary(s, big))));
    // The header has eleven lines now.
    let labels = sample::ply_text(&lattice()).replacen("double z", "double z\nproperty double scalar_label", 1);
    let labelled = |(i, line): (usize, &str)| {
        if (11..75).contains(&i) { format!("{line} {}.0\n", i / 9) } else { format!("{line}\n") }
    };
    files.push(labels.lines().enumerate().map(labelled).collect::<String>().into_bytes());
    let listed = "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement camera 1\r\nproperty list uint8 float32 f\r\nelement vertex 64\r\nproperty uchar red\r\n\
                  property float x\r\nproperty float y\r\nproperty float z\r\nelement tristrips 1\r\nproperty list int int vertex_indices\r\nend_header\r\n2 0.5 1\r\n";
    let rows: String = lattice().points.iter().map(|[x, y, z]| format!("255 {x} {y} {z}\r\n")).collect();
    files.push(format!("{listed}{rows}5 0 1 4 -1 5\r\n").into_bytes());
    let splats = "ply\nformat binary_little_endian 1.0\nelement chunk 1\nproperty float min_x\nelement vertex 64\nproperty uint packed_position\nend_header\n";
    files.push(splats.as_bytes().to_vec());
    files
}

pub fn obj() -> Vec<Vec<u8>> {
    let plain = sample::obj(&lattice());
    let mut files: Vec<String> = samples().iter().map(sample::obj).collect();
    files.extend([
        plain.replacen("f 1 2 6\n", "vt 0 0\nvn 0 0 1\no a\ng b\ns 1\nusemtl c\nf -64/1/1 -63/1 -62//1 -61\n", 1),
        plain
            .replacen("v 0 0 0\n", "mtllib a.mtl\n# a comment\nv 0 \\\n0 \\\n 0 # here too\n", 1)
            .replace('\n', "\r\n"),
        plain.replacen("v 0 0 0\n", "v 0 0 0 0.5 0.5 0.5\n", 1) + "l 1 2\np 1\nf 1 2 3 4 8 7 6 5\n",
    ]);
    bytes(files)
}

pub fn stl() -> Vec<Vec<u8>> {
    let mut files: Vec<Vec<u8>> = samples().iter().map(|s| sample::stl_text(s).into_bytes()).collect();
    files.extend(samples().iter().map(sample::stl_binary));
    let text = sample::stl_text(&lattice());
    let mut streamed = sample::stl_binary(&lattice());
    streamed[80..84].fill(0);
    let mut coloured = sample::stl_binary(&lattice());
    coloured[..10].copy_from_slice(b"COLOR=\0\0\0\0");
    files.extend([
        streamed,
        coloured,
        text.replace('\n', " ").into_bytes(),
        format!("{text}{text}beyond").into_bytes(),
        text.replacen("endloop", "vertex 1 1 1\nendloop", 1).into_bytes(),
        text.replace("endsolid", "end solid").to_uppercase().into_bytes(),
    ]);
    files
}

/// Documents and their data, in all that the reader knows.
fn documents() -> Vec<(Value, Vec<u8>)> {
    let mut documents: Vec<(Value, Vec<u8>)> = samples().iter().map(|s| (gltf_document(s), gltf_data(s))).collect();
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut document = gltf_document(&lattice());
        change(&mut document);
        (document, gltf_data(&lattice()))
    };
    let corners = View { data: SEQUENCE, stride: 4, mode: "INDICES", filter: "NONE" };
    let mut body = Body::new();
    body.bind([0.0, 1.0]);
    body.target();
    body.document["meshes"][0]["weights"] = json!([0.5]);
    let (mut short, shorts) = packed("EXT_meshopt_compression", &View::points(SHORTS0, 8, "NONE"), &CORNERS);
    short["accessors"][0]["componentType"] = json!(5122);
    documents.extend([
        (body.document, body.data),
        (short, shorts),
        packed("EXT_meshopt_compression", &View::points(FLOATS0, 12, "NONE"), &CORNERS),
        packed("KHR_meshopt_compression", &View::points(FLOATS1, 12, "NONE"), &corners),
        packed("EXT_meshopt_compression", &View::points(EXPONENTS, 12, "EXPONENTIAL"), &CORNERS),
        changed(&|d| {
            d["nodes"] = json!([{ "children": [1], "translation": [1, 0, 0], "scale": [2, 2, -2] }, { "mesh": 0, "rotation": [0, 0, 0.6, 0.8] }]);
        }),
        changed(&|d| d["nodes"][0]["matrix"] = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1])),
        changed(&|d| d["meshes"][0]["primitives"][0]["mode"] = json!(5)),
        changed(&|d| {
            d["accessors"][0]["sparse"] = json!({ "count": 2, "indices": { "bufferView": 1, "componentType": 5125 }, "values": { "bufferView": 0 } });
        }),
        changed(&|d| {
            d["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [10, 0, 0] }]);
            d["scenes"] = json!([{ "nodes": [1] }, { "nodes": [0, 1] }, {}]);
        }),
        changed(&|d| {
            d["accessors"][0] = json!({ "bufferView": 0, "componentType": 5121, "count": 64, "type": "VEC3", "normalized": true });
            d["bufferViews"][0]["byteStride"] = json!(4);
        }),
    ]);
    documents
}

pub fn glb() -> Vec<Vec<u8>> {
    documents().iter().map(|(document, data)| sample::glb(document, data)).collect()
}

/// Half of them with a file beside them, behind a zero byte.
pub fn gltf() -> Vec<Vec<u8>> {
    let file = |(index, (mut document, data)): (usize, (Value, Vec<u8>))| {
        let beside = index % 2 == 0;
        document["buffers"][0]["uri"] = json!(if beside { "data.bin".to_owned() } else { sample::data_uri(&data) });
        let mut bytes = document.to_string().into_bytes();
        if beside {
            bytes.push(0);
            bytes.extend(data);
        }
        bytes
    };
    documents().into_iter().enumerate().map(file).collect()
}

/// XYZ, PTS and CSV, which one reader reads.
pub fn tables() -> Vec<Vec<u8>> {
    let mut files: Vec<String> =
        samples().iter().flat_map(|s| [sample::xyz(s), sample::pts(s), sample::csv(s)]).collect();
    let rows = torus().points.into_iter().enumerate();
    let table: String =
        rows.map(|(i, [x, y, z])| format!("{i};\"{x:.3}\";{y:.3};{z:.3}\n").replace('.', ",")).collect();
    let plain = sample::xyz(&lattice());
    files.extend([
        format!("id;X [mm];Y [mm];Z [mm]\n{table}"),
        table,
        plain.replace(' ', "\t").replace('\n', "\t0.5\t\r\n"),
        format!(
            "# Markups fiducial file version = 4.11\n# columns = id,x,y,z,ow,label\n{}",
            plain.replace(' ', ",").replace('\n', ",0,\"a b\"\n")
        ),
        format!("64\n\n{}", plain.replace('\n', " 1 255 255 255\n")),
        plain.replace('0', "1e-3").replace('\n', " ; "),
    ]);
    let mut files = bytes(files);
    files.push(plain.encode_utf16().flat_map(u16::to_le_bytes).collect());
    files.push([b"\xEF\xBB\xBF", plain.as_bytes()].concat());
    files
}

/// One of each behind each name, the beginnings of files that are known and not read, and texts in UTF-16.
pub fn any_format() -> Vec<Vec<u8>> {
    let readers = [off(), ply(), obj(), stl(), glb(), gltf(), tables()];
    let mut files: Vec<Vec<u8>> = readers.iter().flat_map(|files| files.iter().step_by(2).cloned()).collect();
    let splats = [[0, 0, 128, 63].repeat(6), vec![0; 8]].concat().repeat(64);
    let wide = |text: String| text.encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
    files.extend([
        splats,
        [b"\xFE\xFF".to_vec(), wide(sample::off(&lattice()))].concat(),
        wide(sample::obj(&lattice())),
    ]);
    let marked = |at: usize, mark: &[u8]| [vec![0; at], mark.to_vec(), vec![0; 40]].concat();
    files.extend([
        marked(0, b"LASF"),
        marked(128, b"DICM"),
        marked(344, b"n+1\0"),
        marked(0, b"\x1F\x8B\x08"),
        marked(0, b"ASTM-E57"),
    ]);
    let texts = [
        "; FBX 7.3.0\nFBXHeaderExtension: {",
        "<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">",
        "# .PCD v0.7\nVERSION 0.7\n",
        "<!doctype html>",
    ];
    files.extend(texts.map(|text| text.as_bytes().to_vec()));
    let mut zip = b"PK\x03\x04".to_vec();
    zip.resize(26, 0);
    zip.extend([7, 0, 0, 0]);
    zip.extend(b"3D/a.xml");
    files.push(zip.repeat(2));
    files.iter().enumerate().map(|(i, file)| [&[(i % NAMES.len()) as u8][..], file].concat()).collect()
}
