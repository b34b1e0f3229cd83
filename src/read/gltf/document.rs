//! The JSON of a glTF, reduced to its geometry, so that nothing wrong or new in a material, an image or an animation keeps a
//! scan from being read.

use gltf::Document;
use gltf::json::validation::{self, Validate};
use gltf::json::{Path, Root};
use serde_json::Value;

use super::budget::Budget;
use super::compressed::{self, Compressed, EXTENSIONS};
use super::container::GLTF;
use crate::read::error::{Place, ReadError, shortened};
use crate::read::options::Pose;
use crate::shape::{Repair, counted};

/// A document whose indices are all valid.
pub(super) struct Geometry {
    pub document: Document,
    /// A compression the file uses, required or not: the reason if data turns out to be missing.
    pub compression: Option<String>,
    /// Views that have to be decompressed; the last buffers of the document are what they become.
    pub compressed: Vec<Compressed>,
    /// What a viewer would show differently.
    pub repairs: Vec<Repair>,
}

/// Extensions that may be required and change no point and no face.
const HARMLESS: [&str; 7] =
    ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp"];

/// What geometry needs of each object in the lists of the root.
const KEPT: [(&str, &[&str]); 7] = [
    ("accessors", &["bufferView", "byteOffset", "componentType", "count", "normalized", "sparse", "type"]),
    ("bufferViews", &["buffer", "byteLength", "byteOffset", "byteStride"]),
    ("buffers", &["byteLength", "uri"]),
    ("meshes", &["primitives", "weights"]),
    ("nodes", &["children", "matrix", "mesh", "rotation", "scale", "skin", "translation", "weights"]),
    ("scenes", &["nodes"]),
    ("skins", &["inverseBindMatrices", "joints"]),
];

/// The geometry of a document in a pose.
pub(super) fn parse(json: &[u8], pose: Pose, budget: &mut Budget) -> Result<Geometry, ReadError> {
    budget.hold(weight(json))?;
    // Names may be in another encoding, and some writers fill up with zeros.
    let json = String::from_utf8_lossy(json);
    let json = json.trim_start_matches('\u{feff}').trim_end_matches(|c: char| c == '\0' || c.is_whitespace());
    let mut root: Value = serde_json::from_str(json).map_err(|e| ReadError::Malformed {
        format: GLTF,
        problem: shortened(&format!("its JSON cannot be read: {e}")),
        at: Place::Line(e.line()),
    })?;
    // The first version kept its meshes by name.
    let old = if root["meshes"].is_object() { "1.0" } else { "2.0" };
    let version = match &root["asset"]["version"] {
        Value::String(version) => version.chars().take(10).collect(),
        Value::Number(version) => version.to_string(),
        _ => old.to_owned(),
    };
    if version.split('.').next() != Some("2") {
        let feature = format!("version {version} of glTF");
        return Err(ReadError::Unsupported { feature, cure: "save it as glTF 2.0" });
    }
    if let Some(extension) = names(&root, "extensionsRequired").find(|name| !is_supported(name)) {
        return Err(ReadError::UnsupportedExtension { extension });
    }
    let compression = names(&root, "extensionsUsed").find(|n| n.contains("draco"));
    let repairs = if pose == Pose::Rest { unseen(&root) } else { Vec::new() };
    let extension = |view: &mut Value| view.get_mut("extensions").map(Value::take).unwrap_or_default();
    let extensions: Vec<Value> = entries(&mut root, "bufferViews").map(extension).collect();
    reduce(&mut root, pose);
    let compressed = compressed::take(&mut root, &extensions, budget)?;
    drop(extensions);

    let problem = |problem: String, at: String| match &compression {
        Some(extension) => ReadError::UnsupportedExtension { extension: extension.clone() },
        None => ReadError::Malformed { format: GLTF, problem: shortened(&problem), at: Place::Object(at) },
    };
    let root =
        gltf::json::deserialize::from_value(root).map_err(|e| problem(e.to_string(), "the document".to_owned()))?;
    if let Some((path, error)) = first_fault(&root) {
        return Err(problem(error.to_string().to_lowercase(), path.to_string()));
    }
    let document = Document::from_json_without_validation(root);
    Ok(Geometry { document, compression, compressed, repairs })
}

/// Bytes that a document takes at most, as a tree of JSON, as the crate's document, or while its nodes are walked. An object has room for eleven entries at once,
/// and lists grow by doubling; texts, such as buffers in base64, are there twice.
fn weight(json: &[u8]) -> usize {
    let mark = |byte: &u8| match byte {
        b'{' => 650,
        b'[' => 160,
        b',' => 100,
        _ => 0,
    };
    json.iter().map(mark).fold(2 * json.len(), usize::saturating_add)
}

/// The crate's own checks, list by list. Not [`Document::from_json`]: its check of a primitive indexes the accessors with a
/// number nobody has checked, and demands bounds (`min`, `max`) that nothing here needs.
fn first_fault(root: &Root) -> Option<(Path, validation::Error)> {
    let mut fault = None;
    let mut note = |path: &dyn Fn() -> Path, error| {
        fault.get_or_insert_with(|| (path(), error));
    };
    let at = |list: &'static str| move || Path::new().field(list);
    root.accessors.validate(root, at("accessors"), &mut note);
    root.buffer_views.validate(root, at("bufferViews"), &mut note);
    root.buffers.validate(root, at("buffers"), &mut note);
    root.nodes.validate(root, at("nodes"), &mut note);
    root.scenes.validate(root, at("scenes"), &mut note);
    root.skins.validate(root, at("skins"), &mut note);
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let at = |field: &'static str| move || at("meshes")().index(m).field("primitives").index(p).field(field);
            primitive.attributes.validate(root, at("attributes"), &mut note);
            primitive.indices.validate(root, at("indices"), &mut note);
            primitive.mode.validate(root, at("mode"), &mut note);
            primitive.targets.validate(root, at("targets"), &mut note);
        }
    }
    fault
}

fn list<'a>(object: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> + use<'a> {
    object[key].as_array().into_iter().flatten()
}

fn names(root: &Value, key: &str) -> impl Iterator<Item = String> {
    list(root, key).filter_map(Value::as_str).map(|name| name.chars().take(80).collect())
}

fn is_supported(extension: &str) -> bool {
    extension == "KHR_mesh_quantization"
        || EXTENSIONS.contains(&extension)
        || HARMLESS.iter().any(|prefix| extension.starts_with(prefix))
}

/// Skins and morph targets move points in a viewer; in rest pose points stay as they are stored.
fn unseen(root: &Value) -> Vec<Repair> {
    let skins = list(root, "nodes").filter(|n| n.get("skin").is_some() && n.get("mesh").is_some()).count();
    let primitives = list(root, "meshes").flat_map(|mesh| list(mesh, "primitives"));
    let morphs = primitives.filter(|p| p.get("targets").is_some()).count();
    let skins = Repair::counted("skins-ignored", skins, || {
        format!("{} read in rest pose: the skeleton is not applied", counted(skins, "mesh", "meshes"))
    });
    let morphs = Repair::counted("morph-targets-ignored", morphs, || {
        format!("{} read without its morph targets", counted(morphs, "primitive", "primitives"))
    });
    skins.into_iter().chain(morphs).collect()
}

/// Leaves only what [`KEPT`] names, of primitives those with a POSITION, and of joints, weights and targets what the pose needs.
fn reduce(root: &mut Value, pose: Pose) {
    keep(root, &["asset", "accessors", "bufferViews", "buffers", "meshes", "nodes", "scenes", "skins"]);
    let skinned = pose == Pose::Saved && list(root, "nodes").any(|node| node.get("skin").is_some());
    for (list, keys) in KEPT {
        entries(root, list).for_each(|object| keep(object, keys));
    }
    if let Some(asset) = root.get_mut("asset") {
        keep(asset, &["version"]);
    }
    for mesh in entries(root, "meshes") {
        if let Some(primitives) = mesh.get_mut("primitives").and_then(Value::as_array_mut) {
            primitives.retain(|p| p["attributes"].get("POSITION").is_some());
        }
        for primitive in entries(mesh, "primitives") {
            let parts: &[&str] = match pose {
                Pose::Saved => &["attributes", "indices", "mode", "targets"],
                Pose::Rest => &["attributes", "indices", "mode"],
            };
            keep(primitive, parts);
            if let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) {
                let moves = |name: &str| name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
                attributes.retain(|name, _| name == "POSITION" || skinned && moves(name));
            }
            entries(primitive, "targets").for_each(|target| keep(target, &["POSITION"]));
        }
    }
    for scene in entries(root, "scenes").filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
}

fn entries<'a>(object: &'a mut Value, list: &str) -> impl Iterator<Item = &'a mut Value> {
    object.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten()
}

fn keep(value: &mut Value, keys: &[&str]) {
    if let Some(object) = value.as_object_mut() {
        object.retain(|key, _| keys.contains(&key.as_str()));
    }
}
