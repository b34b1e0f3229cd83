//! Layers without a shape: the same for every point.

use super::error::WeightsError;
use super::weights::{Source, Start};
use crate::device::Device;

/// x W + b, or x W.
#[derive(Clone, Debug)]
pub struct Linear<T> {
    weight: T,
    bias: Option<T>,
}

impl<T> Linear<T> {
    /// From `inputs` to `outputs` channels; new ones start with variance `gain`²/inputs.
    pub fn new(
        source: &mut impl Source<T>,
        name: &str,
        inputs: usize,
        outputs: usize,
        gain: f32,
    ) -> Result<Self, WeightsError> {
        let mut linear = Self::without_bias(source, name, inputs, outputs, gain)?;
        linear.bias = Some(source.tensor(&format!("{name}.bias"), [1, outputs], Start::Constant(0.0))?);
        Ok(linear)
    }

    /// The same without b: nothing gives nothing.
    pub fn without_bias(
        source: &mut impl Source<T>,
        name: &str,
        inputs: usize,
        outputs: usize,
        gain: f32,
    ) -> Result<Self, WeightsError> {
        let spread = gain / (inputs as f32).sqrt();
        let weight = source.tensor(&format!("{name}.weight"), [inputs, outputs], Start::Normal(spread))?;
        Ok(Self { weight, bias: None })
    }

    /// (n, inputs) → (n, outputs).
    pub fn forward<D: Device<Tensor = T>>(&self, device: &D, x: &T) -> T {
        match &self.bias {
            Some(bias) => device.linear(x, &self.weight, bias),
            None => device.matmul(x, &self.weight),
        }
    }
}

/// Normalisation before a block.
#[derive(Clone, Debug)]
pub struct LayerNorm<T> {
    gain: T,
    bias: T,
}

impl<T> LayerNorm<T> {
    /// Over `channels`.
    pub fn new(source: &mut impl Source<T>, name: &str, channels: usize) -> Result<Self, WeightsError> {
        Ok(Self {
            gain: source.tensor(&format!("{name}.gain"), [1, channels], Start::Constant(1.0))?,
            bias: source.tensor(&format!("{name}.bias"), [1, channels], Start::Constant(0.0))?,
        })
    }

    /// (n, channels) → (n, channels).
    pub fn forward<D: Device<Tensor = T>>(&self, device: &D, x: &T) -> T {
        device.layer_norm(x, &self.gain, &self.bias)
    }
}
