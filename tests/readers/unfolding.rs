//! GLBs that become much larger than they are.

use serde_json::{Value, json};

use crate::body_on_joints::Body;
use crate::sample::{Sample, glb, gltf_data, gltf_document, torus};

/// A document with one mesh of one primitive, whose first accessor is of points as floats.
fn document(points: usize, primitive: Value) -> Value {
    let (data, primitives) = (gltf_document(&torus()), json!([primitive]));
    let accessors = json!([{ "bufferView": 0, "componentType": 5126, "count": points, "type": "VEC3" }]);
    let nothing = json!([]);
    json!({
        "asset": data["asset"], "scenes": data["scenes"], "nodes": data["nodes"], "meshes": [{ "primitives": primitives }],
        "accessors": accessors, "bufferViews": nothing, "buffers": nothing,
    })
}

/// Adds data that EXT_meshopt_compression makes `count` items of `stride` bytes from.
fn compress(document: &mut Value, data: &mut Vec<u8>, packed: &[u8], [count, stride]: [usize; 2], mode: &str) {
    let (offset, length) = (data.len(), packed.len());
    data.extend(packed);
    let extension = json!({ "EXT_meshopt_compression": {
        "buffer": 0, "byteOffset": offset, "byteLength": length, "byteStride": stride, "count": count, "mode": mode,
    } });
    let view = json!({ "buffer": 0, "byteLength": length, "extensions": extension });
    document["bufferViews"].as_array_mut().expect("views").push(view);
    document["buffers"] = json!([{ "byteLength": data.len() }]);
}

/// A file of about so many bytes that is decompressed into that many times as many, all one point, in version 1 of the bitstream: two bits for each byte of 256
/// points say that it is the one before.
pub fn zeros(bytes: usize, times: usize) -> Vec<u8> {
    let blocks = bytes * times / (256 * 12);
    let count = 256 * blocks;
    let packed = [vec![0xA1], vec![0xAA; 3 * blocks], vec![0; 24]].concat();
    let (mut document, mut data) = (document(count, json!({ "attributes": { "POSITION": 0 }, "mode": 0 })), Vec::new());
    compress(&mut document, &mut data, &packed, [count, 12], "ATTRIBUTES");
    data.resize(data.len().max(bytes), 0);
    glb(&document, &data)
}

/// Points on a random walk, compressed 12.8 times: of each coordinate one byte changes, by what two bits say. With `fan` they are corners of a fan of triangles,
/// which takes another byte for each.
pub fn walk(points: usize, fan: bool) -> Vec<u8> {
    let mut random = crate::shapes::Random(4);
    let blocks = points / 256;
    let (count, faces) = (256 * blocks, 256 * blocks - 2);
    let mut packed = vec![0xA0];
    for column in (0..blocks).flat_map(|_| 0..12) {
        let changes = column % 4 == 2;
        packed.extend([if changes { 0x55 } else { 0 }; 4]);
        packed.extend((0..if changes { 64 } else { 0 }).map(|_| random.bits() as u8 & 0x55));
    }
    packed.extend([[0; 12], [0; 12]].concat()[..20].iter());
    packed.extend([1.0_f32; 3].map(f32::to_le_bytes).concat());
    let primitive = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
    let (mut document, mut data) = (document(count, primitive), Vec::new());
    compress(&mut document, &mut data, &packed, [count, 12], "ATTRIBUTES");
    if fan {
        let packed = [vec![0xE1, 0xF0], vec![0; faces - 1], vec![0; 16]].concat();
        compress(&mut document, &mut data, &packed, [3 * faces, 4], "TRIANGLES");
        document["meshes"][0]["primitives"] = json!([{ "attributes": { "POSITION": 0 }, "indices": 1 }]);
        let corners = json!({ "bufferView": 1, "componentType": 5125, "count": 3 * faces, "type": "SCALAR" });
        document["accessors"].as_array_mut().expect("accessors").push(corners);
    }
    glb(&document, &data)
}

/// A mesh that so many nodes draw, each beside the one before.
pub fn instances(mesh: &Sample, count: usize) -> Vec<u8> {
    let mut document = gltf_document(mesh);
    document["scenes"][0]["nodes"] = (0..count).collect();
    document["nodes"] = (0..count).map(|i| json!({ "mesh": 0, "translation": [7 * i, 0, 0] })).collect();
    glb(&document, &gltf_data(mesh))
}

/// A torus of which so many primitives draw all faces, from the same accessors.
pub fn drawn_again(primitives: usize, mesh: &Sample) -> Vec<u8> {
    let mut document = gltf_document(mesh);
    let primitive = document["meshes"][0]["primitives"][0].clone();
    document["meshes"][0]["primitives"] = vec![primitive; primitives].into();
    glb(&document, &gltf_data(mesh))
}

/// So many points of an accessor that stores those of a torus and no others.
pub fn sparse(points: usize) -> Vec<u8> {
    let mut body = Body::new();
    let places: Vec<u8> = (0..64_u32).flat_map(u32::to_le_bytes).collect();
    let places = body.accessor(5125, "SCALAR", 64, &places);
    let document = &mut body.document;
    let indices = json!({ "bufferView": document["accessors"][places]["bufferView"], "componentType": 5125 });
    let stored = json!({ "count": 64, "indices": indices, "values": { "bufferView": 0 } });
    document["accessors"][0] = json!({ "componentType": 5126, "count": points, "type": "VEC3", "sparse": stored });
    document["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
    glb(document, &body.data)
}

/// Points of three bytes that hang on joints eight times, by the same bytes.
pub fn hung(points: usize) -> Vec<u8> {
    let mut body = Body::new();
    let mut random = crate::shapes::Random(6);
    let bytes: Vec<u8> = (0..4 * points).map(|_| random.bits() as u8 & 1).collect();
    let four = body.accessor(5121, "VEC4", points, &bytes);
    let three = body.accessor(5121, "VEC3", points, &[]);
    let document = &mut body.document;
    let view = document["accessors"][four]["bufferView"].clone();
    document["accessors"][three]["bufferView"] = view;
    let sets =
        (0..8).flat_map(|set| [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")].map(|name| (name, json!(four))));
    let attributes = sets.chain([("POSITION".to_owned(), json!(three))]).collect::<serde_json::Map<String, Value>>();
    document["meshes"][0]["primitives"] = json!([{ "attributes": attributes, "mode": 0 }]);
    glb(document, &body.data)
}

/// A document that holds, between `before` and `after`, about so many bytes of `item`.
pub fn json_of(before: &str, item: &str, after: &str, bytes: usize) -> Vec<u8> {
    let items = vec![item; bytes / (item.len() + 1)].join(",");
    format!("{{\"asset\":{{\"version\":\"2.0\"}},{before}[{items}]{after}}}").into_bytes()
}
