//! From first maps to a correspondence: ZoomOut, or rounds in which each body is also registered to the other.
//!
//! Both directions share one embedding, as in bijective variants of ZoomOut (Melzi et al. 2019), so that one pass over the distances gives the match
//! both ways. Iterations run on an even sampling of each body; only the last match sees every point. Whatever is compared of two bodies lies in
//! the frame of one of them, so turning either changes nothing.

use ndarray::{Array2, Axis, concatenate};
use serde::{Deserialize, Serialize};

use super::deformation::{Columns, Registration};
use super::landmarks::{Constraints, doubt, nearness, residuals, samples};
use crate::confidence::{Cues, confidence};
use crate::device::{Device, Interrupted, still_well};
use crate::maps::{Correspondence, MapPair, Matchable, SideColumns, joint_nearest, maps_of_match};
use crate::progress::{Progress, Stage};

/// How far a match is polished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Refinement {
    /// The first functional maps as they are, nearest neighbours over spectral coordinates and learned features.
    None,
    /// ZoomOut up to the whole basis.
    ZoomOut,
    /// Rounds that also compare where each body goes, and how it turns, when it is registered to the other.
    #[default]
    Best,
}

/// Points of each body's even sampling that iterations run on.
pub const COARSE: usize = 2000;
/// Weight of the nearness to a landmark, from the first round to the last: at 4, two points, one of which is in the place of a landmark and the other far from it, are as
/// different as if they lay half of √area apart. Nearness itself is not quite the same on two bodies: with 4 to the end seven right landmarks took a pair of people from
/// 1.52 to 1.87, with 1 at the end to 1.56 (version 6 of the weights, which is in the card).
const LANDMARKS: [f32; 2] = [4.0, 1.0];
/// Growth of the basis per ZoomOut iteration.
const STEP: usize = 10;

/// How the rounds go from coarse and stiff to fine and soft: each range from the first round to the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    pub(super) rounds: usize,
    /// Eigenfunctions in use.
    pub(super) basis: [usize; 2],
    /// Weight of rigidity against targets, at [`COARSE`] points.
    pub(super) stiffness: [f64; 2],
    /// Weight of the spectral columns, which are divided by √k besides.
    pub(super) spectral: [f32; 2],
    /// Weight of coordinates in √area.
    pub(super) coordinates: [f32; 2],
    /// Weight of normals.
    pub(super) normals: [f32; 2],
    /// Weight of what else is known of points.
    pub(super) extra: [f32; 2],
}

/// Between two meshes. On 24 pairs of the generator's bodies (seeds from 800001) the error after so many rounds is 2.28 with 5 rounds on the whole basis, 2.21
/// with 15, 2.12 to 2.14 when these begin with 40 or 60 eigenfunctions, 2.09 when what else is known of points fades as well, 2.05 with 25 rounds and with 40.
/// Other weights of stiffness and coordinates change it by 0.02 at most; heavier normals cost 0.1.
pub(super) const MESH: Schedule = Schedule {
    rounds: 15,
    basis: [60, usize::MAX],
    stiffness: [30.0, 1.0],
    spectral: [1.0, 1.0],
    coordinates: [4.0, 8.0],
    normals: [1.0, 1.0],
    extra: [1.0, 0.3],
};

/// Where one of the two is a cloud, or a mesh whose faces agree on no outside: 10 to 15 rounds would gain 0.02 to 0.03 of 3.03 there (12 pairs).
pub(super) const CLOUD: Schedule = Schedule {
    rounds: 7,
    basis: [60, usize::MAX],
    stiffness: [30.0, 0.3],
    spectral: [1.0, 1.0],
    coordinates: [4.0, 4.0],
    normals: [0.5, 1.0],
    extra: [0.4, 0.0],
};

/// Where one of the two is a piece: no functional map goes between it and a whole, so what the network says of points stands for the spectral columns, and then where
/// each lies that was laid onto the other; of both only the points that come back pull (`deformation.rs`).
pub(super) const PIECE: Schedule = Schedule {
    rounds: 10,
    basis: [60, 60],
    stiffness: [30.0, 1.0],
    spectral: [0.0, 0.0],
    coordinates: [4.0, 8.0],
    normals: [0.5, 1.0],
    extra: [1.0, 0.3],
};

impl Schedule {
    fn share(&self, round: usize) -> f64 {
        if self.rounds > 1 { round as f64 / (self.rounds - 1) as f64 } else { 1.0 }
    }

    fn even(&self, [first, last]: [f32; 2], round: usize) -> f32 {
        first + (last - first) * self.share(round) as f32
    }

    /// Eigenfunctions in a round, of the `all` there are.
    fn basis(&self, round: usize, all: usize) -> usize {
        let [first, last] = self.basis.map(|k| k.min(all) as f64);
        (first + (last - first) * self.share(round)).round() as usize
    }

    /// μ in a round: from the first to the last by equal factors.
    fn stiffness(&self, round: usize) -> f64 {
        let [first, last] = self.stiffness;
        first * (last / first).powf(self.share(round))
    }

    fn spectral(&self, round: usize) -> f32 {
        self.even(self.spectral, round)
    }

    /// What A deformed onto B has in common with B, and A with B deformed onto A.
    fn side_columns<'t, D: Device>(
        &self,
        device: &D,
        sides: &'t [Side<D::Tensor>; 2],
        [a, b]: &[Columns; 2],
        round: usize,
    ) -> SideColumns<'t, D::Tensor> {
        let (coordinates, normals) = (self.even(self.coordinates, round), self.even(self.normals, round));
        let weighed = |[x, y]: [&Array2<f32>; 2], [u, v]: [&Array2<f32>; 2]| {
            let columns = concatenate![Axis(1), x * coordinates, y * coordinates, u * normals, v * normals];
            device.upload(columns.view())
        };
        let registered = [
            weighed([&a.registered, &a.rest], [&a.turned, &a.normals]),
            weighed([&b.rest, &b.registered], [&b.normals, &b.turned]),
        ];
        SideColumns {
            registered: Some(registered),
            ..known(sides, self.even(self.extra, round), self.even(LANDMARKS, round))
        }
    }
}

/// What refinement compares of one body, at some of its points.
struct Side<T> {
    /// Φ (rows, k).
    phi: T,
    /// Further columns that say which point is which, when there are any.
    extra: Option<T>,
    /// How near the rows are to each landmark, when there are any.
    landmarks: Option<T>,
    /// Part label per row, when parts keep points apart.
    parts: Option<Vec<u32>>,
}

impl<T> Side<T> {
    /// Every point of a body, with `extra` columns, those of `landmarks`, and the first k eigenfunctions.
    fn new<D: Device<Tensor = T>>(
        device: &D,
        shape: &Matchable,
        extra: Option<&T>,
        landmarks: Option<&Array2<f32>>,
        parts: Option<&[u32]>,
        k: usize,
    ) -> Self {
        let extra = extra.map(|extra| device.concat(&[(extra, 1.0)]));
        let landmarks = landmarks.map(|nearness| device.upload(nearness.view()));
        Self { phi: device.upload(shape.phi(k).view()), extra, landmarks, parts: parts.map(<[u32]>::to_vec) }
    }

    /// Some of the points.
    fn at<D: Device<Tensor = T>>(&self, device: &D, rows: &[u32]) -> Self {
        let parts = self.parts.as_ref().map(|parts| rows.iter().map(|&i| parts[i as usize]).collect());
        let rows = device.upload_indices(rows);
        let extra = self.extra.as_ref().map(|extra| device.gather(extra, &rows));
        let landmarks = self.landmarks.as_ref().map(|nearness| device.gather(nearness, &rows));
        Self { phi: device.gather(&self.phi, &rows), extra, landmarks, parts }
    }
}

/// What is known of the points of both sides whatever the maps are.
fn known<T>([a, b]: &[Side<T>; 2], weight: f32, nearness: f32) -> SideColumns<'_, T> {
    let both = a.extra.as_ref().zip(b.extra.as_ref());
    let extra = both.filter(|_| weight > 0.0).map(|(on_a, on_b)| ([on_a, on_b], weight));
    let landmarks = a.landmarks.as_ref().zip(b.landmarks.as_ref());
    let landmarks = landmarks.map(|(on_a, on_b)| ([on_a, on_b], nearness));
    SideColumns { extra, landmarks, registered: None }
}

/// A refined match.
pub(crate) struct Refined {
    /// For each point used of A its point on B.
    pub a_to_b: Correspondence,
    /// For each point used of B its point on A.
    pub b_to_a: Correspondence,
    /// The maps they came from; with a piece under [`Refinement::Best`], those of the last match but one.
    pub maps: MapPair,
    /// What confidence was judged by, from A to B and back.
    pub cues: [Cues; 2],
    /// Mean distance at which the map passes the landmarks by, in √area; 0 without any.
    pub residual: f64,
}

/// Refines `first` and matches every point both ways. `extra` are columns (n, c) of A and of B that agree at points that correspond, weighed as they are to
/// count beside positions in √area: point features of a network, probabilities of parts. Labels keep points in their part (paper Sec. 3.3, at the level of the map).
/// Landmarks are matched to each other in every round and draw along what lies around them; whether the map has followed is left to be seen in its last match. First
/// maps that are asked for as they are know nothing of landmarks here. Returns the correspondences A → B and B → A, the maps they came from, what confidence
/// was judged by, and how far landmarks are missed.
pub(crate) async fn refine<D: Device>(
    device: &D,
    (a, b): (&Matchable, &Matchable),
    first: MapPair,
    extra: Option<&[D::Tensor; 2]>,
    constraints: Constraints<'_>,
    refinement: Refinement,
    progress: &mut Progress<'_>,
) -> Result<Refined, Interrupted> {
    let piece = a.share.min(b.share) < 1.0;
    let schedule = match a.surface.oriented && b.surface.oriented {
        _ if piece => PIECE,
        true => MESH,
        false => CLOUD,
    };
    // What the first maps say of points. Without a network there is nothing else to tell those of a piece by.
    let spectral_first = if piece && extra.is_some() { 0.0 } else { 1.0 };
    let smallest = first.c_ab.nrows();
    let largest = if refinement == Refinement::None { smallest } else { a.basis.k().min(b.basis.k()) };
    let ((parts_a, parts_b), (extra_a, extra_b)) =
        (constraints.parts.unzip(), extra.map(|[on_a, on_b]| (on_a, on_b)).unzip());
    let nearby = constraints.nearby();
    let near = (!nearby.is_empty()).then(|| {
        [(a, 0), (b, 1)].map(|(shape, side): (_, usize)| nearness(shape, nearby.iter().map(move |pair| pair[side])))
    });
    let drawing = near.as_ref().filter(|_| refinement != Refinement::None);
    let (near_a, near_b) = drawing.map(|[on_a, on_b]| (on_a, on_b)).unzip();
    let full = [
        Side::new(device, a, extra_a, near_a, parts_a, largest),
        Side::new(device, b, extra_b, near_b, parts_b, largest),
    ];
    let held = samples([a, b], constraints.landmarks);
    let coarse = || [full[0].at(device, &a.coarse), full[1].at(device, &b.coarse)];
    let (maps, spectral, registered) = match refinement {
        Refinement::None => (first, spectral_first, None),
        Refinement::ZoomOut => (zoom_out(device, &coarse(), first, largest, &held, progress).await?, 1.0, None),
        Refinement::Best => {
            let coarse = coarse();
            let mut registration = Registration::new(a, b, COARSE);
            let mut there_and_back =
                nearest(device, &coarse, &first, spectral_first, &known(&coarse, 1.0, LANDMARKS[0]));
            hold(device, &mut there_and_back, &held).await;
            let mut round = 0;
            loop {
                progress.at(Stage::Refine, round as f64 / schedule.rounds as f64)?;
                let phi = leading(device, &coarse, schedule.basis(round, largest));
                let maps = maps_of_match(device, [&phi[0], &phi[1]], &there_and_back).await;
                let to_b = device.download_indices(&there_and_back.0).await;
                let to_a = device.download_indices(&there_and_back.1).await;
                still_well(device, Stage::Refine)?;
                finite(&maps, Stage::Refine)?;
                registration.follow(&to_b, &to_a, schedule.stiffness(round));
                if round + 1 == schedule.rounds {
                    break (maps, schedule.spectral(round), Some(registration));
                }
                let more = schedule.side_columns(device, &coarse, &registration.coarse(), round);
                there_and_back = nearest(device, &coarse, &maps, schedule.spectral(round), &more);
                hold(device, &mut there_and_back, &held).await;
                round += 1;
            }
        }
    };

    progress.at(Stage::Correspondence, 0.0)?;
    let registered = registered.map(|registration| registration.everywhere());
    let more = match &registered {
        Some(columns) => schedule.side_columns(device, &full, columns, schedule.rounds - 1),
        None => known(&full, 1.0, LANDMARKS[0]),
    };
    let (to_b, to_a) = nearest(device, &full, &maps, spectral, &more);
    let (to_b, to_a) = (device.download_indices(&to_b).await, device.download_indices(&to_a).await);
    still_well(device, Stage::Correspondence)?;
    progress.at(Stage::Correspondence, 0.8)?;
    let [registered_a, registered_b] = match &registered {
        Some([a, b]) => [Some(a.registered.view()), Some(b.registered.view())],
        None => [None, None],
    };
    let cues = [Cues::of([a, b], [&to_b, &to_a], registered_a), Cues::of([b, a], [&to_a, &to_b], registered_b)];
    let [confidence_a, confidence_b] = [&cues[0], &cues[1]].map(confidence);
    let mut a_to_b = Correspondence { target: to_b, confidence: confidence_a };
    let mut b_to_a = Correspondence { target: to_a, confidence: confidence_b };
    let residuals = residuals([a, b], constraints.landmarks, [&a_to_b.target, &b_to_a.target]);
    if let Some([near_a, near_b]) = &near {
        doubt(&mut a_to_b, near_a, &residuals);
        doubt(&mut b_to_a, near_b, &residuals);
    }
    let residual = residuals.iter().sum::<f64>() / residuals.len().max(1) as f64;
    Ok(Refined { a_to_b, b_to_a, maps, cues, residual })
}

/// ZoomOut: matches and maps in turn, the basis growing from that of `maps` to `largest` eigenfunctions.
async fn zoom_out<D: Device>(
    device: &D,
    coarse: &[Side<D::Tensor>; 2],
    mut maps: MapPair,
    largest: usize,
    held: &[[u32; 2]],
    progress: &mut Progress<'_>,
) -> Result<MapPair, Interrupted> {
    let smallest = maps.c_ab.nrows();
    let mut k = smallest;
    while k < largest {
        progress.at(Stage::Refine, (k - smallest) as f64 / (largest - smallest) as f64)?;
        let more = SideColumns { extra: None, ..known(coarse, 0.0, LANDMARKS[0]) };
        let mut there_and_back = nearest(device, coarse, &maps, 1.0, &more);
        hold(device, &mut there_and_back, held).await;
        k = (k + STEP).min(largest);
        let phi = leading(device, coarse, k);
        maps = maps_of_match(device, [&phi[0], &phi[1]], &there_and_back).await;
        still_well(device, Stage::Refine)?;
        finite(&maps, Stage::Refine)?;
    }
    Ok(maps)
}

/// Matches samples that are known to correspond.
async fn hold<D: Device>(device: &D, (to_b, to_a): &mut (D::Indices, D::Indices), held: &[[u32; 2]]) {
    if held.is_empty() {
        return;
    }
    let (mut there, mut back) = (device.download_indices(to_b).await, device.download_indices(to_a).await);
    for &[s, t] in held {
        there[s as usize] = t;
        back[t as usize] = s;
    }
    (*to_b, *to_a) = (device.upload_indices(&there), device.upload_indices(&back));
}

/// Ends the work of a stage on maps that hold anything but numbers.
fn finite(maps: &MapPair, stage: Stage) -> Result<(), Interrupted> {
    if maps.is_finite() { Ok(()) } else { Err(Interrupted::NotFinite(stage)) }
}

/// The first k eigenfunctions of both sides.
fn leading<D: Device>(device: &D, [a, b]: &[Side<D::Tensor>; 2], k: usize) -> [D::Tensor; 2] {
    [device.leading_columns(&a.phi, k), device.leading_columns(&b.phi, k)]
}

/// [`joint_nearest`] of two sides, in the size of the maps.
fn nearest<D: Device>(
    device: &D,
    sides: &[Side<D::Tensor>; 2],
    maps: &MapPair,
    spectral: f32,
    more: &SideColumns<D::Tensor>,
) -> (D::Indices, D::Indices) {
    let [phi_a, phi_b] = leading(device, sides, maps.c_ab.nrows());
    let parts = sides[0].parts.as_deref().zip(sides[1].parts.as_deref());
    joint_nearest(device, maps, [&phi_a, &phi_b], spectral, more, parts)
}
