//! Whether shapes are measured as meshes or as clouds.

use serde::{Deserialize, Serialize};

use crate::pipeline::FaceUse;

/// What faces are used for. Errors are measured on meshes all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Both shapes are meshes.
    Mesh,
    /// Both lose their faces before anything else.
    Cloud,
    /// B loses its faces.
    MeshCloud,
}

impl Mode {
    /// Whether A and B keep their faces.
    pub(super) fn faces(self) -> [FaceUse; 2] {
        match self {
            Mode::Mesh => [FaceUse::Use, FaceUse::Use],
            Mode::Cloud => [FaceUse::Ignore, FaceUse::Ignore],
            Mode::MeshCloud => [FaceUse::Use, FaceUse::Ignore],
        }
    }
}
