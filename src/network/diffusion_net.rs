//! DiffusionNet (Sharp, Attaiki, Crane & Ovsjanikov 2022): points talk to each other through heat that spreads for learned times, and through gradients.
//!
//! Departures: gradient features are inner products with a real matrix (the sign of a tangent axis, which means nothing on a cloud, falls out);
//! [`Moments`] join each block; layer norm before each block where the paper (Sec. 3.3) has batch normalisation after each diffusion
//! ([`Norm::Batch`](super::Norm::Batch)).

use super::batch_norm::{BatchNorm, Points, Statistics};
use super::error::WeightsError;
use super::inputs::InputsOn;
use super::layers::{LayerNorm, Linear};
use super::moments::{Moments, moment_channels};
use super::weights::{Source, Start};
use super::{ModelConfig, Norm};
use crate::device::Device;

/// One residual block of `width` channels.
#[derive(Clone, Debug)]
pub struct DiffusionBlock<T> {
    norm: BlockNorm<T>,
    log_times: T,
    turn: T,
    moments: Option<Moments<T>>,
    hidden: Linear<T>,
    out: Linear<T>,
}

/// What a block normalises.
#[derive(Clone, Debug)]
enum BlockNorm<T> {
    /// Points, before it.
    Layer(LayerNorm<T>),
    /// Channels, after diffusion.
    Batch(BatchNorm<T>),
}

/// What batch normalisation goes by.
pub(super) enum Going<'a, T> {
    /// The statistics in the weights.
    ByWeights,
    /// Those of the points at hand; every layer leaves what it found.
    ByPoints(&'a Points<T>, Vec<Statistics<T>>),
}

/// Triple products of vectors of length about ½ are small; this brings them to the size of the other channels.
const TRIPLE_GAIN: f32 = 8.0;

impl<T> DiffusionBlock<T> {
    /// Of a network of this configuration.
    pub fn new(source: &mut impl Source<T>, name: &str, config: &ModelConfig) -> Result<Self, WeightsError> {
        let (width, q) = (config.width, config.moments);
        let norm = format!("{name}.norm");
        Ok(Self {
            norm: match config.norm {
                Norm::Layer => BlockNorm::Layer(LayerNorm::new(source, &norm, width)?),
                Norm::Batch => BlockNorm::Batch(BatchNorm::new(source, &norm, width)?),
            },
            log_times: source.tensor(&format!("{name}.log_times"), [1, width], Start::Logarithms(3e-4, 0.3))?,
            turn: source.tensor(
                &format!("{name}.turn"),
                [width, width],
                Start::Normal((width as f32).sqrt().recip()),
            )?,
            moments: (q > 0).then(|| Moments::new(source, name, width, q)).transpose()?,
            hidden: Linear::new(source, &format!("{name}.hidden"), 3 * width + moment_channels(q), width, 1.4)?,
            // Small, so that a new network starts near the identity.
            out: Linear::new(source, &format!("{name}.out"), width, width, 0.5)?,
        })
    }

    /// (n, width) → (n, width) for each shape.
    pub(super) fn forward<D: Device<Tensor = T>>(
        &self,
        device: &D,
        x: Vec<T>,
        shapes: &[&InputsOn<T>],
        going: &mut Going<'_, T>,
    ) -> Vec<T> {
        let normal: Option<Vec<T>> = match &self.norm {
            BlockNorm::Layer(norm) => Some(x.iter().map(|x| norm.forward(device, x)).collect()),
            BlockNorm::Batch(_) => None,
        };
        let y = normal.as_ref().unwrap_or(&x);
        let each = || y.iter().zip(shapes);
        let mut coefficients: Vec<T> = each()
            .map(|(y, shape)| device.diffuse(&device.matmul_tn(&shape.projector, y), &shape.lambda, &self.log_times))
            .collect();
        let mut smooth: Vec<T> =
            coefficients.iter().zip(shapes).map(|(c, shape)| device.matmul(&shape.phi, c)).collect();
        if let BlockNorm::Batch(norm) = &self.norm {
            smooth = match going {
                Going::ByWeights => norm.by_weights(device, &smooth),
                Going::ByPoints(points, found) => {
                    let (normal, statistics) = norm.by_points(device, &smooth, points);
                    found.push(statistics);
                    normal
                }
            };
            // Gradients are of what comes out of diffusion, and so of what was normalised.
            coefficients = smooth.iter().zip(shapes).map(|(s, shape)| device.matmul_tn(&shape.projector, s)).collect();
        }
        let of_shape = |i: usize| {
            let (x, y, smooth, coefficients, shape) = (&x[i], &y[i], &smooth[i], &coefficients[i], shapes[i]);
            let [along, across] = &shape.gradients;
            let product = |axis: &T| {
                let gradient = device.matmul(axis, coefficients);
                device.multiply(&gradient, &device.matmul(&gradient, &self.turn))
            };
            let gradients = device.tanh(&device.add(&product(along), &product(across), 1.0));
            let moments = self.moments.as_ref().map(|moments| moments.forward(device, y, shape));
            let mut channels = vec![(y, 1.0), (smooth, 1.0), (&gradients, 1.0)];
            if let Some([inner, triple]) = &moments {
                channels.extend([(inner, 1.0), (triple, TRIPLE_GAIN)]);
            }
            let hidden = device.relu(&self.hidden.forward(device, &device.concat(&channels)));
            device.add(x, &self.out.forward(device, &hidden), 1.0)
        };
        (0..shapes.len()).map(of_shape).collect()
    }
}
