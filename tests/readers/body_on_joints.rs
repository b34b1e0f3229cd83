//! A torus that hangs on two joints, as glTF.

use serde_json::{Value, json};

use crate::sample::{gltf_data, gltf_document, torus};

/// A torus that hangs on joints: a document, and its data.
pub struct Body {
    pub document: Value,
    pub data: Vec<u8>,
}

impl Body {
    /// On the joints `nodes[0]` and `nodes[1]`; `nodes[2]` shows it. Points below 32 hang on the first.
    pub fn new() -> Self {
        let mut body = Self { document: gltf_document(&torus()), data: gltf_data(&torus()) };
        let joints: Vec<u8> = (0..64_u8).flat_map(|i| [i / 32, 0, 0, 0]).collect();
        let joints = body.accessor(5121, "VEC4", 64, &joints);
        let weights: Vec<u8> = (0..64).flat_map(|_| [1.0_f32, 0.0, 0.0, 0.0]).flat_map(f32::to_le_bytes).collect();
        let weights = body.accessor(5126, "VEC4", 64, &weights);
        let document = &mut body.document;
        document["meshes"][0]["primitives"][0]["attributes"] =
            json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
        document["nodes"] = json!([{}, {}, { "mesh": 0, "skin": 0 }]);
        document["scenes"][0]["nodes"] = json!([0, 1, 2]);
        document["skins"] = json!([{ "joints": [0, 1] }]);
        body
    }

    /// Adds data and an accessor of it.
    pub fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let offset = self.data.len();
        self.data.extend(bytes);
        let document = &mut self.document;
        document["buffers"][0]["byteLength"] = json!(self.data.len());
        let push = |list: &mut Value, object: Value| {
            let list = list.as_array_mut().expect("a list");
            list.push(object);
            list.len() - 1
        };
        let view =
            push(&mut document["bufferViews"], json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }));
        push(
            &mut document["accessors"],
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }),
        )
    }

    /// Gives each of two joints the inverse of a shift along z.
    pub fn bind(&mut self, shifts: [f32; 2]) {
        let matrix = |by: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -by, 1.0];
        let bytes: Vec<u8> = shifts.into_iter().flat_map(matrix).flat_map(f32::to_le_bytes).collect();
        let inverses = self.accessor(5126, "MAT4", 2, &bytes);
        self.document["skins"][0]["inverseBindMatrices"] = json!(inverses);
    }

    /// Adds a morph target that moves every point up by 1.
    pub fn target(&mut self) {
        let bytes: Vec<u8> = (0..64).flat_map(|_| [0.0_f32, 0.0, 1.0]).flat_map(f32::to_le_bytes).collect();
        let target = self.accessor(5126, "VEC3", 64, &bytes);
        let primitive = &mut self.document["meshes"][0]["primitives"][0];
        match primitive.get_mut("targets").and_then(Value::as_array_mut) {
            Some(targets) => targets.push(json!({ "POSITION": target })),
            None => primitive["targets"] = json!([{ "POSITION": target }]),
        }
    }
}
