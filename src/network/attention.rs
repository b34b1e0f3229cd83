//! Part-aware masked attention between two shapes (paper Sec. 3.3).
//!
//! The paper masks with given labels, which uploads do not have. Here the mask is the logarithm of the probability that two points share a part, by the
//! predicted probabilities; given labels are probabilities of 0 and 1. [`Mask`] says what becomes of points that share none.

use super::error::WeightsError;
use super::layers::{LayerNorm, Linear};
use super::weights::Source;
use crate::device::{Device, Mask};

/// Cross-attention of one shape's points to the key points of the other.
#[derive(Clone, Debug)]
pub struct PartAttention<T> {
    norm: LayerNorm<T>,
    query: Linear<T>,
    key: Linear<T>,
    value: Linear<T>,
    out: Linear<T>,
    mask: Mask,
}

impl<T> PartAttention<T> {
    /// On `channels` per point, compared in `width`.
    pub fn new(
        source: &mut impl Source<T>,
        name: &str,
        channels: usize,
        width: usize,
        mask: Mask,
    ) -> Result<Self, WeightsError> {
        let mut linear =
            |part: &str, inputs, outputs, gain| Linear::new(source, &format!("{name}.{part}"), inputs, outputs, gain);
        Ok(Self {
            query: linear("query", channels, width, 1.0)?,
            key: linear("key", channels, width, 1.0)?,
            value: linear("value", channels, width, 1.0)?,
            // Zero, so that attention can join a trained network without changing it.
            out: match mask {
                Mask::Soft => linear("out", width, channels, 0.0)?,
                // A query that sees no key gets zeros, and without a bias keeps its own features.
                Mask::Hard => Linear::without_bias(source, &format!("{name}.out"), width, channels, 0.0)?,
            },
            norm: LayerNorm::new(source, &format!("{name}.norm"), channels)?,
            mask,
        })
    }

    /// Points x (n, channels) after looking at the other shape's key points (m, channels), each with its probabilities of parts (·, c).
    pub fn forward<D: Device<Tensor = T>>(&self, device: &D, (x, parts): (&T, &T), (keys, key_parts): (&T, &T)) -> T {
        let (own, other) = (self.norm.forward(device, x), self.norm.forward(device, keys));
        let query = self.query.forward(device, &own);
        let (key, value) = (self.key.forward(device, &other), self.value.forward(device, &other));
        let seen = device.attend((&query, parts), (&key, key_parts), &value, self.mask);
        device.add(x, &self.out.forward(device, &seen), 1.0)
    }
}
