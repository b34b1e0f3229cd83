//! Batch normalisation (Ioffe & Szegedy 2015), which the paper has after each diffusion (Sec. 3.3): every channel to mean 0 and variance 1 over the points.
//!
//! In training the points are those of all shapes of a step; in matching there is one shape, and the running mean and variance of training take their place.

use ndarray::Array2;

use super::error::WeightsError;
use super::weights::{Source, Start};
use crate::device::Device;

/// Gain and bias of each channel, and its mean and variance as training saw them.
#[derive(Clone, Debug)]
pub(super) struct BatchNorm<T> {
    name: String,
    gain: T,
    bias: T,
    mean: T,
    variance: T,
}

/// Mean and variance (1, c) of each channel that a layer found over the points at hand.
#[derive(Clone, Debug)]
pub struct Statistics<T> {
    /// The layer's name: in the weights its tensors end in `.mean` and `.variance`.
    pub layer: String,
    /// The mean.
    pub mean: T,
    /// The mean square of what is left without it.
    pub variance: T,
}

/// The points of the shapes of a step, as statistics are taken over them: each counts alike.
pub(super) struct Points<T> {
    /// Of each shape a column (n, 1) of ones.
    ones: Vec<T>,
    /// Of each shape a column (n, 1) of one over the points of all.
    shares: Vec<T>,
}

impl<T> Points<T> {
    /// Of shapes of so many points.
    pub(super) fn of<D: Device<Tensor = T>>(device: &D, counts: impl Iterator<Item = usize> + Clone) -> Self {
        let share = 1.0 / counts.clone().sum::<usize>().max(1) as f32;
        let columns = |value: f32| {
            let column = |n| device.upload(Array2::from_elem((n, 1), value).view());
            counts.clone().map(column).collect()
        };
        Self { ones: columns(1.0), shares: columns(share) }
    }

    /// The mean (1, c) of the rows of all shapes.
    fn mean<D: Device<Tensor = T>>(&self, device: &D, rows: &[T]) -> T {
        let parts = self.shares.iter().zip(rows).map(|(share, rows)| device.matmul_tn(share, rows));
        parts.reduce(|sum, part| device.add(&sum, &part, 1.0)).expect("there are shapes")
    }

    /// Rows of each shape without a mean (1, c).
    fn without<D: Device<Tensor = T>>(&self, device: &D, rows: &[T], mean: &T) -> Vec<T> {
        let centred = |(ones, rows): (&T, &T)| device.add(rows, &device.matmul(ones, mean), -1.0);
        self.ones.iter().zip(rows).map(centred).collect()
    }
}

impl<T> BatchNorm<T> {
    /// Over `channels`.
    pub(super) fn new(source: &mut impl Source<T>, name: &str, channels: usize) -> Result<Self, WeightsError> {
        let mut row =
            |part: &str, start| source.tensor(&format!("{name}.{part}"), [1, channels], Start::Constant(start));
        Ok(Self {
            gain: row("gain", 1.0)?,
            bias: row("bias", 0.0)?,
            mean: row("mean", 0.0)?,
            variance: row("variance", 1.0)?,
            name: name.to_owned(),
        })
    }

    /// Shapes (n, c) each, by the statistics in the weights.
    pub(super) fn by_weights<D: Device<Tensor = T>>(&self, device: &D, shapes: &[T]) -> Vec<T> {
        self.normal(device, shapes, &self.mean, &self.variance)
    }

    /// Shapes (n, c) each, by the statistics of their own points, which are returned too.
    pub(super) fn by_points<D: Device<Tensor = T>>(
        &self,
        device: &D,
        shapes: &[T],
        points: &Points<T>,
    ) -> (Vec<T>, Statistics<T>) {
        let mean = points.mean(device, shapes);
        let squares: Vec<T> =
            points.without(device, shapes, &mean).iter().map(|rest| device.multiply(rest, rest)).collect();
        let variance = points.mean(device, &squares);
        (self.normal(device, shapes, &mean, &variance), Statistics { layer: self.name.clone(), mean, variance })
    }

    fn normal<D: Device<Tensor = T>>(&self, device: &D, shapes: &[T], mean: &T, variance: &T) -> Vec<T> {
        let normal = |x| device.batch_norm(x, (mean, variance), &self.gain, &self.bias);
        shapes.iter().map(normal).collect()
    }
}
