//! DiffusionNet (Sharp, Attaiki, Crane & Ovsjanikov 2022): points talk to each other through heat that spreads for learned times, and through gradients.
//!
//! Departures: gradient features are inner products with a real matrix (the sign of a tangent axis, which means nothing on a cloud, falls out);
//! [`Moments`] join each block; layer norm before each block where the paper (Sec. 3.3) has batch normalisation after each diffusion. The two norms
//! have not been compared here, and no configuration has the paper's.

use super::inputs::InputsOn;
use super::layers::{LayerNorm, Linear};
use super::moments::{Moments, moment_channels};
use super::weights::{Source, Start, WeightsError};
use crate::device::Device;

/// One residual block of `width` channels.
#[derive(Clone, Debug)]
pub struct DiffusionBlock<T> {
    norm: LayerNorm<T>,
    log_times: T,
    turn: T,
    moments: Option<Moments<T>>,
    hidden: Linear<T>,
    out: Linear<T>,
}

/// Triple products of vectors of length about ½ are small; this brings them to the size of the other channels.
const TRIPLE_GAIN: f32 = 8.0;

impl<T> DiffusionBlock<T> {
    /// With `q` moments (0 for none).
    pub fn new(source: &mut impl Source<T>, name: &str, width: usize, q: usize) -> Result<Self, WeightsError> {
        Ok(Self {
            norm: LayerNorm::new(source, &format!("{name}.norm"), width)?,
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

    /// (n, width) → (n, width).
    pub fn forward<D: Device<Tensor = T>>(&self, device: &D, x: &T, shape: &InputsOn<T>) -> T {
        let y = self.norm.forward(device, x);
        let coefficients = device.diffuse(&device.matmul_tn(&shape.projector, &y), &shape.lambda, &self.log_times);
        let smooth = device.matmul(&shape.phi, &coefficients);
        let [along, across] = &shape.gradients;
        let product = |axis: &T| {
            let gradient = device.matmul(axis, &coefficients);
            device.multiply(&gradient, &device.matmul(&gradient, &self.turn))
        };
        let gradients = device.tanh(&device.add(&product(along), &product(across), 1.0));
        let moments = self.moments.as_ref().map(|moments| moments.forward(device, &y, shape));
        let mut channels = vec![(&y, 1.0), (&smooth, 1.0), (&gradients, 1.0)];
        if let Some([inner, triple]) = &moments {
            channels.extend([(inner, 1.0), (triple, TRIPLE_GAIN)]);
        }
        let hidden = device.relu(&self.hidden.forward(device, &device.concat(&channels)));
        device.add(x, &self.out.forward(device, &hidden), 1.0)
    }
}
