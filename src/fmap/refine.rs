//! From first maps to a correspondence: bijective ZoomOut, then deformed coordinates.
//!
//! ZoomOut: Melzi et al. 2019. Both directions share one embedding, as in bijective variants, so that one pass over the distances gives the match both
//! ways. Iterations run on an even sampling of each body; only the last match sees every point.

use ndarray::{Array2, ArrayView2, Axis};

use serde::{Deserialize, Serialize};

use super::alignment::{Rotation, rotate};
use super::functional_map::least_squares;
use super::initial::FIRST;
use super::{Correspondence, Matchable};
use crate::device::Device;
use crate::progress::{Cancelled, Progress, Stage};

/// The two functional maps of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPair {
    /// Functions on A → functions on B: (k_b, k_a).
    pub c_ab: Array2<f64>,
    /// Functions on B → functions on A: (k_a, k_b).
    pub c_ba: Array2<f64>,
}

/// How far a match is polished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Refinement {
    /// The first functional maps as they are.
    None,
    /// ZoomOut up to the whole basis.
    ZoomOut,
    /// ZoomOut, then rounds that also compare where each body goes when it is laid onto the other.
    #[default]
    Best,
}

/// Points of each body that iterations run on.
const COARSE: usize = 2000;
/// Growth of the basis per ZoomOut iteration.
const STEP: usize = 10;
/// Rounds with coordinates.
const ROUNDS: usize = 3;
/// Weight of coordinates (in √area) against the spectral embedding, whose columns are divided by √k.
const COORDINATE_WEIGHT: f32 = 8.0;

/// Refines `first` and matches every point both ways. `rotation` brings B to A. `parts` are one-hot part labels (n, labels) of A and B: then
/// no point is matched to another part (paper Sec. 3.3, at the level of the map). Returns the correspondences A → B and B → A, and the maps
/// they came from.
pub async fn refine<D: Device>(
    device: &D,
    a: &Matchable,
    b: &Matchable,
    first: MapPair,
    rotation: &Rotation,
    parts: Option<(ArrayView2<'_, f32>, ArrayView2<'_, f32>)>,
    refinement: Refinement,
    progress: &mut Progress<'_>,
) -> Result<(Correspondence, Correspondence, MapPair), Cancelled> {
    let rows = |m: &Matchable| m.coarse[..COARSE.min(m.coarse.len())].to_vec();
    let (rows_a, rows_b) = (rows(a), rows(b));
    let last = a.basis.k().min(b.basis.k());
    let upload = |m: &Matchable, rows: &[u32]| device.upload(m.phi_at(rows, last).view());
    let (phi_a, phi_b) = (upload(a, &rows_a), upload(b, &rows_b));
    let at_rows = |table: ArrayView2<f32>, rows: &[u32]| {
        let rows: Vec<usize> = rows.iter().map(|&i| i as usize).collect();
        device.upload(table.select(Axis(0), &rows).view())
    };
    let (parts_a, parts_b) = match parts {
        Some((parts_a, parts_b)) => (vec![at_rows(parts_a, &rows_a)], vec![at_rows(parts_b, &rows_b)]),
        None => (Vec::new(), Vec::new()),
    };
    let mut maps = first;

    if refinement != Refinement::None {
        let mut k = FIRST.min(last);
        while k < last {
            progress.at(Stage::Refine, (k - FIRST.min(last)) as f64 / (last - FIRST.min(last)) as f64 * 0.7)?;
            let next = (k + STEP).min(last);
            let (leading_a, leading_b) = (device.leading_columns(&phi_a, k), device.leading_columns(&phi_b, k));
            let (to_b, to_a) = joint_nearest(device, &maps, &leading_a, &leading_b, &parts_a, &parts_b);
            let (wider_a, wider_b) = (device.leading_columns(&phi_a, next), device.leading_columns(&phi_b, next));
            maps = maps_of_match(device, &wider_a, &wider_b, &to_b, &to_a).await;
            k = next;
        }
    }

    let (every_a, every_b): (Vec<u32>, Vec<u32>) = ((0..a.len() as u32).collect(), (0..b.len() as u32).collect());
    let k = maps.c_ab.nrows();
    let (mut extra_a, mut extra_b) = (Vec::new(), Vec::new());
    if refinement == Refinement::Best {
        let in_frame_of_a = rotate(b.points.view(), rotation).mapv(|v| v as f32);
        let (x_a, x_b) = (device.upload(a.points_at(&rows_a).view()), at_rows(in_frame_of_a.view(), &rows_b));
        let (mut to_b, mut to_a) = joint_nearest(device, &maps, &phi_a, &phi_b, &parts_a, &parts_b);
        for round in 0..ROUNDS {
            progress.at(Stage::Refine, 0.7 + 0.3 * round as f64 / ROUNDS as f64)?;
            maps = maps_of_match(device, &phi_a, &phi_b, &to_b, &to_a).await;
            // Where A goes when laid onto B and where B is, both as seen through their own first k eigenfunctions; and the other way round.
            let laid_a = smooth(device, &phi_a, &device.gather(&x_b, &to_b)).await;
            let own_b = smooth(device, &phi_b, &x_b).await;
            let laid_b = smooth(device, &phi_b, &device.gather(&x_a, &to_a)).await;
            let own_a = smooth(device, &phi_a, &x_a).await;
            let beside = |phi: &D::Tensor, first: &D::Tensor, second: &D::Tensor, parts: &[D::Tensor]| {
                let coordinates = [(&device.matmul(phi, first), 1.0), (&device.matmul(phi, second), 1.0)];
                device.concat(&coordinates.into_iter().chain(parts.iter().map(|p| (p, 1.0))).collect::<Vec<_>>())
            };
            let beside_a = beside(&phi_a, &laid_a, &own_a, &parts_a);
            let beside_b = beside(&phi_b, &own_b, &laid_b, &parts_b);
            (to_b, to_a) = joint_nearest(device, &maps, &phi_a, &phi_b, &[beside_a], &[beside_b]);
            if round + 1 == ROUNDS {
                (extra_a, extra_b) = (vec![laid_a, own_a], vec![own_b, laid_b]);
                maps = maps_of_match(device, &phi_a, &phi_b, &to_b, &to_a).await;
            }
        }
    }

    progress.at(Stage::Correspondence, 0.0)?;
    let (phi_a, phi_b) = (device.upload(a.phi_at(&every_a, k).view()), device.upload(b.phi_at(&every_b, k).view()));
    let spread = |phi: &D::Tensor, coefficients: &[D::Tensor]| -> Vec<D::Tensor> {
        coefficients.iter().map(|c| device.matmul(phi, c)).collect()
    };
    let (mut extra_a, mut extra_b) = (spread(&phi_a, &extra_a), spread(&phi_b, &extra_b));
    if let Some((parts_a, parts_b)) = parts {
        extra_a.push(device.upload(parts_a));
        extra_b.push(device.upload(parts_b));
    }
    let (to_b, to_a) = joint_nearest(device, &maps, &phi_a, &phi_b, &extra_a, &extra_b);
    let (to_b, to_a) = (device.download_indices(&to_b).await, device.download_indices(&to_a).await);
    progress.at(Stage::Correspondence, 0.8)?;
    Ok((Correspondence::between(a, &to_b, &to_a), Correspondence::between(b, &to_a, &to_b), maps))
}

/// The match both ways in the joint embedding [Φ_A C_ba, Φ_A] against [Φ_B, Φ_B C_ab], each divided by √k, with extra columns
/// (coordinates) beside them. First the rows of B for A's, then the rows of A for B's.
pub(super) fn joint_nearest<D: Device>(
    device: &D,
    maps: &MapPair,
    phi_a: &D::Tensor,
    phi_b: &D::Tensor,
    extra_a: &[D::Tensor],
    extra_b: &[D::Tensor],
) -> (D::Indices, D::Indices) {
    let single = |c: &Array2<f64>| device.upload(c.mapv(|v| v as f32).view());
    let weight = 1.0 / (maps.c_ab.nrows() as f32).sqrt();
    let in_b = device.matmul(phi_a, &single(&maps.c_ba));
    let in_a = device.matmul(phi_b, &single(&maps.c_ab));
    let embed = |spectral: [&D::Tensor; 2], extra: &[D::Tensor]| {
        let spectral = spectral.into_iter().map(|part| (part, weight));
        let parts: Vec<_> = spectral.chain(extra.iter().map(|part| (part, COORDINATE_WEIGHT))).collect();
        device.concat(&parts)
    };
    device.nearest_rows(&embed([&in_b, phi_a], extra_a), &embed([phi_b, &in_a], extra_b))
}

/// The functional maps of a match both ways, by least squares over the rows at hand: C_ba = Φ_A⁺ Φ_B[to_b], C_ab = Φ_B⁺ Φ_A[to_a].
async fn maps_of_match<D: Device>(
    device: &D,
    phi_a: &D::Tensor,
    phi_b: &D::Tensor,
    to_b: &D::Indices,
    to_a: &D::Indices,
) -> MapPair {
    MapPair {
        c_ba: fit(device, phi_a, &device.gather(phi_b, to_b)).await,
        c_ab: fit(device, phi_b, &device.gather(phi_a, to_a)).await,
    }
}

/// Coefficients, on the device, of functions given at the rows of Φ.
async fn smooth<D: Device>(device: &D, phi: &D::Tensor, functions: &D::Tensor) -> D::Tensor {
    let coefficients = fit(device, phi, functions).await;
    device.upload(coefficients.mapv(|v| v as f32).view())
}

async fn fit<D: Device>(device: &D, phi: &D::Tensor, functions: &D::Tensor) -> Array2<f64> {
    let gram = device.download(&device.matmul_tn(phi, phi)).await;
    let right = device.download(&device.matmul_tn(phi, functions)).await;
    let (gram, right): (ArrayView2<f32>, ArrayView2<f32>) = (gram.view(), right.view());
    least_squares(gram, right)
}
