//! A first pair of maps without a network: from descriptors, the coordinates of the two bodies brought into one frame.

use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

use super::alignment::{Rotation, axis_rotations, best_rotation, compose, inverse, principal_axes, rotate};
use super::chirality::{chirality, outward_normals};
use super::landmarks::Constraints;
use crate::device::Device;
use crate::maps::{FunctionalMap, MapPair, Matchable, SideColumns, joint_nearest, maps_of_match, smoothed};

/// Points that candidate maps are judged on: enough to tell one limb from another.
const TRIAL_POINTS: usize = 600;
/// Basis size of the first, rough look at every candidate.
const TRIAL_BASIS: usize = 30;
/// Candidates that get a map of full size.
const FINALISTS: usize = 8;
/// Rounds of matching and fitting that a finalist may settle in.
const FINAL_ROUNDS: usize = 4;
/// Basis size of the first maps. Refinement must not start below (an exact map at k = 30 ends worse than a fair one at 50).
const FIRST: usize = 50;
/// Distance from its partner, in √area, at which the odds that a landmark is matched rightly are e times worse.
const LANDMARK_SCALE: f64 = 0.03;
/// Wavelengths of the position encoding, in √area: from longer than a body to a limb's length.
const WAVELENGTHS: [f64; 3] = [4.0, 2.0, 1.0];
/// Weight of all position channels together against all invariant ones together.
const POSITION_WEIGHT: f64 = 2.0;

/// C_ab and C_ba at k = 50.
///
/// The 24 ways to lay the principal axes of B onto those of A are each tried with a small map; the one whose map is most nearly a rotation of
/// the whole body wins, and the rotation it implies sets the frame for the real solve. Everything depends on relative positions only, so
/// turning, moving or scaling a body changes nothing. `known` (k, l) are coefficients of functions known to correspond, `constraints` points and parts.
pub(crate) async fn initial_maps<D: Device>(
    device: &D,
    a: &Matchable,
    b: &Matchable,
    known: Option<(ArrayView2<'_, f64>, ArrayView2<'_, f64>)>,
    constraints: Constraints<'_>,
) -> MapPair {
    let invariant = |m: &Matchable| {
        let features = m.features.mapv(f64::from);
        let channels = features.ncols().max(1) as f64;
        m.basis.project(features.view()) / channels.sqrt()
    };
    let (invariant_a, invariant_b) = (invariant(a), invariant(b));
    let axes = |m: &Matchable| principal_axes(m.points.view(), m.basis.mass.iter().copied());
    let (axes_a, axes_b) = (axes(a), axes(b));
    // Along the axes of A, because sines along those of the upload would change when it is turned. Which way an axis points does not matter:
    // that changes a sign on both sides.
    let position_a = position_coefficients(a, rotate(a.points.view(), &axes_a).view());
    let solve = |k: usize, rotation: &Rotation| {
        let position_b = position_coefficients(b, rotate(b.points.view(), &compose(&axes_a, rotation)).view());
        let mut channels_a = vec![invariant_a.view(), position_a.view()];
        let mut channels_b = vec![invariant_b.view(), position_b.view()];
        if let Some((known_a, known_b)) = known {
            channels_a.push(known_a);
            channels_b.push(known_b);
        }
        let join = |channels: &[ArrayView2<f64>]| concatenate(Axis(1), channels).expect("one row per eigenfunction");
        solve_both(a, b, join(&channels_a).view(), join(&channels_b).view(), k)
    };

    let k = FIRST.min(a.basis.k()).min(b.basis.k());
    let trial = Trial::new(device, a, b, constraints, k);
    let mut tried = Vec::new();
    for turn in axis_rotations() {
        let rotation = compose(&inverse(&axes_a), &compose(&turn, &axes_b));
        let small = TRIAL_BASIS.min(k);
        tried.push(trial.judge(device, solve(small, &rotation), small, 0).await);
    }
    // The most rotation-like few are worth a real map each.
    tried.sort_by(|x, y| (x.residual * x.contradiction()).total_cmp(&(y.residual * y.contradiction())));
    let mut best: Option<Verdict> = None;
    for first in tried.into_iter().take(FINALISTS) {
        let verdict = trial.judge(device, solve(k, &first.rotation), k, FINAL_ROUNDS).await;
        if best.as_ref().is_none_or(|best| verdict.badness() < best.badness()) {
            best = Some(verdict);
        }
    }
    best.expect("there are always 24 candidates").maps
}

/// The coarsest points of both bodies, on which candidate maps are compared.
struct Trial<T> {
    points: [Array2<f64>; 2],
    normals: [Array2<f64>; 2],
    features: [Array2<f32>; 2],
    phi_a: Array2<f32>,
    on_device: [T; 2],
    parts: Option<[Vec<u32>; 2]>,
    /// The last so many points of each are landmarks.
    landmarks: usize,
}

/// What a candidate map implies.
struct Verdict {
    /// The maps, as far as they have settled.
    maps: MapPair,
    /// The rotation of B onto A nearest to it.
    rotation: Rotation,
    /// Root mean square distance that the rotation leaves, in √area.
    residual: f64,
    /// Whether it keeps the outside out.
    chirality: f64,
    /// Mean distance at which the map passes landmarks by, in √area; 0 without any.
    off_landmarks: f64,
    /// Mean squared difference of the invariant descriptors, each of variance 1: 2 for a map that knows nothing.
    mismatch: f64,
}

impl Verdict {
    /// The residual alone would prefer a body seen from behind where its limbs happen to lie better; with chirality alone a body may still stand on its
    /// head, and only descriptors tell arms from legs. None of them may be an excuse for the others: descriptors agree perfectly on a body and its own
    /// mirror image, which is why they get a floor and chirality counts as odds, so that a map inside out cannot win; the odds are those of a count of
    /// points, so they are never nought.
    fn badness(&self) -> f64 {
        let one_point = 1.0 / TRIAL_POINTS as f64;
        let inside_out = (1.0 - self.chirality + one_point) / (1.0 + self.chirality + one_point);
        self.residual * inside_out * (0.1 + self.mismatch) * self.contradiction()
    }

    /// The odds against the map by what a user knows, which may outweigh all else: of two maps the one that turns a body inside out is right where landmarks say so.
    fn contradiction(&self) -> f64 {
        (self.off_landmarks / LANDMARK_SCALE).exp()
    }
}

impl<T> Trial<T> {
    fn new<D: Device<Tensor = T>>(
        device: &D,
        a: &Matchable,
        b: &Matchable,
        constraints: Constraints<'_>,
        k: usize,
    ) -> Self {
        let landmarks = constraints.nearby();
        let rows = |m: &Matchable, side: usize| -> Vec<u32> {
            let even = m.coarse.iter().take(TRIAL_POINTS).copied();
            even.chain(landmarks.iter().map(|pair| pair[side])).collect()
        };
        let at = |m: &Matchable, rows: &[u32]| m.points.select(Axis(0), &wide(rows));
        let (rows_a, rows_b) = (rows(a, 0), rows(b, 1));
        let points = [at(a, &rows_a), at(b, &rows_b)];
        let normals = |m: &Matchable, points: &Array2<f64>| outward_normals(at(m, &m.coarse).view(), points.view());
        let normals = [normals(a, &points[0]), normals(b, &points[1])];
        let features = [a.features.select(Axis(0), &wide(&rows_a)), b.features.select(Axis(0), &wide(&rows_b))];
        let phi_a = a.phi_at(&rows_a, k);
        let on_device = [device.upload(phi_a.view()), device.upload(b.phi_at(&rows_b, k).view())];
        let labels = |of: &[u32], rows: &[u32]| rows.iter().map(|&i| of[i as usize]).collect();
        let parts = constraints.parts.map(|(of_a, of_b)| [labels(of_a, &rows_a), labels(of_b, &rows_b)]);
        Self { points, normals, features, phi_a, on_device, parts, landmarks: landmarks.len() }
    }

    /// Judges maps of size k after some rounds of matching and fitting again.
    async fn judge<D: Device<Tensor = T>>(&self, device: &D, mut maps: MapPair, k: usize, rounds: usize) -> Verdict {
        let [phi_a, phi_b] = [0, 1].map(|side| device.leading_columns(&self.on_device[side], k));
        let parts = self.parts.as_ref().map(|[of_a, of_b]| (&of_a[..], &of_b[..]));
        let mut there_and_back = joint_nearest(device, &maps, [&phi_a, &phi_b], 1.0, &SideColumns::nothing(), parts);
        for _ in 0..rounds {
            maps = maps_of_match(device, [&phi_a, &phi_b], &there_and_back).await;
            there_and_back = joint_nearest(device, &maps, [&phi_a, &phi_b], 1.0, &SideColumns::nothing(), parts);
        }
        let to_b = wide(&device.download_indices(&there_and_back.0).await);
        let to_a = wide(&device.download_indices(&there_and_back.1).await);
        let [points_a, points_b] = &self.points;
        let images = points_b.select(Axis(0), &to_b);
        let stack =
            |x: &Array2<f64>, y: &Array2<f64>| concatenate(Axis(0), &[x.view(), y.view()]).expect("three columns");
        let from = stack(&images, points_b);
        let to = stack(points_a, &points_a.select(Axis(0), &to_a));
        let (rotation, residual) = best_rotation(from.view(), to.view());
        let smooth = smoothed(self.phi_a.slice(s![.., ..k]), images.view());
        let image_normals = self.normals[1].select(Axis(0), &to_b);
        let chirality = chirality(points_a.view(), self.normals[0].view(), smooth.view(), image_normals.view());
        let differences = &self.features[0] - &self.features[1].select(Axis(0), &to_b);
        let mismatch = differences.iter().map(|&d| f64::from(d * d)).sum::<f64>() / differences.len().max(1) as f64;
        let apart = |points: &Array2<f64>, found: usize, wanted: usize| {
            (0..3).map(|c| (points[(found, c)] - points[(wanted, c)]).powi(2)).sum::<f64>().sqrt()
        };
        let (first_a, first_b) = (to_b.len() - self.landmarks, to_a.len() - self.landmarks);
        let off: f64 = (0..self.landmarks)
            .map(|l| {
                let (i, j) = (first_a + l, first_b + l);
                0.5 * (apart(points_b, to_b[i], j) + apart(points_a, to_a[j], i))
            })
            .sum();
        let off_landmarks = off / self.landmarks.max(1) as f64;
        Verdict { maps, rotation, residual, chirality, off_landmarks, mismatch }
    }
}

fn wide(indices: &[u32]) -> Vec<usize> {
    indices.iter().map(|&i| i as usize).collect()
}

fn solve_both(a: &Matchable, b: &Matchable, g_a: ArrayView2<f64>, g_b: ArrayView2<f64>, k: usize) -> MapPair {
    let (g_a, g_b) = (g_a.slice(s![..k, ..]), g_b.slice(s![..k, ..]));
    let [lambda_a, lambda_b] = [a, b].map(|m| m.basis.eigenvalues.slice(s![..k]).mapv(|l| l / m.basis.weyl_factor()));
    MapPair {
        c_ab: FunctionalMap::solve(g_a, g_b, lambda_a.view(), lambda_b.view()).matrix,
        c_ba: FunctionalMap::solve(g_b, g_a, lambda_b.view(), lambda_a.view()).matrix,
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
