//! What the network sees of a shape.

use ndarray::{Array2, ArrayView1, ArrayView2, ArrayViewMut1, Axis, s};

use super::config::{SIGNATURES, WAVELENGTHS, encoded_channels, input_channels};
use super::{Encoding, InputConfig, Position};
use crate::descriptors::heat_kernel_signature;
use crate::device::Device;
use crate::spectrum::SpectralBasis;

/// Times of the heat kernel, in units of the area, logarithmic.
const TIMES: [f64; 2] = [1e-3, 0.2];

/// A shape as the network sees it, n points and k eigenfunctions. Lengths are in √area of the whole body: of the shape itself unless it is known to be a piece.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeInputs {
    /// Channels per point (n, c) that the DiffusionNet sees, invariant under rotation unless literal positions are among them.
    pub channels: Array2<f32>,
    /// Positions (n, 3), centred, in √area.
    pub points: Array2<f32>,
    /// Positions times mass (n, 3).
    pub moments: Array2<f32>,
    /// Φ (n, k).
    pub phi: Array2<f32>,
    /// MΦ (n, k).
    pub projector: Array2<f32>,
    /// ∂Φ along both tangent axes (n, k each).
    pub gradients: [Array2<f32>; 2],
    /// λ (k, 1), scaled so that λ_j ≈ 4πj (Weyl's law at unit area).
    pub lambda: Array2<f32>,
    /// ψ of the positions (n, d') where it joins after the DiffusionNet ([`Encoding::Features`]).
    pub encoded: Option<Array2<f32>>,
    /// √area of the shape over that of the whole body.
    pub extent: f32,
}

/// ψ of one point: sines and cosines.
fn encode(p: ArrayView1<f32>, position: Position, mut out: ArrayViewMut1<f32>) {
    let radius = [p.dot(&p).sqrt()];
    let numbers: &[f32] = match position {
        Position::Invariant => &radius,
        Position::Literal => p.as_slice().expect("row-major"),
    };
    let waves = WAVELENGTHS.iter().flat_map(|w| numbers.iter().map(move |x| std::f32::consts::TAU * x / w));
    for (i, angle) in waves.enumerate() {
        let (sin, cos) = angle.sin_cos();
        out[2 * i] = sin;
        out[2 * i + 1] = cos;
    }
}

impl ShapeInputs {
    /// For a network, from a basis (n, ≥ k) at unit area, the gradients of its eigenfunctions (n, ≥ k) and positions (n, 3) centred and in √area of
    /// the whole body; k is the network's number of eigenpairs. `extent` is √area of the shape over that of the whole body, 1 unless it is a piece.
    pub fn new(
        basis: &SpectralBasis,
        gradients: [ArrayView2<f32>; 2],
        points: ArrayView2<f64>,
        extent: f64,
        config: &InputConfig,
    ) -> Self {
        let (k, position) = (config.eigenpairs.min(basis.k()), config.position);
        let single = |v: &f64| *v as f32;
        // ΦᵀMΦ = I also where masses sum to less than 1; λ is an inverse area, and ∂Φ goes with λ.
        let (extent, area) = (extent as f32, extent * extent);
        let basis = &basis.truncated(k);
        let weyl = basis.weyl_factor();
        let lambda = basis.eigenvalues.mapv(|l| (l / (weyl * area)) as f32).insert_axis(Axis(1));
        let phi = basis.eigenvectors.map(single) / extent;
        let mass = basis.mass.map(single).insert_axis(Axis(1)) * area as f32;
        let points = points.map(single);

        let times: Vec<f64> = (0..SIGNATURES)
            .map(|i| TIMES[0] * (TIMES[1] / TIMES[0]).powf(i as f64 / (SIGNATURES - 1) as f64) / (weyl * area))
            .collect();
        let mut channels = Array2::zeros((basis.len(), input_channels(config)));
        channels.slice_mut(s![.., ..SIGNATURES]).assign(&heat_kernel_signature(basis, &times));
        let encoded = match config.encoding {
            Encoding::Input => {
                for (mut row, p) in channels.rows_mut().into_iter().zip(points.rows()) {
                    let square = p.dot(&p);
                    row[SIGNATURES] = square - 0.5;
                    row[SIGNATURES + 1] = square.sqrt() - 0.5;
                    encode(p, position, row.slice_mut(s![SIGNATURES + 2..]));
                }
                None
            }
            Encoding::Features => {
                let mut encoded = Array2::zeros((basis.len(), encoded_channels(position)));
                encoded.rows_mut().into_iter().zip(points.rows()).for_each(|(row, p)| encode(p, position, row));
                Some(encoded)
            }
        };
        Self {
            encoded,
            channels,
            moments: &points * &mass,
            projector: &phi * &mass,
            gradients: gradients.map(|g| g.slice(s![.., ..k]).to_owned() / area as f32),
            phi,
            points,
            lambda,
            extent,
        }
    }

    /// Number of points n.
    pub fn len(&self) -> usize {
        self.points.nrows()
    }

    /// True without points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Copied to a device.
    pub fn upload<D: Device>(&self, device: &D) -> InputsOn<D::Tensor> {
        InputsOn {
            channels: device.upload(self.channels.view()),
            points: device.upload(self.points.view()),
            moments: device.upload(self.moments.view()),
            phi: device.upload(self.phi.view()),
            projector: device.upload(self.projector.view()),
            gradients: [0, 1].map(|axis: usize| device.upload(self.gradients[axis].view())),
            lambda: device.upload(self.lambda.view()),
            encoded: self.encoded.as_ref().map(|encoded| device.upload(encoded.view())),
            count: self.len(),
        }
    }
}

/// [`ShapeInputs`] on a device, field by field.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct InputsOn<T> {
    pub channels: T,
    pub points: T,
    pub moments: T,
    pub phi: T,
    pub projector: T,
    pub gradients: [T; 2],
    pub lambda: T,
    pub encoded: Option<T>,
    pub count: usize,
}

#[cfg(test)]
mod tests {
    use ndarray::{Array2, array};

    use super::ShapeInputs;
    use crate::network::ModelConfig;
    use crate::spectrum::SpectralBasis;

    #[test]
    fn a_piece_is_seen_in_units_of_the_whole_body() {
        // Four points of a quarter of the mass each, at unit area.
        let basis = SpectralBasis {
            eigenvalues: array![0.0, 3.0],
            eigenvectors: array![[1.0, 1.0], [1.0, -1.0], [1.0, 1.0], [1.0, -1.0]],
            mass: array![0.25, 0.25, 0.25, 0.25],
        };
        let points = array![[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3], [-0.1, -0.2, -0.3]];
        let gradient = Array2::<f32>::ones((4, 2));
        let seen = |extent: f64| {
            let both = [gradient.view(), gradient.view()];
            ShapeInputs::new(&basis, both, points.view(), extent, &ModelConfig::shipped().input())
        };
        let (whole, half) = (seen(1.0), seen(0.5));
        assert_eq!(half.projector.t().dot(&half.phi), Array2::<f32>::eye(2));
        assert_eq!((&half.points, &half.lambda), (&whole.points, &(4.0 * &whole.lambda)));
        assert_eq!((&half.moments, &half.gradients[0]), (&(0.25 * &whole.moments), &(4.0 * &whole.gradients[0])));
    }
}
