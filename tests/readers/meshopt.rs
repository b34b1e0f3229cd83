//! Views compressed with EXT_meshopt_compression.

use geose_fmap::{Error, Shape};
use serde_json::{Value, json};

use crate::compressed_torus::{CORNERS, EXPONENTS, FLOATS0, FLOATS1, SEQUENCE, SHORTS0, SHORTS1, View, packed};
use crate::sample::{glb, parse, refused, torus};

fn read(document: &Value, data: &[u8]) -> Result<Shape, Error> {
    parse(glb(document, data), "a.glb")
}

fn assert_near_torus(shape: &Shape, within: f64) {
    for (p, q) in shape.points().iter().zip(torus().points) {
        assert!((0..3).all(|k| (p[k] - q[k]).abs() <= within), "{p:?} is not {q:?}");
    }
    assert_eq!((shape.points().len(), shape.faces(), shape.repairs()), (64, &torus().faces[..], &[][..]));
}

#[test]
fn compressed_points_and_corners_are_read_in_every_mode() {
    let corners = View { data: SEQUENCE, stride: 4, mode: "INDICES", filter: "NONE" };
    for (name, points) in [
        ("EXT_meshopt_compression", View::points(FLOATS0, 12, "NONE")),
        ("KHR_meshopt_compression", View::points(FLOATS1, 12, "NONE")),
        ("EXT_meshopt_compression", View::points(EXPONENTS, 12, "EXPONENTIAL")),
    ] {
        for corners in [&CORNERS, &corners] {
            let (document, data) = packed(name, &points, corners);
            // The encoder computed the torus by itself, so its last digits may differ.
            assert_near_torus(&read(&document, &data).unwrap(), 1e-6);
        }
    }
}

#[test]
fn compressed_integers_are_scaled_by_their_node() {
    for data in [SHORTS0, SHORTS1] {
        let (mut document, data) = packed("EXT_meshopt_compression", &View::points(data, 8, "NONE"), &CORNERS);
        document["accessors"][0]["componentType"] = json!(5122);
        document["nodes"][0]["scale"] = json!([0.001, 0.001, 0.001]);
        assert_near_torus(&read(&document, &data).unwrap(), 5.1e-4);
    }
}

#[test]
fn compressed_data_that_is_damaged_is_refused_with_its_view() {
    let (document, data) = packed("EXT_meshopt_compression", &View::points(FLOATS0, 12, "NONE"), &CORNERS);
    let changed = |key: &str, value: Value| {
        let mut document = document.clone();
        document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
        refused(read(&document, &data))
    };
    for (key, value) in [
        ("byteLength", json!(300)),
        ("byteOffset", json!(3)),
        ("byteLength", json!(1_000_000)),
        ("byteStride", json!(10)),
        ("mode", json!("TRIANGLES")),
        ("mode", json!("NEWER")),
        ("filter", json!("OCTAHEDRAL")),
        ("buffer", json!(99)),
    ] {
        let (code, message, details) = changed(key, value.clone());
        assert!(["malformed-file", "missing-element"].contains(&code), "{key} {value}: {message}");
        assert!(code == "missing-element" || details["object"] == "bufferViews[0]", "{key} {value}: {message}");
    }
    assert_eq!(changed("count", json!(1_u64 << 50)).0, "too-large");
    for end in 0..data.len() {
        let mut cut = data.clone();
        cut[end] ^= 0x55;
        let _ = read(&document, &cut);
    }
}

#[test]
fn views_that_no_point_needs_may_be_compressed_in_any_way() {
    let (mut document, data) = packed("EXT_meshopt_compression", &View::points(FLOATS0, 12, "NONE"), &CORNERS);
    let views = document["bufferViews"].as_array_mut().unwrap();
    let mut normals = views[0].clone();
    normals["extensions"]["EXT_meshopt_compression"]["filter"] = json!("OCTAHEDRAL");
    views.push(normals);
    document["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "bufferView": 2, "componentType": 5120, "count": 64, "type": "VEC3" }));
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(2);
    assert_near_torus(&read(&document, &data).unwrap(), 1e-6);
}
