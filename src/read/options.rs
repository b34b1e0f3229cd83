//! What a reader may be told beside the bytes.

use serde::Deserialize;

use super::format::Format;

/// How a scan is to be read.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions<'a> {
    /// The file's name: its ending helps to find the format.
    pub name: Option<&'a str>,
    /// Instead of finding it out from the bytes and the name.
    pub format: Option<Format>,
    /// Which pose of a body with a skeleton or morph targets.
    pub pose: Pose,
    /// Other files that this one names, such as the `.bin` beside a `.gltf`: name and bytes.
    pub companions: &'a [(&'a str, &'a [u8])],
}

/// Which pose of a body with a skeleton or morph targets is read; only glTF has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pose {
    /// As the file stands: joints where its nodes have them, morph targets at its weights.
    #[default]
    Saved,
    /// As its points are stored: no joint and no morph target is applied.
    Rest,
}
