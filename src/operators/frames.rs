//! Tangent planes.

use faer::{Mat, Side};

use crate::vector::dot;

/// An orthonormal frame at a point: two tangent axes and the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Tangent axes.
    pub tangents: [[f64; 3]; 2],
    /// Normal; on a cloud its sign means nothing.
    pub normal: [f64; 3],
}

impl Frame {
    /// A right-handed frame about a unit normal. The axes follow from the normal alone (Duff et al. 2017, "Building an Orthonormal Basis,
    /// Revisited"), so renumbering points does not turn them.
    pub fn around(normal: [f64; 3]) -> Self {
        let [x, y, z] = normal;
        let sign = 1.0_f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        Self { tangents: [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]], normal }
    }

    /// Components of a vector along the two tangent axes.
    pub fn along(&self, vector: [f64; 3]) -> [f64; 2] {
        self.tangents.map(|axis| dot(axis, vector))
    }
}

/// The frame at `centre` by principal components of the points around it: the normal is the direction they spread least in.
pub fn tangent_frame(centre: [f64; 3], around: impl Iterator<Item = [f64; 3]>) -> Frame {
    let mut covariance = Mat::<f64>::zeros(3, 3);
    let mut mean = [0.0; 3];
    let mut count = 1.0; // the centre itself, at the origin
    for point in around {
        let p: [f64; 3] = std::array::from_fn(|c| point[c] - centre[c]);
        for i in 0..3 {
            mean[i] += p[i];
            for j in 0..3 {
                covariance[(i, j)] += p[i] * p[j];
            }
        }
        count += 1.0;
    }
    for i in 0..3 {
        for j in 0..3 {
            covariance[(i, j)] -= mean[i] * mean[j] / count;
        }
    }
    match covariance.self_adjoint_eigen(Side::Lower) {
        Ok(eigen) => {
            let axis = |j: usize| -> [f64; 3] { std::array::from_fn(|i| eigen.U()[(i, j)]) };
            Frame { tangents: [axis(2), axis(1)], normal: axis(0) }
        }
        Err(_) => Frame { tangents: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], normal: [0.0, 0.0, 1.0] },
    }
}
