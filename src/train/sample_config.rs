//! What decides how a body or a scan becomes a sample.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::bodies::parts::people;
use crate::network::{Category, InputConfig, ModelConfig, WeightsId};
use crate::operators::LaplacianKind;

/// What decides how the body of a seed becomes a sample. A folder of samples remembers it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleConfig {
    /// The kind of body.
    pub category: Category,
    /// Points of a scan.
    pub points: usize,
    /// Share of them that a generated scan may have more or less.
    #[serde(default = "quarter")]
    pub spread: f64,
    /// What the network asks for.
    #[serde(flatten)]
    pub input: InputConfig,
    /// How generated bodies stand.
    #[serde(default)]
    pub stand: Stand,
    /// Share of pieces among generated scans.
    #[serde(default)]
    pub pieces: f64,
    /// Share of bodies with the proportions of drawn characters.
    #[serde(default, skip_serializing_if = "is_none")]
    pub stylised: f64,
    /// How many scans, one after the other, are of one generated body: making it and placing its points takes longer than scanning it.
    #[serde(default = "one")]
    pub scans_of_body: usize,
    /// The operator of every cloud; by default that of matching on most, others on some.
    pub laplacian: Option<LaplacianKind>,
    /// The weights that place points on the atlas, if any do.
    #[serde(default)]
    pub teacher: Option<WeightsId>,
    /// The scans that samples are of, where the generator makes none.
    #[serde(default)]
    pub scans: Option<Scans>,
}

fn is_none(share: &f64) -> bool {
    *share == 0.0
}

fn quarter() -> f64 {
    0.25
}

fn one() -> usize {
    1
}

/// How generated bodies stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stand {
    /// Each turned any way, and every second one mirrored: for networks that see no coordinates.
    #[default]
    Random,
    /// Upright on y = 0, facing +z, unmirrored: what a network that sees coordinates takes for granted.
    Alike,
}

/// Scans of a folder by name, in order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scans {
    /// The folder.
    pub folder: PathBuf,
    /// Those trained on.
    pub names: Vec<String>,
}

impl SampleConfig {
    /// For a network, with the operators and the mixture of scans of the weights that ship, and no teacher.
    pub fn of(network: &ModelConfig, points: usize) -> Self {
        Self {
            category: people(),
            points,
            spread: quarter(),
            input: network.input(),
            stand: Stand::Random,
            pieces: 0.6,
            stylised: 0.2,
            scans_of_body: 8,
            laplacian: None,
            teacher: None,
            scans: None,
        }
    }

    /// The paper's, for its network or one that differs in something: N = 5000 (Sec. 4.1), whole bodies that stand alike, on clouds Algorithm 1 as printed.
    pub fn paper(network: &ModelConfig) -> Self {
        let laplacian = Some(LaplacianKind::GeodesicLiteral);
        Self {
            spread: 0.0,
            stand: Stand::Alike,
            laplacian,
            pieces: 0.0,
            stylised: 0.0,
            scans_of_body: one(),
            ..Self::of(network, 5000)
        }
    }
}
