//! The losses of a step: the forward pass of matching on the shapes of all its pairs, then of each pair every loss that counts.

use candle_core::Tensor;
use ndarray::{Array2, s};
use rand::seq::index::sample as sample_rows;
use rand_chacha::ChaCha8Rng;

use super::device::{Autodiff, matrix, tensor};
use super::losses::{LossWeights, Side, Terms, functional_maps, losses, one_hot};
use super::sample::Sample;
use crate::device::{Cpu, Device, Mask};
use crate::network::{Embedding, Network, Solver, Statistics};

/// Key points that attention looks at in training.
const KEYS: usize = 512;
/// With this share of the area a body is whole.
const WHOLE: f32 = 0.75;

/// What the network makes of each of the shapes of a step by themselves, and what batch normalisation found over all their points.
pub fn embed_together(
    network: &Network<Tensor>,
    samples: &[&Sample],
) -> (Vec<Embedding<Tensor>>, Vec<Statistics<Tensor>>) {
    let on: Vec<_> = samples.iter().map(|sample| sample.inputs.upload(&Autodiff)).collect();
    network.embed_together(&Autodiff, &on.iter().collect::<Vec<_>>())
}

/// What the network makes of a shape by itself as in matching, where batch normalisation goes by what training saw.
pub fn embed(network: &Network<Tensor>, sample: &Sample) -> Embedding<Tensor> {
    network.embed(&Autodiff, &sample.inputs.upload(&Autodiff))
}

/// Both shapes of a pair after the forward pass.
pub struct Forward {
    features: [Tensor; 2],
    logits: [Tensor; 2],
    labels: [Tensor; 2],
    phi: [Tensor; 2],
    projector: [Tensor; 2],
    lambda: [Vec<f64>; 2],
    places: [Option<Array2<f32>>; 2],
    /// Whether both are whole bodies: between a piece and a whole no functional map is an isometry.
    whole: bool,
    /// What the network says of the extent of each, and what is right, as logarithms.
    extents: [Option<(Tensor, f64)>; 2],
    solve: Solver,
}

impl Forward {
    /// Of two shapes and what the network made of each.
    pub fn new(
        network: &Network<Tensor>,
        losses: &LossWeights,
        pair: [&Sample; 2],
        [a, b]: [&Embedding<Tensor>; 2],
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let device = Autodiff;
        let labels = pair.map(|sample| tensor(one_hot(&sample.labels, a.logits.dims()[1]).view()));
        let given = network.config.mask == Mask::Hard || losses.parts == 0.0;
        let masks = [mask(given, &a.logits, &labels[0]), mask(given, &b.logits, &labels[1])];
        let keys = pair.map(|sample| {
            let n = sample.inputs.len();
            sample_rows(rng, n, KEYS.min(n)).into_iter().map(|i| i as u32).collect::<Vec<u32>>()
        });
        let features =
            network.compare(&device, [(&a.features, &masks[0], &keys[0]), (&b.features, &masks[1], &keys[1])]);
        let k = network.config.map.min(pair[0].inputs.lambda.nrows()).min(pair[1].inputs.lambda.nrows());
        let leading = |matrix: &Array2<f32>| tensor(matrix.slice(s![.., ..k]));
        Self {
            features,
            logits: [a.logits.clone(), b.logits.clone()],
            labels,
            phi: pair.map(|sample| leading(&sample.inputs.phi)),
            projector: pair.map(|sample| leading(&sample.inputs.projector)),
            lambda: pair.map(|sample| sample.inputs.lambda.column(0).iter().take(k).map(|&l| f64::from(l)).collect()),
            places: pair.map(|sample| sample.places.clone()),
            whole: pair.iter().all(|sample| sample.share >= WHOLE),
            extents: [(a, pair[0]), (b, pair[1])].map(|(of, sample)| {
                let right = 0.5 * f64::from(sample.share).ln() - f64::from(sample.inputs.extent).ln();
                of.extent.clone().map(|said| (said, right))
            }),
            solve: network.config.solve,
        }
    }

    fn side(&self, side: usize) -> Side<'_> {
        Side {
            features: &self.features[side],
            logits: &self.logits[side],
            labels: &self.labels[side],
            phi: &self.phi[side],
            projector: &self.projector[side],
            lambda: &self.lambda[side],
            places: self.places[side].as_ref(),
        }
    }

    /// The losses.
    pub fn losses(&self, weights: &LossWeights, maps: bool) -> candle_core::Result<Terms> {
        let mut terms = losses(weights, self.solve, &self.side(0), &self.side(1), maps && self.whole)?;
        if let [Some((a, right_a)), Some((b, right_b))] = &self.extents {
            let off = |said: &Tensor, right: f64| said.affine(1.0, -right)?.sqr()?.sum_all();
            terms.push(("extent", weights.extent, (off(a, *right_a)? + off(b, *right_b)?)?.affine(0.5, 0.0)?));
        }
        Ok(terms)
    }

    /// Share of points of both shapes whose part is right, by the largest logit.
    pub fn part_accuracy(&self, pair: [&Sample; 2]) -> f64 {
        let of = |side: usize| super::losses::part_accuracy(matrix(&self.logits[side]).view(), &pair[side].labels);
        0.5 * (of(0) + of(1))
    }

    /// Share of points of A that the functional map sends to a point of B with their part.
    pub fn same_part(&self, pair: [&Sample; 2]) -> candle_core::Result<f64> {
        let [_, c_ba] = functional_maps(&self.side(0), &self.side(1), self.solve)?;
        let a_in_b = matrix(&Autodiff.matmul(&self.phi[0], &c_ba));
        let (to_b, _) = Cpu.nearest_rows(&a_in_b, &matrix(&self.phi[1]), None);
        let kept = to_b.iter().zip(&pair[0].labels).filter(|&(&j, label)| pair[1].labels[j as usize] == *label);
        Ok(kept.count() as f64 / pair[0].labels.len() as f64)
    }
}

/// Probabilities of parts that attention masks with: predicted ones as in matching, or where the mask is hard or nothing teaches the network parts `given` labels,
/// as in the paper.
fn mask(given: bool, logits: &Tensor, labels: &Tensor) -> Tensor {
    if given { labels.clone() } else { Autodiff.softmax_rows(&logits.detach()) }
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::{Autodiff, Device, mask, matrix, tensor};

    #[test]
    fn attention_masks_with_labels_where_they_are_given_and_else_as_predicted() {
        let (logits, labels) = (tensor(array![[0.5, -2.0]].view()), tensor(array![[0.0, 1.0]].view()));
        let of = |given: bool| matrix(&mask(given, &logits, &labels));
        assert_eq!(of(true), matrix(&labels));
        assert_eq!(of(false), matrix(&Autodiff.softmax_rows(&logits)));
    }
}
