//! A coloured scan as binary glTF 2.0.

use serde_json::{Value, json};

use super::{Body, LinearRgb, upright};
use crate::shape::Axis;

/// `componentType` of an accessor (glTF 2.0, section 3.6.2.2).
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
/// `mode` of a primitive.
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;

/// Points in the order they were read in, the faces if there are any, and `colours` (n). glTF is upright and in metres, so the node turns and
/// scales the body; one of no clear unit or upward axis stays as it is. Points are kept around the node's origin, because glTF has no
/// numbers finer than 32 bits. `None` where that is more than the 4 GiB a GLB can hold.
pub(crate) fn glb(body: &Body, colours: &[LinearRgb]) -> Option<Vec<u8>> {
    let (points, faces) = (body.shape.points(), body.shape.faces());
    let (mut low, mut high) = (points[0], points[0]);
    for p in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let centre: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    let around = |p: &[f64; 3]| -> [f32; 3] { std::array::from_fn(|axis| (p[axis] - centre[axis]) as f32) };

    let mut data = Vec::with_capacity(24 * points.len() + 12 * faces.len());
    points.iter().flat_map(around).for_each(|c| data.extend(c.to_le_bytes()));
    colours.iter().flatten().for_each(|&c| data.extend((c as f32).to_le_bytes()));
    faces.iter().flatten().for_each(|i| data.extend(i.to_le_bytes()));
    let mut json = document(body, [around(&low), around(&high)], centre, data.len()).to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');

    let length = 12 + 8 + json.len() + 8 + data.len();
    let mut bytes = Vec::with_capacity(length);
    bytes.extend(b"glTF");
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend(u32::try_from(length).ok()?.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", data)] {
        bytes.extend(u32::try_from(chunk.len()).ok()?.to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    Some(bytes)
}

/// The JSON over `length` bytes of positions, colours and corners.
fn document(body: &Body, bounds: [[f32; 3]; 2], centre: [f64; 3], length: usize) -> Value {
    let (n, corners) = (body.shape.points().len(), 3 * body.shape.faces().len());
    let mesh = corners > 0;
    let mut views = vec![
        json!({ "buffer": 0, "byteOffset": 0, "byteLength": 12 * n }),
        json!({ "buffer": 0, "byteOffset": 12 * n, "byteLength": 12 * n }),
    ];
    let mut accessors = vec![
        json!({ "bufferView": 0, "componentType": FLOAT, "count": n, "type": "VEC3", "min": bounds[0], "max": bounds[1] }),
        json!({ "bufferView": 1, "componentType": FLOAT, "count": n, "type": "VEC3" }),
    ];
    let mut primitive = json!({ "attributes": { "POSITION": 0, "COLOR_0": 1 }, "material": 0, "mode": POINTS });
    // Neither metal nor mirror; loose points have no side that light could fall on.
    let mut material =
        json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.85 }, "doubleSided": true });
    if mesh {
        views.push(json!({ "buffer": 0, "byteOffset": 24 * n, "byteLength": 4 * corners }));
        accessors.push(json!({ "bufferView": 2, "componentType": UNSIGNED_INT, "count": corners, "type": "SCALAR" }));
        primitive["indices"] = json!(2);
        primitive["mode"] = json!(TRIANGLES);
    } else {
        material["extensions"] = json!({ "KHR_materials_unlit": {} });
    }
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "geose-fmap" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [node(body, centre)],
        "meshes": [{ "primitives": [primitive] }],
        "materials": [material],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": length }],
    });
    if !mesh {
        document["extensionsUsed"] = json!(["KHR_materials_unlit"]);
    }
    document
}

/// The node that stands the body upright, in metres, with `centre` where it was.
fn node(body: &Body, centre: [f64; 3]) -> Value {
    let metres = match body.unit {
        Some("cm") => 0.01,
        Some("mm") => 0.001,
        _ => 1.0,
    };
    let quarter = 0.5_f64.sqrt();
    let rotation = match body.up {
        Some(Axis::X) => [0.0, 0.0, quarter, quarter],
        Some(Axis::Z) => [-quarter, 0.0, 0.0, quarter],
        Some(Axis::Y) | None => [0.0, 0.0, 0.0, 1.0],
    };
    let translation = upright(body.up).map(|(axis, sign)| metres * sign * centre[axis]);
    json!({
        "name": body.name,
        "mesh": 0,
        "rotation": rotation,
        "scale": [metres, metres, metres],
        "translation": translation,
    })
}
