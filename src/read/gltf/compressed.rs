//! Buffer views that are compressed with EXT_meshopt_compression: what the document says of them, and their bytes.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::budget::Budget;
use super::container::GLTF;
use super::meshopt::{self, Mode};
use crate::read::error::{Place, ReadError};

/// Both names of the extension; the second allows a newer bitstream.
pub(super) const EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// A compressed view.
pub(super) struct Compressed {
    view: usize,
    /// Where its bytes are.
    pub buffer: usize,
    offset: usize,
    length: usize,
    count: usize,
    stride: usize,
    mode: Option<Mode>,
    /// Whether numbers are folded into exponent and mantissa; none for a filter that no point has.
    exponents: Option<bool>,
}

impl Compressed {
    /// Its bytes in the data of its buffer.
    pub fn decode(&self, data: &[u8]) -> Result<Vec<u8>, ReadError> {
        let malformed = |problem: &str| {
            let at = Place::Object(format!("bufferViews[{}]", self.view));
            ReadError::Malformed { format: GLTF, problem: problem.to_owned(), at }
        };
        let (Some(mode), Some(exponents)) = (self.mode, self.exponents) else {
            return Err(malformed("it is compressed in a way that points and faces never are"));
        };
        let end = self.offset.checked_add(self.length).filter(|end| *end <= data.len());
        let part = end.map(|end| &data[self.offset..end]).ok_or_else(|| {
            malformed(&format!("it reaches beyond the {} bytes of buffer {}", data.len(), self.buffer))
        })?;
        let mut decoded = meshopt::decode(part, mode, self.count, self.stride)
            .ok_or_else(|| malformed("its compressed data cannot be unfolded; the file may be damaged"))?;
        if exponents {
            meshopt::unfold_exponents(&mut decoded);
        }
        Ok(decoded)
    }
}

/// Takes the compressed views that geometry uses out of the document `root`, which has been reduced to it, and lets them point to buffers
/// that are added at its end. `extensions` holds what each view said before.
pub(super) fn take(root: &mut Value, extensions: &[Value], budget: &mut Budget) -> Result<Vec<Compressed>, ReadError> {
    let mut taken = Vec::new();
    for view in used(root) {
        let Some(extension) = extensions.get(view).and_then(|e| EXTENSIONS.iter().find_map(|name| e.get(name))) else {
            continue;
        };
        let number = |key: &str| extension[key].as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
        let (count, stride) = (number("count"), number("byteStride"));
        let bytes = count.saturating_mul(stride);
        budget.hold(bytes)?;
        let mode = match extension["mode"].as_str() {
            Some("ATTRIBUTES") => Some(Mode::Attributes),
            Some("TRIANGLES") => Some(Mode::Triangles),
            Some("INDICES") => Some(Mode::Indices),
            _ => None,
        };
        let exponents = match extension["filter"].as_str() {
            None | Some("NONE") => Some(false),
            Some("EXPONENTIAL") => Some(true),
            Some(_) => None,
        };
        let (buffer, offset, length) = (number("buffer"), number("byteOffset"), number("byteLength"));
        taken.push(Compressed { view, buffer, offset, length, count, stride, mode, exponents });
        let Some(buffers) = root["buffers"].as_array_mut() else { continue };
        buffers.push(json!({ "byteLength": bytes.max(1) }));
        let buffer = buffers.len() - 1;
        root["bufferViews"][view] = match mode {
            Some(Mode::Attributes) => json!({ "buffer": buffer, "byteLength": bytes.max(1), "byteStride": stride }),
            _ => json!({ "buffer": buffer, "byteLength": bytes.max(1) }),
        };
    }
    Ok(taken)
}

/// The views that accessors of geometry read.
fn used(root: &Value) -> BTreeSet<usize> {
    let mut accessors = BTreeSet::new();
    let mut note = |value: &Value| accessors.extend(value.as_u64());
    for mesh in root["meshes"].as_array().into_iter().flatten() {
        for primitive in mesh["primitives"].as_array().into_iter().flatten() {
            note(&primitive["indices"]);
            let targets = primitive["targets"].as_array().into_iter().flatten();
            for attributes in std::iter::once(&primitive["attributes"]).chain(targets) {
                attributes.as_object().into_iter().flatten().for_each(|(_, accessor)| note(accessor));
            }
        }
    }
    root["skins"].as_array().into_iter().flatten().for_each(|skin| note(&skin["inverseBindMatrices"]));
    let views = accessors.into_iter().flat_map(|index| {
        let accessor = &root["accessors"][index as usize];
        let sparse = &accessor["sparse"];
        [&accessor["bufferView"], &sparse["indices"]["bufferView"], &sparse["values"]["bufferView"]].map(Value::as_u64)
    });
    views.flatten().filter_map(|view| usize::try_from(view).ok()).collect()
}
