//! From first maps to a correspondence: bijective ZoomOut, then deformed coordinates.
//!
//! ZoomOut: Melzi et al. 2019. Both directions share one embedding, as in bijective variants, so that one pass over the distances gives the match both
//! ways. Iterations run on an even sampling of each body; only the last match sees every point.

use ndarray::{Array2, ArrayView2, Axis};

use serde::{Deserialize, Serialize};

use super::alignment::{Rotation, rotate};
use super::functional_map::least_squares;
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

/// Points of each body's even sampling that iterations run on.
pub const COARSE: usize = 2000;
/// Growth of the basis per ZoomOut iteration.
const STEP: usize = 10;
/// Rounds with coordinates.
const ROUNDS: usize = 6;
/// Weight of coordinates (in √area) against the spectral embedding, whose columns are divided by √k.
const COORDINATE_WEIGHT: f32 = 16.0;

/// What refinement compares of one body, at some of its points.
struct Side<T> {
    /// Φ (rows, k).
    phi: T,
    /// Positions (rows, 3), both bodies in the frame of A.
    x: T,
    /// Part label per row, when parts keep points apart.
    parts: Option<Vec<u32>>,
}

/// Refines `first` and matches every point both ways. `rotation` brings B to A. `parts` are part labels (n) of A and B: then
/// no point is matched to another part (paper Sec. 3.3, at the level of the map). Returns the correspondences A → B and B → A, and the maps
/// they came from.
pub async fn refine<D: Device>(
    device: &D,
    (a, b): (&Matchable, &Matchable),
    first: MapPair,
    rotation: &Rotation,
    parts: Option<(&[u32], &[u32])>,
    refinement: Refinement,
    progress: &mut Progress<'_>,
) -> Result<(Correspondence, Correspondence, MapPair), Cancelled> {
    let smallest = first.c_ab.nrows();
    let largest = if refinement == Refinement::None { smallest } else { a.basis.k().min(b.basis.k()) };
    let (x_a, x_b) = (a.points.view(), rotate(b.points.view(), rotation));
    let (parts_a, parts_b) = parts.unzip();
    let coarse_a = Side::at(device, a, x_a, parts_a, &a.coarse, largest);
    let coarse_b = Side::at(device, b, x_b.view(), parts_b, &b.coarse, largest);

    let coarse_parts = parts_of(&coarse_a, &coarse_b);

    let mut maps = first;
    let mut k = smallest;
    while k < largest {
        progress.at(Stage::Refine, 0.7 * (k - smallest) as f64 / (largest - smallest) as f64)?;
        let narrow = [device.leading_columns(&coarse_a.phi, k), device.leading_columns(&coarse_b.phi, k)];
        let there_and_back = joint_nearest(device, &maps, [&narrow[0], &narrow[1]], nothing(), coarse_parts);
        k = (k + STEP).min(largest);
        let wide = [device.leading_columns(&coarse_a.phi, k), device.leading_columns(&coarse_b.phi, k)];
        maps = maps_of_match(device, [&wide[0], &wide[1]], &there_and_back).await;
    }

    let mut shifts = None;
    if refinement == Refinement::Best {
        let phi = [&coarse_a.phi, &coarse_b.phi];
        let mut there_and_back = joint_nearest(device, &maps, phi, nothing(), coarse_parts);
        for round in 0..ROUNDS {
            progress.at(Stage::Refine, 0.7 + 0.3 * round as f64 / ROUNDS as f64)?;
            maps = maps_of_match(device, phi, &there_and_back).await;
            let shift_a = coarse_a.shift_onto(device, &coarse_b, &there_and_back.0).await;
            let shift_b = coarse_b.shift_onto(device, &coarse_a, &there_and_back.1).await;
            let laid = [coarse_a.laid(device, &shift_a), coarse_b.laid(device, &shift_b)];
            let beside = coordinates(&coarse_a, &coarse_b, &laid);
            there_and_back = joint_nearest(device, &maps, phi, beside, coarse_parts);
            shifts = Some([shift_a, shift_b]);
        }
        maps = maps_of_match(device, phi, &there_and_back).await;
    }

    progress.at(Stage::Correspondence, 0.0)?;
    let every = |m: &Matchable| (0..m.len() as u32).collect::<Vec<u32>>();
    let full_a = Side::at(device, a, x_a, parts_a, &every(a), largest);
    let full_b = Side::at(device, b, x_b.view(), parts_b, &every(b), largest);
    let laid = shifts.map(|[shift_a, shift_b]| [full_a.laid(device, &shift_a), full_b.laid(device, &shift_b)]);
    let beside = laid.as_ref().map_or_else(nothing, |laid| coordinates(&full_a, &full_b, laid));
    let (to_b, to_a) = joint_nearest(device, &maps, [&full_a.phi, &full_b.phi], beside, parts_of(&full_a, &full_b));
    let (to_b, to_a) = (device.download_indices(&to_b).await, device.download_indices(&to_a).await);
    progress.at(Stage::Correspondence, 0.8)?;
    Ok((Correspondence::between(a, &to_b, &to_a), Correspondence::between(b, &to_a, &to_b), maps))
}

impl<T> Side<T> {
    /// The rows of a shape whose positions `x` (n, 3) are in the frame of A.
    fn at<D: Device<Tensor = T>>(
        device: &D,
        shape: &Matchable,
        x: ArrayView2<f64>,
        parts: Option<&[u32]>,
        rows: &[u32],
        k: usize,
    ) -> Self {
        let wide: Vec<usize> = rows.iter().map(|&i| i as usize).collect();
        Self {
            phi: device.upload(shape.phi_at(rows, k).view()),
            x: device.upload(x.select(Axis(0), &wide).mapv(|v| v as f32).view()),
            parts: parts.map(|parts| wide.iter().map(|&i| parts[i]).collect()),
        }
    }

    /// The displacement that lays this body onto `other` by the match `there`, as coefficients (k, 3) of the eigenfunctions. Smoothing the displacement
    /// and not the position keeps what is finer than the basis: fingers, feet, faces.
    async fn shift_onto<D: Device<Tensor = T>>(&self, device: &D, other: &Self, there: &D::Indices) -> T {
        let displacement = device.add(&device.gather(&other.x, there), &self.x, -1.0);
        let coefficients = fit(device, &self.phi, &displacement).await;
        device.upload(coefficients.mapv(|v| v as f32).view())
    }

    /// Positions (rows, 3) after the displacement.
    fn laid<D: Device<Tensor = T>>(&self, device: &D, shift: &T) -> T {
        device.add(&self.x, &device.matmul(&self.phi, shift), 1.0)
    }
}

/// Columns that compare A laid onto B with B, and A with B laid onto A.
fn coordinates<'t, T>(a: &'t Side<T>, b: &'t Side<T>, [laid_a, laid_b]: &'t [T; 2]) -> [Vec<&'t T>; 2] {
    [vec![laid_a, &a.x], vec![&b.x, laid_b]]
}

/// What stands beside the spectral columns before any coordinates do.
fn nothing<'t, T>() -> [Vec<&'t T>; 2] {
    [Vec::new(), Vec::new()]
}

/// Part labels of both sides, when there are any.
fn parts_of<'t, T>(a: &'t Side<T>, b: &'t Side<T>) -> Option<(&'t [u32], &'t [u32])> {
    a.parts.as_deref().zip(b.parts.as_deref())
}

/// The match both ways in the joint embedding [Φ_A C_ba, Φ_A] against [Φ_B, Φ_B C_ab], each divided by √k, with further columns beside
/// them. First the rows of B for A's, then the rows of A for B's; `parts` are labels of both that keep points apart.
pub(super) fn joint_nearest<D: Device>(
    device: &D,
    maps: &MapPair,
    [phi_a, phi_b]: [&D::Tensor; 2],
    [beside_a, beside_b]: [Vec<&D::Tensor>; 2],
    parts: Option<(&[u32], &[u32])>,
) -> (D::Indices, D::Indices) {
    let single = |c: &Array2<f64>| device.upload(c.mapv(|v| v as f32).view());
    let weight = 1.0 / (maps.c_ab.nrows() as f32).sqrt();
    let embed = |spectral: [&D::Tensor; 2], beside: Vec<&D::Tensor>| {
        let spectral = spectral.into_iter().map(|part| (part, weight));
        device.concat(&spectral.chain(beside.into_iter().map(|part| (part, COORDINATE_WEIGHT))).collect::<Vec<_>>())
    };
    let (a_in_b, b_in_a) = (device.matmul(phi_a, &single(&maps.c_ba)), device.matmul(phi_b, &single(&maps.c_ab)));
    device.nearest_rows(&embed([&a_in_b, phi_a], beside_a), &embed([phi_b, &b_in_a], beside_b), parts)
}

/// The functional maps of a match both ways, by least squares over the rows at hand: C_ba = Φ_A⁺ Φ_B[to_b], C_ab = Φ_B⁺ Φ_A[to_a].
pub(super) async fn maps_of_match<D: Device>(
    device: &D,
    [phi_a, phi_b]: [&D::Tensor; 2],
    (to_b, to_a): &(D::Indices, D::Indices),
) -> MapPair {
    MapPair {
        c_ba: fit(device, phi_a, &device.gather(phi_b, to_b)).await,
        c_ab: fit(device, phi_b, &device.gather(phi_a, to_a)).await,
    }
}

/// Coefficients (k, m) of functions (rows, m) given at the rows of Φ (rows, k).
async fn fit<D: Device>(device: &D, phi: &D::Tensor, functions: &D::Tensor) -> Array2<f64> {
    let gram = device.download(&device.matmul_tn(phi, phi)).await;
    let right = device.download(&device.matmul_tn(phi, functions)).await;
    least_squares(gram.view(), right.view())
}
