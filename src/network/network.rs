//! The forward pass, written once for matching and for training.

use super::attention::PartAttention;
use super::diffusion_net::DiffusionBlock;
use super::inputs::{InputsOn, input_channels};
use super::layers::{LayerNorm, Linear};
use super::{ModelConfig, Source, WeightsError};
use crate::device::Device;

/// A network whose parameters are on a device.
#[derive(Clone, Debug)]
pub struct Network<T> {
    /// Its sizes.
    pub config: ModelConfig,
    input: Linear<T>,
    blocks: Vec<DiffusionBlock<T>>,
    norm: LayerNorm<T>,
    features: Linear<T>,
    parts: Linear<T>,
    attention: Option<PartAttention<T>>,
}

/// What the network says about the points of one shape by itself.
#[derive(Clone, Debug)]
pub struct Embedding<T> {
    /// Features (n, f), before attention and not normalised.
    pub features: T,
    /// Logits of the parts (n, c).
    pub logits: T,
}

impl<T> Network<T> {
    /// Takes its parameters from `source`; tells so many `parts` apart.
    pub fn new(config: &ModelConfig, parts: usize, source: &mut impl Source<T>) -> Result<Self, WeightsError> {
        let width = config.width;
        Ok(Self {
            config: config.clone(),
            input: Linear::new(source, "input", input_channels(config.position), width, 1.0)?,
            blocks: (0..config.blocks)
                .map(|i| DiffusionBlock::new(source, &format!("block{i}"), width, config.moments))
                .collect::<Result<_, _>>()?,
            norm: LayerNorm::new(source, "norm", width)?,
            features: Linear::new(source, "features", width, config.features, 1.0)?,
            parts: Linear::new(source, "parts", width, parts, 1.0)?,
            attention: (config.attention > 0)
                .then(|| PartAttention::new(source, "attention", config.features, config.attention))
                .transpose()?,
        })
    }

    /// Features and parts of one shape.
    pub fn embed<D: Device<Tensor = T>>(&self, device: &D, shape: &InputsOn<T>) -> Embedding<T> {
        let mut x = self.input.forward(device, &shape.channels);
        for block in &self.blocks {
            x = block.forward(device, &x, shape);
        }
        let x = self.norm.forward(device, &x);
        Embedding { features: self.features.forward(device, &x), logits: self.parts.forward(device, &x) }
    }

    /// Features of a shape's points (n, f), of unit length, after they looked at the key points of the other shape; both with probabilities of parts.
    pub fn compare<D: Device<Tensor = T>>(&self, device: &D, own: (&T, &T), keys: (&T, &T)) -> T {
        match &self.attention {
            Some(attention) => device.normalize_rows(&attention.forward(device, own, keys)),
            None => device.normalize_rows(own.0),
        }
    }
}
