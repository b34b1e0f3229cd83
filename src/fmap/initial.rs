//! The first pair of maps: from descriptors, the coordinates of the two bodies brought into one frame.

use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

use super::alignment::{Rotation, axis_rotations, best_rotation, compose, inverse, principal_axes, rotate};
use super::refine::{MapPair, joint_nearest};
use super::{FunctionalMap, Matchable};
use crate::device::Device;

/// Basis size of the trial maps and points that judge them: enough to tell one limb from another.
const TRIAL: (usize, usize) = (30, 600);
/// Basis size of the first maps. Refinement must not start below (an exact map at k = 30 ends worse than a fair one at 50).
const FIRST: usize = 50;
/// Wavelengths of the position encoding, in √area: from longer than a body to a limb's length.
const WAVELENGTHS: [f64; 3] = [4.0, 2.0, 1.0];
/// Weight of all position channels together against all invariant ones together.
const POSITION_WEIGHT: f64 = 2.0;

/// C_ab and C_ba at k = 50 and the rotation that brings B to A.
///
/// The 24 ways to lay the principal axes of B onto those of A are each tried with a small map; the one whose map is most nearly a rotation of
/// the whole body wins, and the rotation it implies sets the frame for the real solve. Everything depends on relative positions only, so
/// turning, moving or scaling a body changes nothing. `landmarks` (k, l) are coefficients of functions known to correspond.
pub async fn initial_maps<D: Device>(
    device: &D,
    a: &Matchable,
    b: &Matchable,
    landmarks: Option<(ArrayView2<'_, f64>, ArrayView2<'_, f64>)>,
) -> (MapPair, Rotation) {
    let invariant = |m: &Matchable| {
        let features = m.features.mapv(f64::from);
        let channels = features.ncols().max(1) as f64;
        m.basis.project(features.view()) / channels.sqrt()
    };
    let (invariant_a, invariant_b) = (invariant(a), invariant(b));
    let position_a = position_coefficients(a, a.points.view());
    let solve = |k: usize, rotation: &Rotation| {
        let position_b = position_coefficients(b, rotate(b.points.view(), rotation).view());
        let mut parts_a = vec![invariant_a.view(), position_a.view()];
        let mut parts_b = vec![invariant_b.view(), position_b.view()];
        if let Some((landmarks_a, landmarks_b)) = landmarks {
            parts_a.push(landmarks_a);
            parts_b.push(landmarks_b);
        }
        let join = |parts: &[ArrayView2<f64>]| concatenate(Axis(1), parts).expect("one row per eigenfunction");
        solve_both(a, b, join(&parts_a).view(), join(&parts_b).view(), k)
    };

    let axes = |m: &Matchable| principal_axes(m.points.view(), m.basis.mass.iter().copied());
    let (axes_a, axes_b) = (axes(a), axes(b));
    let k = TRIAL.0.min(a.basis.k()).min(b.basis.k());
    let rows = |m: &Matchable| m.coarse[..TRIAL.1.min(m.coarse.len())].to_vec();
    let (rows_a, rows_b) = (rows(a), rows(b));
    let (points_a, points_b) = (a.points_at(&rows_a), b.points_at(&rows_b));
    let (phi_a, phi_b) = (device.upload(a.phi_at(&rows_a, k).view()), device.upload(b.phi_at(&rows_b, k).view()));
    let mut best: Option<(f64, Rotation)> = None;
    for turn in axis_rotations() {
        let rotation = compose(&inverse(&axes_a), &compose(&turn, &axes_b));
        let maps = solve(k, &rotation);
        let (to_b, to_a) = joint_nearest(device, &maps, [&phi_a, &phi_b], [vec![], vec![]]);
        let (to_b, to_a) = (device.download_indices(&to_b).await, device.download_indices(&to_a).await);
        let from = concatenate(Axis(0), &[points_b.select(Axis(0), &wide(&to_b)).view(), points_b.view()]);
        let to = concatenate(Axis(0), &[points_a.view(), points_a.select(Axis(0), &wide(&to_a)).view()]);
        let (from, to) = (from.expect("three columns"), to.expect("three columns"));
        let (rotation, residual) = best_rotation(from.view(), to.view());
        if best.is_none_or(|(least, _)| residual < least) {
            best = Some((residual, rotation));
        }
    }
    let rotation = best.map_or(compose(&inverse(&axes_a), &axes_b), |(_, rotation)| rotation);
    (solve(FIRST.min(a.basis.k()).min(b.basis.k()), &rotation), rotation)
}

fn wide(indices: &[u32]) -> Vec<usize> {
    indices.iter().map(|&i| i as usize).collect()
}

fn solve_both(a: &Matchable, b: &Matchable, g_a: ArrayView2<f64>, g_b: ArrayView2<f64>, k: usize) -> MapPair {
    let (g_a, g_b) = (g_a.slice(s![..k, ..]), g_b.slice(s![..k, ..]));
    let (lambda_a, lambda_b) = (a.basis.eigenvalues.slice(s![..k]), b.basis.eigenvalues.slice(s![..k]));
    MapPair {
        c_ab: FunctionalMap::solve(g_a, g_b, lambda_a, lambda_b).matrix,
        c_ba: FunctionalMap::solve(g_b, g_a, lambda_b, lambda_a).matrix,
    }
}

/// Sinusoidal position encoding (paper Sec. 3.3, ψ) projected on the basis: (k, 18), all channels together weighing [`POSITION_WEIGHT`].
fn position_coefficients(shape: &Matchable, points: ArrayView2<f64>) -> Array2<f64> {
    let channels = 6 * WAVELENGTHS.len();
    let encoded = Array2::from_shape_fn((points.nrows(), channels), |(i, channel)| {
        let angle = std::f64::consts::TAU * points[(i, channel % 3)] / WAVELENGTHS[channel / 6];
        if channel % 6 < 3 { angle.sin() } else { angle.cos() }
    });
    shape.basis.project(encoded.view()) * (POSITION_WEIGHT / (channels as f64).sqrt())
}
