//! Weights on a device, ready for use, and those that ship.

use std::sync::{Arc, OnceLock};

use ndarray::{Array2, s};

use super::{Category, Network, ShapeInputs, Weights, WeightsError, WeightsId};
use crate::device::{Cpu, Device};

/// Name of the tensor (f + 1, 2) that makes [`TrainedNetwork::prior`] from features and, in its last row, a constant. It is fitted beside the constants of
/// confidence (`src/evaluate/refit.rs`), not trained, and is good for the features of one training only: therefore it travels with the weights.
pub(crate) const PRIOR: &str = "prior";

/// One network or several, each for a category of bodies, on the device that they run on.
#[derive(Debug)]
pub struct Model<D: Device = Cpu> {
    device: D,
    networks: Vec<TrainedNetwork<D::Tensor>>,
}

/// A network with the weights that it was built from.
#[derive(Debug)]
pub struct TrainedNetwork<T> {
    weights: Arc<Weights>,
    id: WeightsId,
    category: Arc<Category>,
    network: Network<T>,
}

/// What a network says about the points of a shape by itself; p points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointEmbedding {
    /// The weights that say so.
    pub weights: WeightsId,
    /// The category they know.
    pub category: Arc<Category>,
    /// Features (p, f) before they are compared with another shape's.
    pub features: Array2<f32>,
    /// Probability of each part of the category (p, c).
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
        Self::on([Arc::new(weights)], Cpu)
    }

    /// Those that ship; see the model card beside them.
    pub fn embedded() -> &'static Arc<Self> {
        static EMBEDDED: OnceLock<Arc<Model>> = OnceLock::new();
        EMBEDDED.get_or_init(|| {
            let weights = Weights::from_bytes(include_bytes!("../../data/weights/people.safetensors"));
            Arc::new(weights.and_then(Self::new).expect("the weights that ship fit the network that ships"))
        })
    }
}

impl<D: Device> Model<D> {
    /// Copies weights to `device`, once; checks that each fit the network that they say they are of. At least one is needed.
    pub fn on(weights: impl IntoIterator<Item = Arc<Weights>>, device: D) -> Result<Self, WeightsError> {
        let build = |weights: Arc<Weights>| -> Result<_, WeightsError> {
            weights.config.check().and_then(|()| weights.category.check()).map_err(WeightsError)?;
            let category = Arc::new(weights.category.clone());
            let network = Network::new(&weights.config, category.parts.len(), &mut weights.on(&device))?;
            Ok(TrainedNetwork { id: weights.id(), weights, category, network })
        };
        let networks: Vec<_> = weights.into_iter().map(build).collect::<Result<_, _>>()?;
        if networks.is_empty() {
            return Err(WeightsError("there are none".to_owned()));
        }
        Ok(Self { device, networks })
    }

    /// The networks, in the order that their weights were given in.
    pub fn networks(&self) -> &[TrainedNetwork<D::Tensor>] {
        &self.networks
    }

    /// The weights of all networks.
    pub fn weights(&self) -> impl Iterator<Item = &Arc<Weights>> {
        self.networks.iter().map(|network| &network.weights)
    }

    /// Where the networks are, and everything dense runs.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// The same on the CPU, for when the device has failed.
    pub(crate) fn on_cpu(&self) -> Model {
        Model::on(self.weights().cloned(), Cpu).expect("weights that fitted on one device fit on another")
    }
}

impl<T> TrainedNetwork<T> {
    /// Name, configuration and tensors.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Which weights these are.
    pub fn id(&self) -> &WeightsId {
        &self.id
    }

    /// What it knows.
    pub fn category(&self) -> &Arc<Category> {
        &self.category
    }

    /// The forward pass.
    pub fn network(&self) -> &Network<T> {
        &self.network
    }

    /// Whether an embedding is of these weights, and as wide as what they give.
    pub(crate) fn made(&self, embedding: &PointEmbedding) -> bool {
        embedding.weights == self.id
            && embedding.features.ncols() == self.weights.config.feature_columns()
            && embedding.parts.ncols() == self.category.parts.len()
    }

    /// How far the place of each point on the body speaks for its match (p, 2), in log-odds beside other cues: between meshes, and where one is a cloud.
    /// Nothing where the weights bring no such constants, or the embedding is of others.
    pub(crate) fn prior(&self, embedding: &PointEmbedding) -> Option<Array2<f32>> {
        let prior = self.weights.tensor(PRIOR)?;
        let (last, f) = (prior.nrows().checked_sub(1)?, embedding.features.ncols());
        (embedding.weights == self.id && last == f && prior.ncols() == 2)
            .then(|| embedding.features.dot(&prior.slice(s![..last, ..])) + prior.slice(s![last.., ..]))
    }

    /// The forward pass for one shape; and √area of the shape over that of the whole body, from networks that say how much of a body there is.
    pub async fn embed<D: Device<Tensor = T>>(
        &self,
        device: &D,
        inputs: &ShapeInputs,
    ) -> (PointEmbedding, Option<f32>) {
        let embedding = self.network.embed(device, &inputs.upload(device));
        let parts = device.softmax_rows(&embedding.logits);
        let extent = match &embedding.extent {
            Some(extent) => Some(inputs.extent * device.download(extent).await[(0, 0)].exp()),
            None => None,
        };
        let of_points = PointEmbedding {
            weights: self.id.clone(),
            category: self.category.clone(),
            features: device.download(&embedding.features).await,
            parts: device.download(&parts).await,
        };
        (of_points, extent)
    }
}

impl PointEmbedding {
    /// Mean probability of the likeliest part, points weighing as `mass` (p) does.
    pub fn certainty(&self, mass: impl IntoIterator<Item = f64>) -> f64 {
        let likeliest = self.parts.rows().into_iter().map(|row| f64::from(row.iter().copied().fold(0.0, f32::max)));
        likeliest.zip(mass).map(|(likeliest, mass)| likeliest * mass).sum()
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::{Model, PointEmbedding};

    #[test]
    fn the_weights_that_ship_have_a_prior_of_places_and_only_for_their_own_features() {
        let network = &Model::embedded().networks()[0];
        let of = |f: usize, value: f32| {
            let (weights, category) = (network.id().clone(), network.category().clone());
            let features = Array2::from_elem((3, f), value);
            PointEmbedding { weights, category, features, parts: Array2::zeros((3, 14)) }
        };
        let f = network.weights().config.features;
        let prior = |value: f32| network.prior(&of(f, value)).expect("a prior");
        let (none, some) = (prior(0.0), prior(1.0));
        assert_eq!(none.dim(), (3, 2));
        assert!(none.iter().zip(&some).all(|(none, some)| none.is_finite() && none != some), "{none} {some}");
        assert_eq!(network.prior(&of(f - 1, 0.0)), None);
        let mut others = of(f, 0.0);
        others.weights.fingerprint = "0".to_owned();
        assert_eq!(network.prior(&others), None, "embedded by other weights");
    }
}
