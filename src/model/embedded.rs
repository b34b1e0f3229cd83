//! Weights ready for use on the CPU, and those that ship.

use std::sync::OnceLock;

use ndarray::Array2;

use super::{Network, Weights, WeightsError};
use crate::device::{Cpu, Device};
use crate::features::ShapeInputs;

/// A network's weights with the network built from them.
#[derive(Debug)]
pub struct Model {
    weights: Weights,
    network: Network<Array2<f32>>,
}

/// What the network says about the points of a shape by itself; p points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointEmbedding {
    /// Features (p, f) before they are compared with another shape's.
    pub features: Array2<f32>,
    /// Probability of each of [`crate::PARTS`] (p, 14).
    pub parts: Array2<f32>,
}

impl Model {
    /// Checks that the weights fit the network that they say they are of.
    pub fn new(weights: Weights) -> Result<Self, WeightsError> {
        let network = Network::new(&weights.config, &mut weights.on(&Cpu))?;
        Ok(Self { weights, network })
    }

    /// Those that ship; see the model card beside them.
    pub fn embedded() -> &'static Self {
        static EMBEDDED: OnceLock<Model> = OnceLock::new();
        EMBEDDED.get_or_init(|| {
            let weights = Weights::from_bytes(include_bytes!("geose.safetensors"));
            weights.and_then(Self::new).expect("the weights that ship fit the network that ships")
        })
    }

    /// Name, configuration and tensors.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// The forward pass for one shape.
    pub fn embed(&self, inputs: &ShapeInputs) -> PointEmbedding {
        let embedding = self.network.embed(&Cpu, &inputs.upload(&Cpu));
        PointEmbedding { features: embedding.features, parts: Cpu.softmax_rows(&embedding.logits) }
    }
}
