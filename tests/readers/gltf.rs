use geose_fmap::{ReadOptions, read_with};
use serde_json::{Value, json};

use crate::sample::{Sample, assert_is_torus, glb, gltf_data, gltf_document, parse, refused, repaired, torus};

fn read(document: &Value) -> Result<geose_fmap::Shape, geose_fmap::Error> {
    parse(glb(document, &gltf_data(&torus())), "a.glb")
}

/// The torus's document after a change.
fn changed(change: impl FnOnce(&mut Value)) -> Value {
    let mut document = gltf_document(&torus());
    change(&mut document);
    document
}

#[test]
fn transforms_of_nested_nodes_are_applied() {
    let half = 0.5_f64.sqrt();
    let document = changed(|d| {
        d["nodes"] = json!([
            { "children": [1], "translation": [10, 0, 0], "scale": [2, 2, 2] },
            { "mesh": 0, "rotation": [0, 0, half, half] },
        ]);
    });
    let shape = read(&document).unwrap();
    for (p, [x, y, z]) in shape.points().iter().zip(torus().points) {
        let expected = [10.0 - 2.0 * y, 2.0 * x, 2.0 * z]; // a quarter turn about z
        assert!((0..3).all(|i| (p[i] - expected[i]).abs() < 1e-6), "{p:?} is not {expected:?}"); // rotation is stored in f32
    }
    assert_eq!(shape.faces(), torus().faces);
}

#[test]
fn a_matrix_is_read_by_columns() {
    let document = changed(|d| d["nodes"][0]["matrix"] = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1]));
    for (p, [x, y, z]) in read(&document).unwrap().points().iter().zip(torus().points) {
        assert_eq!(*p, [10.0 - 2.0 * y, 2.0 * x, 2.0 * z]);
    }
}

#[test]
fn a_mirroring_node_keeps_the_outside_outside() {
    let shape = read(&changed(|d| d["nodes"][0]["scale"] = json!([-1, 1, 1]))).unwrap();
    assert_eq!(shape.faces()[0], [0, 9, 8]);
    assert_eq!(shape.points()[3][0], -torus().points[3][0]);
}

#[test]
fn meshes_of_all_scenes_are_joined_in_node_order_and_each_node_once() {
    let document = changed(|d| {
        d["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [10, 0, 0] }]);
        d["scenes"] = json!([{ "nodes": [1] }, { "nodes": [0, 1] }, {}]);
    });
    let shape = read(&document).unwrap();
    assert_eq!((shape.points().len(), shape.faces().len()), (128, 256));
    assert_eq!((shape.points()[0][0], shape.points()[64][0]), (13.0, 3.0));
    assert_eq!(shape.faces()[128], [64, 72, 73]);
    assert_eq!(repaired(&shape, "separate-pieces"), 2);
}

#[test]
fn files_without_scenes_or_nodes_show_what_they_have() {
    assert_is_torus(&read(&changed(|d| drop(d.as_object_mut().unwrap().remove("scenes")))).unwrap());
    assert_is_torus(
        &read(&changed(|d| ["scenes", "nodes"].iter().for_each(|k| drop(d.as_object_mut().unwrap().remove(*k)))))
            .unwrap(),
    );
}

#[test]
fn primitives_that_share_their_points_add_them_once() {
    let document = changed(|d| {
        d["accessors"][1]["count"] = json!(192);
        d["accessors"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "bufferView": 1, "byteOffset": 768, "componentType": 5125, "count": 192, "type": "SCALAR" }));
        let primitives = d["meshes"][0]["primitives"].as_array_mut().unwrap();
        primitives.push(json!({ "attributes": { "POSITION": 0 }, "indices": 2 }));
    });
    assert_is_torus(&read(&document).unwrap());
}

#[test]
fn quantised_points_are_scaled_as_the_extension_says() {
    for (kind, size, largest) in [(5120, 1, 127.0), (5121, 1, 255.0), (5122, 2, 32767.0), (5123, 2, 65535.0)] {
        for normalized in [false, true] {
            let whole = |c: f64| (c.abs() * 40.0).round();
            let mut data = Vec::new();
            for p in torus().points {
                p.iter().for_each(|&c| data.extend(&(whole(c) as u32).to_le_bytes()[..size]));
                data.resize(data.len().next_multiple_of(4), 0);
            }
            let stride = data.len() / 64;
            let document = changed(|d| {
                d["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
                d["accessors"][0] = json!({ "bufferView": 0, "componentType": kind, "count": 64, "type": "VEC3", "normalized": normalized });
                d["bufferViews"] = json!([{ "buffer": 0, "byteLength": data.len(), "byteStride": stride }]);
                d["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
                d["accessors"].as_array_mut().unwrap().truncate(1);
                d["buffers"][0]["byteLength"] = json!(data.len());
            });
            let cloud = parse(glb(&document, &data), "a.glb").unwrap();
            let expected =
                torus().points.iter().map(|p| p.map(|c| whole(c) / if normalized { largest } else { 1.0 })).collect();
            assert_eq!((cloud.points().to_vec(), cloud.faces().len()), (expected, 0));
        }
    }
}

#[test]
fn strips_and_fans_turn_all_their_triangles_the_same_way() {
    let corners: Vec<u32> = (0..8).collect();
    for (mode, second) in [(5, [1, 3, 2]), (6, [2, 3, 0])] {
        let sample = Sample { faces: vec![[0, 1, 2], [3, 4, 5], [6, 7, 0]], ..torus() };
        let mut document = gltf_document(&sample);
        document["accessors"][1]["count"] = json!(corners.len());
        document["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let shape = parse(glb(&document, &gltf_data(&sample)), "a.glb").unwrap();
        assert_eq!(shape.faces().len(), 6);
        assert_eq!(shape.faces()[1], second);
        assert_eq!(repaired(&shape, "inconsistent-winding"), 0);
    }
}

#[test]
fn sparse_accessors_replace_their_points() {
    let mut data = gltf_data(&torus());
    let start = data.len();
    data.extend([5_u8, 0, 0, 0]);
    data.extend([7.0_f32, 8.0, 9.0].map(f32::to_le_bytes).concat());
    let document = changed(|d| {
        d["buffers"][0]["byteLength"] = json!(data.len());
        let views = d["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": 1 }));
        views.push(json!({ "buffer": 0, "byteOffset": start + 4, "byteLength": 12 }));
        let sparse =
            json!({ "count": 1, "indices": { "bufferView": 2, "componentType": 5121 }, "values": { "bufferView": 3 } });
        d["accessors"][0]["sparse"] = sparse;
    });
    let shape = parse(glb(&document, &data), "a.glb").unwrap();
    assert_eq!((shape.points()[5], shape.points()[6]), ([7.0, 8.0, 9.0], torus().points[6]));
}

#[test]
fn what_is_wrong_or_new_outside_the_geometry_does_not_matter() {
    let document = changed(|d| {
        d["materials"] = json!([{ "alphaMode": "SHINY", "extensions": { "KHR_materials_moss": {} } }]);
        d["textures"] = json!([{ "extensions": { "EXT_texture_webp": { "source": 0 } } }]);
        d["extensionsRequired"] = json!(["EXT_texture_webp", "KHR_materials_moss"]);
        d["meshes"][0]["primitives"][0]["material"] = json!(12);
        d["nodes"][0]["camera"] = json!(3);
        d["animations"] = json!("none");
    });
    assert_is_torus(&read(&document).unwrap());
}

#[test]
fn an_unsupported_required_extension_is_named() {
    for name in ["KHR_draco_mesh_compression", "EXT_mesh_gpu_instancing", "VENDOR_new_geometry"] {
        let (code, message, details) = refused(read(&changed(|d| d["extensionsRequired"] = json!([name]))));
        assert_eq!((code, &details["extension"]), ("unsupported-extension", &json!(name)));
        assert!(message.contains(name) && message.contains("save it without"), "{message}");
        assert_eq!(message.contains("without Draco"), name.contains("draco"), "{message}");
    }
    let without_fallback = changed(|d| {
        d["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
        d["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    });
    assert_eq!(refused(read(&without_fallback)).0, "unsupported-extension");
}

#[test]
fn data_in_another_file_is_refused_with_its_name() {
    let (code, message, _) = refused(read(&changed(|d| d["buffers"][0]["uri"] = json!("body.bin"))));
    assert_eq!(code, "external-buffer");
    assert!(message.contains("“body.bin”"), "{message}");
    let (_, message, _) = refused(read(&changed(|d| d["buffers"][0]["uri"] = json!("my%20body.bin"))));
    assert!(message.contains("“my body.bin”"), "{message}");
    assert_eq!(refused(read(&changed(|d| d["buffers"][0]["uri"] = json!("data:;base64,@@@")))).0, "malformed-file");
}

#[test]
fn lying_lengths_are_refused_where_they_lie() {
    let whole = glb(&gltf_document(&torus()), &gltf_data(&torus()));
    for (at, what) in [(8, "bytes"), (12, "bytes of a chunk")] {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        let (code, _, details) = refused(parse(bytes, "a.glb"));
        assert_eq!((code, &details["what"], &details["promised"]), ("truncated-file", &json!(what), &json!(u32::MAX)));
    }
    for length in [0_u32, 3, 11, 12, 13, 20] {
        let mut bytes = whole.clone();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        assert_eq!(refused(parse(bytes, "a.glb")).0, "truncated-file");
    }
}

#[test]
fn accessors_that_reach_too_far_are_refused() {
    let huge = json!(u64::MAX / 4);
    let cases = [
        ("truncated-file", "accessors", 0, "count", json!(65)),
        ("truncated-file", "accessors", 0, "byteOffset", json!(4)),
        ("truncated-file", "accessors", 1, "byteOffset", huge.clone()),
        ("truncated-file", "buffers", 0, "byteLength", huge.clone()),
        ("too-large", "accessors", 0, "count", huge.clone()),
        ("malformed-file", "bufferViews", 0, "byteLength", huge),
        ("malformed-file", "bufferViews", 0, "byteOffset", json!(u64::MAX)),
        ("malformed-file", "bufferViews", 0, "byteStride", json!(8)),
        ("malformed-file", "accessors", 0, "componentType", json!(5125)),
        ("malformed-file", "accessors", 0, "componentType", json!(1)),
        ("malformed-file", "accessors", 0, "type", json!("VEC2")),
    ];
    for (expected, list, index, key, value) in cases {
        let (code, message, _) = refused(read(&changed(|d| d[list][index][key] = value)));
        assert_eq!(code, expected, "{list}[{index}].{key}: {message}");
    }
}

#[test]
fn graphs_that_are_no_trees_and_small_files_that_unfold_are_refused() {
    let cycle = changed(|d| d["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "children": [0] }]));
    assert_eq!(refused(read(&cycle)).1, "glTF, nodes[0]: the node is reached twice; nodes must form a tree");
    let zeros = changed(|d| {
        let sparse =
            json!({ "count": 1, "indices": { "bufferView": 1, "componentType": 5125 }, "values": { "bufferView": 0 } });
        d["accessors"][0] = json!({ "componentType": 5126, "count": 1_000_000, "type": "VEC3", "sparse": sparse });
    });
    assert_eq!(refused(read(&zeros)).0, "too-large");
    let deep = format!("{{\"a\":{}", "[".repeat(100_000));
    assert_eq!(refused(parse(deep, "a.gltf")).0, "malformed-file");
}

#[test]
fn bad_references_are_named_by_their_object() {
    let (_, message, details) = refused(read(&changed(|d| d["meshes"][0]["primitives"][0]["indices"] = json!(7))));
    assert_eq!(details["object"], "meshes[0].primitives[0].indices", "{message}");
    let (code, message, _) = refused(read(&changed(|d| d["accessors"][1]["count"] = json!(100))));
    assert_eq!(
        (code, message.as_str()),
        ("malformed-file", "glTF, meshes[0].primitives[0]: 100 corners do not make whole triangles")
    );
    let sample = Sample { faces: vec![[0, 1, 64]], ..torus() };
    let (code, _, details) = refused(parse(glb(&gltf_document(&sample), &gltf_data(&sample)), "a.glb"));
    assert_eq!((code, &details["index"], &details["points"]), ("face-index-out-of-range", &json!(64), &json!(64)));
    assert_eq!(refused(read(&changed(|d| d["meshes"] = json!([])))).0, "malformed-file");
    assert_eq!(refused(read(&changed(|d| d["asset"]["version"] = json!("1.0")))).0, "unsupported-variant");
    assert_eq!(refused(parse("{\"asset\": {\"version\": \"2.0\"}}", "a.gltf")).0, "missing-element");
}

#[test]
fn y_is_up_as_the_format_says() {
    assert_eq!(read(&gltf_document(&torus())).unwrap().up(), Some(geose_fmap::Axis::Y));
}

#[test]
fn data_in_a_file_beside_the_document_is_read_when_it_is_given_along() {
    let data = gltf_data(&torus());
    for (uri, name) in [
        ("body.bin", "body.bin"),
        ("my%20body.bin", "my body.bin"),
        ("./buffers/Body.bin", "body.bin"),
        ("buffers/body.bin", "buffers/body.bin"),
        ("k%C3%B6rper.bin", "körper.bin"),
    ] {
        let mut document = changed(|d| d["buffers"][0]["uri"] = json!(uri));
        document["images"] = json!([{ "uri": "skin.png" }]);
        let text = document.to_string();
        let companions: [(&str, &[u8]); 2] = [("skin.png", b"no picture"), (name, &data)];
        let options = ReadOptions { name: Some("a.gltf"), companions: &companions, ..ReadOptions::default() };
        assert_is_torus(&read_with(text.as_bytes(), &options).unwrap_or_else(|e| panic!("{uri}: {e}")));
        let short: [(&str, &[u8]); 1] = [(name, &data[..100])];
        let options = ReadOptions { companions: &short, ..options };
        assert_eq!(read_with(text.as_bytes(), &options).expect_err("too short").code(), "truncated-file");
        let other: [(&str, &[u8]); 1] = [("another.bin", &data)];
        let options = ReadOptions { companions: &other, ..options };
        assert_eq!(read_with(text.as_bytes(), &options).expect_err("not there").code(), "external-buffer");
    }
}

#[test]
fn chunks_that_are_not_filled_up_to_whole_words_are_read_and_said_so() {
    for extra in 0..8 {
        let document = changed(|d| d["asset"]["generator"] = json!("x".repeat(extra)));
        let (json, data) = (document.to_string().into_bytes(), gltf_data(&torus()));
        for counts_filling in [false, true] {
            let length = 12 + 8 + json.len() + 8 + data.len();
            let length = if counts_filling { length.next_multiple_of(4) } else { length };
            let mut bytes = b"glTF".to_vec();
            bytes.extend([2, length as u32, json.len() as u32].map(u32::to_le_bytes).concat());
            bytes.extend(b"JSON");
            bytes.extend(&json);
            bytes.extend((data.len() as u32).to_le_bytes());
            bytes.extend(b"BIN\0");
            bytes.extend(&data);
            let shape = parse(&bytes, "a.glb").unwrap_or_else(|e| panic!("{extra}: {e}"));
            assert_eq!((shape.points(), shape.faces()), (&torus().points[..], &torus().faces[..]));
            assert_eq!(repaired(&shape, "chunk-not-padded"), usize::from(json.len() % 4 != 0));
            assert_eq!(refused(parse(&bytes[..bytes.len() - 4], "a.glb")).0, "truncated-file");
        }
    }
}

#[test]
fn json_may_be_filled_up_with_zeros() {
    let mut bytes = glb(&gltf_document(&torus()), &gltf_data(&torus()));
    let end = 20 + u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
    for at in (end - 3..end).rev().take_while(|at| gltf_document(&torus()).to_string().len() + 20 <= *at) {
        bytes[at] = 0;
    }
    assert_is_torus(&parse(bytes, "a.glb").unwrap());
}

#[test]
fn the_first_version_of_gltf_is_named_with_the_way_out() {
    for text in [
        r#"{ "asset": { "version": "1.0" }, "meshes": { "body": {} } }"#,
        r#"{ "asset": { "version": 1.0 }, "meshes": { "body": {} } }"#,
        r#"{ "accessors": {}, "meshes": { "body": {} } }"#,
    ] {
        let (code, message, _) = refused(parse(text, "a.gltf"));
        assert_eq!(code, "unsupported-variant", "{message}");
        assert_eq!(message, "version 1.0 of glTF cannot be read; save it as glTF 2.0");
    }
}
