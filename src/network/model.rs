//! Weights on a device, ready for use, and those that ship.

use std::sync::OnceLock;

use ndarray::{Array2, s};

use super::{Network, ShapeInputs, Weights, WeightsError};
use crate::device::{Cpu, Device};

/// Name of the tensor (f + 1, 2) that makes [`Model::prior`] from features and, in its last row, a constant. It is fitted beside the constants of
/// confidence (`src/evaluate/refit.rs`), not trained, and is good for the features of one training only: therefore it travels with the weights.
pub(crate) const PRIOR: &str = "trust";

/// A network's weights with the network built from them, on the device that it runs on.
#[derive(Debug)]
pub struct Model<D: Device = Cpu> {
    weights: Weights,
    device: D,
    network: Network<D::Tensor>,
}

/// What the network says about the points of a shape by itself; p points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointEmbedding {
    /// Features (p, f) before they are compared with another shape's.
    pub features: Array2<f32>,
    /// Probability of each of [`crate::PARTS`] (p, 14).
    pub parts: Array2<f32>,
}

impl PointEmbedding {
    /// Whether all of it are numbers: those of other weights may grow beyond what f32 holds.
    pub(crate) fn is_finite(&self) -> bool {
        self.features.iter().chain(&self.parts).all(|v| v.is_finite())
    }
}

impl Model {
    /// On the CPU; checks that the weights fit the network that they say they are of.
    pub fn new(weights: Weights) -> Result<Self, WeightsError> {
        Self::on(weights, Cpu)
    }

    /// Those that ship; see the model card beside them.
    pub fn embedded() -> &'static Self {
        static EMBEDDED: OnceLock<Model> = OnceLock::new();
        EMBEDDED.get_or_init(|| {
            let weights = Weights::from_bytes(include_bytes!("../../data/weights/people.safetensors"));
            weights.and_then(Self::new).expect("the weights that ship fit the network that ships")
        })
    }
}

impl<D: Device> Model<D> {
    /// Copies the weights to `device`, once; checks that they fit the network that they say they are of.
    pub fn on(weights: Weights, device: D) -> Result<Self, WeightsError> {
        let network = Network::new(&weights.config, &mut weights.on(&device))?;
        Ok(Self { weights, device, network })
    }

    /// Name, configuration and tensors.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Where the network is, and everything dense runs.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// The network on the device.
    pub fn network(&self) -> &Network<D::Tensor> {
        &self.network
    }

    /// The same on the CPU, for when the device has failed.
    pub(crate) fn on_cpu(&self) -> Model {
        Model::new(self.weights.clone()).expect("weights that fitted on one device fit on another")
    }

    /// How far the place of each point on the body speaks for its match (p, 2), as [`Matchable::prior`](crate::maps::Matchable::prior) has it; nothing where the weights
    /// bring no such constants or are of other features.
    pub(crate) fn prior(&self, embedding: &PointEmbedding) -> Option<Array2<f32>> {
        let prior = self.weights.tensor(PRIOR)?;
        let (last, f) = (prior.nrows().checked_sub(1)?, embedding.features.ncols());
        (last == f && prior.ncols() == 2)
            .then(|| embedding.features.dot(&prior.slice(s![..last, ..])) + prior.slice(s![last.., ..]))
    }

    /// The forward pass for one shape.
    pub async fn embed(&self, inputs: &ShapeInputs) -> PointEmbedding {
        let device = &self.device;
        let embedding = self.network.embed(device, &inputs.upload(device));
        let parts = device.softmax_rows(&embedding.logits);
        PointEmbedding { features: device.download(&embedding.features).await, parts: device.download(&parts).await }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::{Model, PointEmbedding};

    #[test]
    fn the_weights_that_ship_say_how_far_a_place_is_to_be_trusted_and_only_by_their_own_features() {
        let of = |f: usize, value: f32| {
            let features = Array2::from_elem((3, f), value);
            Model::embedded().prior(&PointEmbedding { features, parts: Array2::zeros((3, 14)) })
        };
        let f = Model::embedded().weights().config.features;
        let (none, some) = (of(f, 0.0).expect("a prior"), of(f, 1.0).expect("a prior"));
        assert_eq!(none.dim(), (3, 2));
        assert!(none.iter().zip(&some).all(|(none, some)| none.is_finite() && none != some), "{none} {some}");
        assert_eq!(of(f - 1, 0.0), None);
    }
}
