//! The sizes of a network.

use serde::{Deserialize, Serialize};

use crate::device::Mask;

/// Wavelengths of the position encoding (paper Sec. 3.3, ψ), in √area.
pub(super) const WAVELENGTHS: [f32; 3] = [4.0, 2.0, 1.0];
/// Number of times of the heat kernel signature.
pub(super) const SIGNATURES: usize = 8;

/// Everything that decides which tensors a network has and what is done with them. Travels in the header of a weights file, where what is left out is as in the
/// network that ships.
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
    /// Features per point that the DiffusionNet gives, the paper's d.
    pub features: usize,
    /// What the position encoding acts on.
    pub position: Position,
    /// Where the position encoding joins.
    #[serde(default)]
    pub encoding: Encoding,
    /// What is normalised.
    #[serde(default)]
    pub norm: Norm,
    /// Width of the part-aware attention; 0 leaves it out.
    pub attention: usize,
    /// Layers of attention, each added to what it was given.
    #[serde(default = "one_layer")]
    pub attention_layers: usize,
    /// How attention keeps to parts.
    #[serde(default)]
    pub mask: Mask,
    /// How functional maps are solved for.
    #[serde(default)]
    pub solve: Solver,
    /// Eigenfunctions k of the functional maps, in training and of the first maps in matching.
    #[serde(default = "shipped_map")]
    pub map: usize,
    /// Whether it says how much of a body there is; see [`Embedding::extent`](super::Embedding::extent).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub extent: bool,
}

fn one_layer() -> usize {
    1
}

fn shipped_map() -> usize {
    60
}

/// What of a shape a network is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputConfig {
    /// See [`ModelConfig::eigenpairs`].
    pub eigenpairs: usize,
    /// See [`ModelConfig::position`].
    pub position: Position,
    /// See [`ModelConfig::encoding`].
    #[serde(default)]
    pub encoding: Encoding,
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

/// Where the position encoding ψ joins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// It is among the channels that the DiffusionNet sees.
    #[default]
    Input,
    /// It is concatenated with the DiffusionNet's features F before attention, H = F‖ψ(P) (paper Sec. 3.3), and the DiffusionNet sees the heat kernel
    /// signature alone. Read so that d is the width of F, as printed: attention, and what is projected on the bases after it, has d + d' columns.
    Features,
}

/// What is normalised in the DiffusionNet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Norm {
    /// Each point over its channels, before every block.
    #[default]
    Layer,
    /// Each channel over the points, after every diffusion (paper Sec. 3.3), and nothing else: in training by the points of the step, in matching by the
    /// running mean and variance that come with the weights.
    Batch,
}

/// How a functional map is solved for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Least squares with a penalty away from the slanted diagonal; see [`crate::maps::FunctionalMap::solve`].
    #[default]
    Masked,
    /// Least squares, as printed (paper Sec. 3.3).
    LeastSquares,
}

impl ModelConfig {
    /// What training makes unless told otherwise, and what the weights for people are. It has no attention, which was worth nothing that shows, with predicted or with given parts
    /// (`benches/results/ablations.md`).
    pub fn shipped() -> Self {
        Self {
            width: 96,
            blocks: 4,
            eigenpairs: 64,
            moments: 16,
            features: 128,
            position: Position::Invariant,
            encoding: Encoding::Input,
            norm: Norm::Layer,
            attention: 0,
            attention_layers: one_layer(),
            mask: Mask::Soft,
            solve: Solver::Masked,
            map: shipped_map(),
            extent: true,
        }
    }

    /// The paper's (Sec. 3.3 and 4.1): d = 256, k = 120, batch normalisation after each diffusion, literal positions that join before attention, attention kept
    /// to parts by −∞, maps by least squares, nothing that sees chirality but the positions.
    ///
    /// Not said in the paper and chosen here: 4 blocks of width 256, as DiffusionNet has them; sinusoidal ψ with d' = 18; two attention layers ("multiple")
    /// of width 256, before each of which points are normalised over their channels. A departure: attention looks at a sampling of the other shape (1024 points in matching, 512 in training) and not at all
    /// of its points, whose scores training would have to hold.
    pub fn paper() -> Self {
        Self {
            width: 256,
            blocks: 4,
            eigenpairs: 120,
            moments: 0,
            features: 256,
            position: Position::Literal,
            encoding: Encoding::Features,
            norm: Norm::Batch,
            attention: 256,
            attention_layers: 2,
            mask: Mask::Hard,
            solve: Solver::LeastSquares,
            map: 120,
            extent: false,
        }
    }

    /// Whether the numbers can be meant.
    pub(crate) fn check(&self) -> Result<(), String> {
        let ranges = [
            ("width", self.width, 1..=4096),
            ("blocks", self.blocks, 0..=64),
            ("eigenpairs", self.eigenpairs, 1..=1000),
            ("moments", self.moments, 0..=256),
            ("features", self.features, 1..=4096),
            ("attention", self.attention, 0..=4096),
            ("attention_layers", self.attention_layers, 0..=64),
            ("map", self.map, 1..=1000),
        ];
        match ranges.iter().find(|(_, value, range)| !range.contains(value)) {
            Some((name, value, range)) => Err(format!("{name} is {value}, and must be {range:?}")),
            None => Ok(()),
        }
    }

    /// What of a shape it is given.
    pub fn input(&self) -> InputConfig {
        InputConfig { eigenpairs: self.eigenpairs, position: self.position, encoding: self.encoding }
    }

    /// Columns of the features that attention sees and that are projected on the bases: those of the DiffusionNet, and ψ where it joins there.
    pub fn feature_columns(&self) -> usize {
        match self.encoding {
            Encoding::Input => self.features,
            Encoding::Features => self.features + encoded_channels(self.position),
        }
    }
}

/// Columns d' of ψ: sine and cosine of each wavelength.
pub(super) fn encoded_channels(position: Position) -> usize {
    let numbers = match position {
        Position::Invariant => 1,
        Position::Literal => 3,
    };
    2 * WAVELENGTHS.len() * numbers
}

/// Channels that the DiffusionNet sees: where ψ joins after it, none that depends on where the points are.
pub(super) fn input_channels(config: &InputConfig) -> usize {
    match config.encoding {
        Encoding::Input => SIGNATURES + 2 + encoded_channels(config.position),
        Encoding::Features => SIGNATURES,
    }
}

#[cfg(test)]
mod tests {
    use super::ModelConfig;

    #[test]
    fn a_header_from_before_the_paper_could_be_chosen_is_read_as_it_was() {
        let header = r#"{"width":96,"blocks":4,"eigenpairs":64,"moments":16,"features":128,"position":"invariant","attention":64}"#;
        let then = ModelConfig { attention: 64, extent: false, ..ModelConfig::shipped() };
        assert_eq!(serde_json::from_str::<ModelConfig>(header).expect("a header"), then);
        let paper = serde_json::to_string(&ModelConfig::paper()).expect("JSON");
        assert_eq!(serde_json::from_str::<ModelConfig>(&paper).expect("a header"), ModelConfig::paper());
    }
}
