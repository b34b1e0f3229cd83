//! The torus of `sample.rs` compressed by meshoptimizer 1.3.0 (npm): its positions as floats and as 16-bit integers (times 1000, four to a point) in both
//! versions of the bitstream (`encodeVertexBufferLevel`, levels 2 and 3), as floats through `encodeFilterExp` with 24 bits, its faces by `encodeIndexBuffer`
//! and `encodeIndexSequence`.
#![allow(dead_code, reason = "each test file uses its own part of these")]

use serde_json::{Value, json};

use crate::sample::{gltf_document, torus};

pub const FLOATS0: &str = "\
         oP8Aennz9PP0evJ6ABkaGRoAUa2Bo6SjpIKGegAZGhkaABp6efP08/R68noAGRoZGgDKA+g8Ozw758B6ABkaGRoA/wCCgfr5+vmC+4IACgkKCQ\
         B1piq0s7SzKbGCAAoJCgkAB4KB+vn6+YL7ggAKCQoJAFn86D49Pj3n3IIACgkKCQD/ACVZtUlKtlpLI3+VaWqWgLwnY61RUq5kbyN/lWlqloCW\
         JVm1SUq2Wksjf5VpapaAUh13lWlqlngPI3+VaWqWgFUBCBAAwQjQADPJgQgQAMQC0AAxy/0AAPP8k3oZGhkaGnp58/Tz9HryegAZGhkaAFGtga\
         Oko6SChnoAGRoZGgAaennz9PP0evJ6ABkaGRoA/QAA8/x5ggoJCgkHgoH6+fr5gvuCAAoJCgkAdaYqtLO0symxggAKCQoJAAeCgfr5+vmC+4IA\
         CgkKCQD9AAD//w4jf5VpapaAliVZtUlKtlpLI3+VaWqWgEMnY61RUq5kkCN/lWlqloCWJVm1SUq2Wksjf5VpapaAVQAA0ACAgQgQAMAA0AAzyY\
         EIEAD/ABkaGX59GhkaGRoZfn0aGRoZGhl+fRoZGhkaGX59GhkaGRoZfn0aGRoZGhl+fRoZGhkaGX59GhkaGRoZfn0aGaoIeP94eHj/eFpZWll4\
         eP94eHj/eFpZWll4eP94eHj/eFpZWll4eP94eHj/eFpZWln/AGqWlU9QlpVpapaVT1CWlWlqlpVPUJaVaWqWlU9QlpVpapaVT1CWlWlqlpVPUJ\
         aVaWqWlU9QlpVpapaVT1CWlVUw8PDwfjPLgn4zy/Dw8PCCfjPLgn4zy/Dw8PCCfjPLgn4zy/Dw8PCCfjPLgn4zywAAAAAAAAAAAAAAAAAAAAAA\
         AAAAAABAQAAAAAAAAAAA";
pub const FLOATS1: &str = "\
         oT8VdwB6eQwLDAt6DXoA5uXm5QBRUn5cW1xbfXl6AObl5uUA5Xp5DAsMC3oNegDm5eblADX86Dw7PDvnwHoA5uXm5QAAgoL7+/v7gvuCAAkJCQ\
         kAdqUptbW1tSmxggAJCQkJAAmCgvv7+/uC+4IACQkJCQBb++g+Pj4+6NyCAAkJCQkAACVZtUlKtlpLI3+VaWqWgEMnY61RUq5kbyN/lWlqloCW\
         JVm1SUq2Wksjf5VpapaArR13lWlqlngPI3+VaWqWgEQBATXKAQEzzPwAe5N65uXm5eV6eQwLDAt6DXoA5uXm5QBRUn5cW1xbfXl6AObl5uUA5X\
         p5DAsMC3oNegDm5eblAPwAe3iCCQkJCQmCgvv7+/uC+4IACQkJCQB2pSm1tbW1KbGCAAkJCQkACYKC+/v7+4L7ggAJCQkJAPwA/w4jf5VpapaA\
         liVZtUlKtlpLI3+VaWqWgEMnY61RUq5kbyN/lWlqloCWJVm1SUq2Wksjf5VpapaAEQABgAEBNMsAGRoZfn0aGRoZGhl+fRoZGhkaGX59GhkaGR\
         oZfn0aGRoZGhl+fRoZGhkaGX59GhkaGRoZfn0aGRoZGhl+fRoZqgh4/3h4eP94WllaWXh4/3h4eP94WllaWXh4/3h4eP94WllaWXh4/3h4eP94\
         WllaWQBqlpVPUJaVaWqWlU9QlpVpapaVT1CWlWlqlpVPUJaVaWqWlU9QlpVpapaVT1CWlWlqlpVPUJaVaWqWlU9QlpUAMjN+M8uCfjPLMzOCfj\
         PLgn4zyzMzgn4zy4J+M8szM4J+M8uCfjPLAAAAAAAAAAAAAABAQAAAAAAAAAAAAQEA";
pub const SHORTS0: &str = "\
         oHcASXp6SUp5eZNiGBhiYRcXwAD///ORYRcXYWIYGHtKeXlKSXp6lGEXF2FiGBjAAP//9JJiGBhiYRcXqgFTNEYxMxJE0AAAAPJEITMRcmRDNU\
         JEITPwAAAA8TMSRBAQ3QAA//+SYhgYYmEXF3xJenpJSnl5k2IYGGJhFxfAAP//85FhFxdhYhgYe0p5eUpJenqUYRcXYWIYGKkAAN9vEAMDBASB\
         UzRGMTMSRNAAAADyRCEzEXJkQzVCRCEz/wB5Skl6eklKeXlKSXp6SUp5eUpJenpJSnl5Skl6eklKeXlKSXp6SUp5eUpJenpJSnl5Skl6eklKeX\
         lKSXp6SUqqBCE1EmQhNRJkITUSZCE1EmQhNRJkITUSZCE1EmQhNRIAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAALgLAAAAAAAA";
pub const SHORTS1: &str = "\
         oVWnMwBJhYVJSoaGk53n552e6OgB//ORnujonp3n53tKhoZKSYWFlJ7o6J6d5+cB//SSnefnnZ7o6KoCVSJVQTMRM+AAAADxMxEzEIJVIlVBMx\
         Ez4AAAAPEzETMQzAD/kp3n552e6Oh8SYWFSUqGhpOd5+ednujoAf/zkZ7o6J6d5+d7SoaGSkmFhZSe6OienefnqQAA318QAwMDA4JVIlVBMxEz\
         4AAAAPEzETMQglUiVUEzETMAwysrwz0lJT3DKyvDPSUlPcMrK8M9JSU9wysrwz0lJT3DKyvDPSUlPcMrK8M9JSU9wysrwz0lJT3DKyvDPSUlVS\
         W15bX9/f3lteW1/f39/eW15bX9/f395bXltf39/f0AAAAAAAAAAAAAAAAAALgLAAAAAAAAAQI=";
pub const EXPONENTS: &str = "\
         oP8AwcJ5enl6wXjBAPLx8vEA1qq+rq2urb0pwgDx8vHyAPTCwXp5ennCd8IA8fLx8gBjAnPi4eLhdPPBAPLx8vEA/wC/wIOEg4S/gr0A+/z7/A\
         DEqxSlpqWmE9++APz7/PsA+b69goGCgb6BvgD8+/z7AC59c+Df4N90570A+/z7/AD/ABMrJCMkIywlbj82NTY1QCETMSopKikyum1ANTY1Nj82\
         Ei4lJiUmLSZtQDU2NTY/VhBDSklKSUTpbj82NTY1QFUBCBEIwQjRCGlsgQgRCMRi0QhlaP0AAPP8ScHy8fLx88HCeXp5esF4wQDy8fLxANaqvq\
         6trq29KcIA8fLx8gD0wsF6eXp5wnfCAPHy8fIA/QAA8/w9vfv8+/z8v8CDhIOEv4K9APv8+/wAxKsUpaalphPfvgD8+/z7APm+vYKBgoG+gb4A\
         /Pv8+wD9AAD//4ZuPzY1NjVAMxMrJCMkIywlbj82NTY1QCETMSopKikyum1ANTY1Nj82Ei4lJiUmLSZtQDU2NTY/VQAA0QgEgQgRCMEI0Qhnao\
         EIEQj/APTz9D4l9PP09PP0PiX08/T08/Q+JfTz9PTz9D4l9PP09PP0PiX08/T08/Q+JfTz9PTz9D4l9PP09PP0PiX08/8A+/z7LDX5+vn7/Pss\
         Nfn6+fv8+yw1+fr5+/z7LDX5+vn7/PssNfn6+fv8+yw1+fr5+/z7LDX5+vn7/PssNfn6/wC0MzQnvjY1trQzNCe+NjW2tDM0J742Nba0MzQnvj\
         Y1trQzNCe+NjW2tDM0J742Nba0MzQnvjY1trQzNCe+NjVVCfkJ+WdoZ2gJ+Qn5Z2hnaAn5CflnaGdoCfkJ+WdoZ2gAAAAAAAAAAAAAAAAAAAAA\
         AAAAAAAAYOsAAADpAAAA6Q==";
pub const TRIANGLES: &str = "\
         4f4AHgAeAB4AHgAeAB4AEA//AB4AHgAeAB4AHgAeABAP/wAeAB4AHgAeAB4AHgAQD/8AHgAeAB4AHgAeAB4AEA//AB4AHgAeAB4AHgAeABAP/w\
         AeAB4AHgAeAB4AHgAQD/8AHgAeAB4AHgAeAB4AEA//AB4AHgAeAB4AHgAeAB8P/xACHf8QEAId/xAQAh3/EBACHf8QEAId/xAQAh3/EBACHf8Q\
         bwINcAB2h1ZneKmGZYlomAFpAAA=";
pub const SEQUENCE: &str = "\
         0QAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgGgIEHiAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBC\
         IkHgAgBCIkHgAgGgIEHiAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgGgIEHiAgBCIkHgAgBCIkHgAgBCIkHgAg\
         BCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgGgIEHiAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgGgIEHiAgBCIkHg\
         AgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgGgIEHiAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIkHgAgBCIk\
         HgAgGgIEHiABBQABBAABBQABBAABBQABBAABBQABBAABBQABBAABBQABBAABBQABBAABGwABGgAAAAA=";

fn decoded(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let letters: Vec<u8> = text.bytes().filter(|c| *c != b'=').collect();
    let groups = letters.chunks(4).flat_map(|group| {
        let bits = group.iter().fold(0_u32, |bits, c| bits << 6 | u32::from(digit(*c))) << (6 * (4 - group.len()));
        [bits >> 16, bits >> 8, bits].map(|b| b as u8).into_iter().take(group.len() - 1)
    });
    groups.collect()
}

/// A view as it is compressed.
pub struct View {
    pub data: &'static str,
    pub stride: usize,
    pub mode: &'static str,
    pub filter: &'static str,
}

impl View {
    pub fn points(data: &'static str, stride: usize, filter: &'static str) -> Self {
        Self { data, stride, mode: "ATTRIBUTES", filter }
    }
}

/// The document and the data of a torus whose points and corners are compressed, as gltfpack writes it.
pub fn packed(name: &str, points: &View, corners: &View) -> (Value, Vec<u8>) {
    let (first, second) = (decoded(points.data), decoded(corners.data));
    let mut document = gltf_document(&torus());
    let view = |view: &View, offset: usize, length: usize, count: usize| {
        json!({ "buffer": 1, "byteOffset": 0, "byteLength": count * view.stride, "extensions": { name: {
            "buffer": 0, "byteOffset": offset, "byteLength": length, "byteStride": view.stride, "count": count, "mode": view.mode,
            "filter": view.filter,
        } } })
    };
    document["bufferViews"] = json!([view(points, 0, first.len(), 64), view(corners, first.len(), second.len(), 384)]);
    let fallback = json!({ "byteLength": 4096, "extensions": { name: { "fallback": true } } });
    document["buffers"] = json!([{ "byteLength": first.len() + second.len() }, fallback]);
    document["extensionsRequired"] = json!([name, "KHR_mesh_quantization"]);
    (document, [first, second].concat())
}

pub const CORNERS: View = View { data: TRIANGLES, stride: 4, mode: "TRIANGLES", filter: "NONE" };
