//! From functional maps to point maps and back: nearest neighbours in the joint embedding of both directions, and the maps of a match.

use ndarray::{Array2, s};

use super::functional_map::least_squares;
use crate::device::Device;

/// The two functional maps of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPair {
    /// Functions on A → functions on B: (k_b, k_a).
    pub c_ab: Array2<f64>,
    /// Functions on B → functions on A: (k_a, k_b).
    pub c_ba: Array2<f64>,
}

impl MapPair {
    /// Whether all entries are numbers. Least squares of anything else has no solution.
    pub(crate) fn is_finite(&self) -> bool {
        self.c_ab.iter().chain(&self.c_ba).all(|v| v.is_finite())
    }
}

/// Columns of A and of B that stand beside the spectral ones.
pub(crate) struct SideColumns<'t, T> {
    /// What else tells points apart, and how much that counts.
    pub(crate) extra: Option<([&'t T; 2], f32)>,
    /// How near points are to landmarks, and how much that counts.
    pub(crate) landmarks: Option<([&'t T; 2], f32)>,
    /// Where the bodies lie and how they turn, at rest and registered to each other.
    pub(crate) registered: Option<[T; 2]>,
}

impl<'t, T> SideColumns<'t, T> {
    /// Spectral columns are all there is.
    pub(crate) fn nothing() -> Self {
        Self { extra: None, landmarks: None, registered: None }
    }

    /// Those of A (0) or of B (1), with their weights.
    fn of(&self, side: usize) -> impl Iterator<Item = (&T, f32)> {
        let known = self.extra.iter().chain(&self.landmarks).map(move |(both, weight)| (both[side], *weight));
        known.chain(self.registered.as_ref().map(|both| (&both[side], 1.0)))
    }
}

/// The match both ways in the joint embedding [Φ_A C_ba, Φ_A] against [Φ_B, Φ_B C_ab], each times `spectral`/√k, with further columns beside
/// them. First the rows of B for A's, then the rows of A for B's; `parts` are labels of both that keep points apart.
pub(crate) fn joint_nearest<D: Device>(
    device: &D,
    maps: &MapPair,
    [phi_a, phi_b]: [&D::Tensor; 2],
    spectral: f32,
    more: &SideColumns<D::Tensor>,
    parts: Option<(&[u32], &[u32])>,
) -> (D::Indices, D::Indices) {
    let single = |c: &Array2<f64>| device.upload(c.mapv(|v| v as f32).view());
    let weight = spectral / (maps.c_ab.nrows() as f32).sqrt();
    let embed = |of_a: &D::Tensor, of_b: &D::Tensor, side: usize| {
        let columns: Vec<_> = [(of_a, weight), (of_b, weight)].into_iter().chain(more.of(side)).collect();
        device.concat(&columns)
    };
    let (a_in_b, b_in_a) = (device.matmul(phi_a, &single(&maps.c_ba)), device.matmul(phi_b, &single(&maps.c_ab)));
    device.nearest_rows(&embed(&a_in_b, phi_a, 0), &embed(phi_b, &b_in_a, 1), parts)
}

/// The functional maps of a match both ways, by least squares over the rows at hand: C_ba = Φ_A⁺ Φ_B[to_b], C_ab = Φ_B⁺ Φ_A[to_a]; k eigenfunctions of both.
pub(crate) async fn maps_of_match<D: Device>(
    device: &D,
    [phi_a, phi_b]: [&D::Tensor; 2],
    (to_b, to_a): &(D::Indices, D::Indices),
) -> MapPair {
    let normal = |phi: &D::Tensor, other: &D::Tensor, rows: &D::Indices| {
        [device.matmul_tn(phi, phi), device.matmul_tn(phi, &device.gather(other, rows))]
    };
    let ([gram_a, right_a], [gram_b, right_b]) = (normal(phi_a, phi_b, to_b), normal(phi_b, phi_a, to_a));
    // Side by side they come down together.
    let together = device.concat(&[(&gram_a, 1.0), (&right_a, 1.0), (&gram_b, 1.0), (&right_b, 1.0)]);
    let systems = device.download(&together).await;
    let k = systems.nrows();
    let block = |i: usize| systems.slice(s![.., i * k..(i + 1) * k]);
    MapPair { c_ba: least_squares(block(0), block(1)), c_ab: least_squares(block(2), block(3)) }
}
