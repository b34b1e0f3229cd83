//! The forward pass, written once for matching and for training.

use ndarray::Array2;

use super::attention::PartAttention;
use super::batch_norm::{Points, Statistics};
use super::config::input_channels;
use super::diffusion_net::{DiffusionBlock, Going};
use super::inputs::InputsOn;
use super::layers::{LayerNorm, Linear};
use super::{ModelConfig, Norm, Source, WeightsError};
use crate::device::Device;

/// A network whose parameters are on a device.
#[derive(Clone, Debug)]
pub struct Network<T> {
    /// Its sizes.
    pub config: ModelConfig,
    input: Linear<T>,
    blocks: Vec<DiffusionBlock<T>>,
    /// Of what the blocks give; none where channels are normalised within them.
    norm: Option<LayerNorm<T>>,
    features: Linear<T>,
    parts: Linear<T>,
    extent: Option<ExtentHead<T>>,
    attention: Vec<PartAttention<T>>,
}

/// What the network says about the points of one shape by itself.
#[derive(Clone, Debug)]
pub struct Embedding<T> {
    /// Features (n, [`ModelConfig::feature_columns`]), before attention and not normalised.
    pub features: T,
    /// Logits of the parts (n, c).
    pub logits: T,
    /// √area of the shape over that of the whole body that it is of, in units of what its inputs say: the logarithm (1, 1). None from networks that do not tell.
    pub extent: Option<T>,
}

impl<T> Network<T> {
    /// Takes its parameters from `source`; tells so many `parts` apart.
    pub fn new(config: &ModelConfig, parts: usize, source: &mut impl Source<T>) -> Result<Self, WeightsError> {
        let width = config.width;
        let layers = if config.attention > 0 { config.attention_layers } else { 0 };
        Ok(Self {
            config: config.clone(),
            input: Linear::new(source, "input", input_channels(&config.input()), width, 1.0)?,
            blocks: (0..config.blocks)
                .map(|i| DiffusionBlock::new(source, &format!("block{i}"), config))
                .collect::<Result<_, _>>()?,
            norm: (config.norm == Norm::Layer).then(|| LayerNorm::new(source, "norm", width)).transpose()?,
            features: Linear::new(source, "features", width, config.features, 1.0)?,
            parts: Linear::new(source, "parts", width, parts, 1.0)?,
            extent: config.extent.then(|| ExtentHead::new(source, width, parts)).transpose()?,
            attention: (0..layers)
                .map(|i| {
                    let name = if i == 0 { "attention".to_owned() } else { format!("attention{i}") };
                    PartAttention::new(source, &name, config.feature_columns(), config.attention, config.mask)
                })
                .collect::<Result<_, _>>()?,
        })
    }

    /// Features and parts of one shape, as in matching.
    pub fn embed<D: Device<Tensor = T>>(&self, device: &D, shape: &InputsOn<T>) -> Embedding<T> {
        self.embed_each(device, &[shape], &mut Going::ByWeights).pop().expect("one shape, one embedding")
    }

    /// Features and parts of the shapes of a step of training. Batch normalisation goes by the statistics of all their points, which are returned; without it
    /// there are none, and each shape is embedded as by itself.
    pub fn embed_together<D: Device<Tensor = T>>(
        &self,
        device: &D,
        shapes: &[&InputsOn<T>],
    ) -> (Vec<Embedding<T>>, Vec<Statistics<T>>) {
        let points = Points::of(device, shapes.iter().map(|shape| shape.count));
        let mut going = Going::ByPoints(&points, Vec::new());
        let embeddings = self.embed_each(device, shapes, &mut going);
        let Going::ByPoints(_, statistics) = going else { unreachable!("it stays what it was") };
        (embeddings, statistics)
    }

    fn embed_each<D: Device<Tensor = T>>(
        &self,
        device: &D,
        shapes: &[&InputsOn<T>],
        going: &mut Going<'_, T>,
    ) -> Vec<Embedding<T>> {
        let mut x: Vec<T> = shapes.iter().map(|shape| self.input.forward(device, &shape.channels)).collect();
        for block in &self.blocks {
            x = block.forward(device, x, shapes, going);
        }
        let heads = |(x, shape): (T, &&InputsOn<T>)| {
            let x = match &self.norm {
                Some(norm) => norm.forward(device, &x),
                None => x,
            };
            let features = self.features.forward(device, &x);
            let features = match &shape.encoded {
                Some(encoded) => device.concat(&[(&features, 1.0), (encoded, 1.0)]),
                None => features,
            };
            let logits = self.parts.forward(device, &x);
            let extent = self.extent.as_ref().map(|head| head.forward(device, &x, &logits, shape.count));
            Embedding { features, logits, extent }
        };
        x.into_iter().zip(shapes).map(heads).collect()
    }

    /// Features of two shapes' points (n, f) after they looked at each other's key points, of unit length. Each side is features, probabilities of parts (n, c),
    /// and which of its points are keys. Attention is added to what it looks with, layer after layer, and keys are what the layer before made of them.
    pub fn compare<D: Device<Tensor = T>>(&self, device: &D, sides: [(&T, &T, &D::Indices); 2]) -> [T; 2] {
        let key_parts = match self.attention.is_empty() {
            true => None,
            false => Some(sides.map(|(_, parts, keys)| device.gather(parts, keys))),
        };
        let mut seen: Option<[T; 2]> = None;
        for (layer, key_parts) in self.attention.iter().zip(key_parts.iter().cycle()) {
            let now = [0, 1].map(|side: usize| seen.as_ref().map_or(sides[side].0, |seen| &seen[side]));
            let keys = [0, 1].map(|side: usize| device.gather(now[side], sides[side].2));
            seen = Some([0, 1].map(|side: usize| {
                let other = (&keys[1 - side], &key_parts[1 - side]);
                layer.forward(device, (now[side], sides[side].1), other)
            }));
        }
        [0, 1].map(|side: usize| device.normalize_rows(seen.as_ref().map_or(sides[side].0, |seen| &seen[side])))
    }
}

/// Says how much of a body there is by the mean over its points of what they are and of their parts: how large the parts are that are there tells much of it.
#[derive(Clone, Debug)]
struct ExtentHead<T> {
    of_points: Linear<T>,
    of_shape: Linear<T>,
}

/// Its width.
const EXTENT: usize = 32;

impl<T> ExtentHead<T> {
    fn new(source: &mut impl Source<T>, width: usize, parts: usize) -> Result<Self, WeightsError> {
        Ok(Self {
            of_points: Linear::new(source, "extent.points", width + parts, EXTENT, 1.0)?,
            of_shape: Linear::new(source, "extent.shape", EXTENT, 1, 0.1)?,
        })
    }

    /// From channels (n, width) and logits of parts (n, c).
    fn forward<D: Device<Tensor = T>>(&self, device: &D, x: &T, logits: &T, n: usize) -> T {
        let points = device.concat(&[(x, 1.0), (&device.softmax_rows(logits), 1.0)]);
        let points = device.relu(&self.of_points.forward(device, &points));
        let mean = device.upload(Array2::from_elem((1, n), 1.0 / n as f32).view());
        self.of_shape.forward(device, &device.matmul(&mean, &points))
    }
}
