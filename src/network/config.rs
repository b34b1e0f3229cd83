//! The sizes of a network.

use serde::{Deserialize, Serialize};

/// Everything that decides which tensors a network has and what is done with them. Travels in the header of a weights file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelConfig {
    /// Channels between blocks.
    pub width: usize,
    /// DiffusionNet blocks.
    pub blocks: usize,
    /// Eigenpairs that diffusion runs on.
    pub eigenpairs: usize,
    /// Moments per block; 0 leaves them out, as the paper does, and with them all that tells left from right.
    pub moments: usize,
    /// Features per point.
    pub features: usize,
    /// How positions enter.
    pub position: Position,
    /// Width of the part-aware attention; 0 leaves it out.
    pub attention: usize,
}

/// What the position encoding ψ (paper Sec. 3.3) acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Position {
    /// The distance from the centre, and through moments inner and triple products: the same in every orientation.
    Invariant,
    /// x, y and z, as printed: needs bodies that stand alike.
    Literal,
}

impl ModelConfig {
    /// The network that ships.
    pub fn shipped() -> Self {
        Self {
            width: 96,
            blocks: 4,
            eigenpairs: 64,
            moments: 16,
            features: 128,
            position: Position::Invariant,
            attention: 64,
        }
    }

    /// The paper's: d = 256, k = 120, literal positions, nothing that sees chirality but those.
    pub fn paper() -> Self {
        Self {
            width: 256,
            blocks: 4,
            eigenpairs: 120,
            moments: 0,
            features: 256,
            position: Position::Literal,
            attention: 256,
        }
    }
}
