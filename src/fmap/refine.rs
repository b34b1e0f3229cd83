//! From first maps to a correspondence: ZoomOut, or rounds in which each body is also laid onto the other.
//!
//! Both directions share one embedding, as in bijective variants of ZoomOut (Melzi et al. 2019), so that one pass over the distances gives the match
//! both ways. Iterations run on an even sampling of each body; only the last match sees every point. Whatever is compared of two bodies lies in
//! the frame of one of them, so turning either changes nothing.

use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};

use super::confidence::confidence;
use super::cues::Cues;
use super::functional_map::least_squares;
use super::laying::{Columns, Laying};
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
    /// The first functional maps as they are, nearest neighbours over spectral coordinates and learned features.
    None,
    /// ZoomOut up to the whole basis.
    ZoomOut,
    /// Rounds that also compare where each body goes, and how it turns, when it is laid onto the other.
    #[default]
    Best,
}

/// Points of each body's even sampling that iterations run on.
pub const COARSE: usize = 2000;
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

/// Between two meshes.
pub(super) const MESH: Schedule = Schedule {
    rounds: 5,
    basis: [120, usize::MAX],
    stiffness: [30.0, 1.0],
    spectral: [1.0, 1.0],
    coordinates: [4.0, 8.0],
    normals: [1.0, 1.0],
    extra: [1.0, 1.0],
};

/// Where one of the two is a cloud.
pub(super) const CLOUD: Schedule = Schedule {
    rounds: 7,
    basis: [60, usize::MAX],
    stiffness: [30.0, 0.3],
    spectral: [1.0, 1.0],
    coordinates: [4.0, 4.0],
    normals: [0.5, 1.0],
    extra: [0.4, 0.0],
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

    /// What A laid onto B has in common with B, and A with B laid onto A.
    fn beside<D: Device>(
        &self,
        device: &D,
        sides: &[Side<D::Tensor>; 2],
        [a, b]: &[Columns; 2],
        round: usize,
    ) -> Beside<D::Tensor> {
        let (coordinates, normals) = (self.even(self.coordinates, round), self.even(self.normals, round));
        let mut beside = extra(device, sides, self.even(self.extra, round));
        let [of_a, of_b] = &mut beside;
        let mut push = |on_a: &Array2<f32>, on_b: &Array2<f32>, weight: f32| {
            of_a.push((device.upload(on_a.view()), weight));
            of_b.push((device.upload(on_b.view()), weight));
        };
        push(&a.laid, &b.rest, coordinates);
        push(&a.rest, &b.laid, coordinates);
        push(&a.turned, &b.normals, normals);
        push(&a.normals, &b.turned, normals);
        beside
    }
}

/// What refinement compares of one body, at some of its points.
struct Side<T> {
    /// Φ (rows, k).
    phi: T,
    /// Further columns that say which point is which, when there are any.
    extra: Option<T>,
    /// Part label per row, when parts keep points apart.
    parts: Option<Vec<u32>>,
}

/// Columns of A and of B that stand beside the spectral ones, with their weights.
type Beside<T> = [Vec<(T, f32)>; 2];

/// A refined match.
pub struct Refined {
    /// For each point used of A its point on B.
    pub a_to_b: Correspondence,
    /// For each point used of B its point on A.
    pub b_to_a: Correspondence,
    /// The maps they came from.
    pub maps: MapPair,
    /// What confidence was judged by, from A to B and back.
    pub cues: [Cues; 2],
}

/// Refines `first` and matches every point both ways. `parts` are part labels (n) of A and B: then
/// no point is matched to another part (paper Sec. 3.3, at the level of the map). Returns the correspondences A → B and B → A, and the maps
/// they came from.
pub async fn refine<D: Device>(
    device: &D,
    (a, b): (&Matchable, &Matchable),
    first: MapPair,
    parts: Option<(&[u32], &[u32])>,
    refinement: Refinement,
    progress: &mut Progress<'_>,
) -> Result<Refined, Cancelled> {
    let schedule = if a.surface.oriented && b.surface.oriented { MESH } else { CLOUD };
    refine_by(device, (a, b), first, parts, refinement, &schedule, progress).await
}

pub(super) async fn refine_by<D: Device>(
    device: &D,
    (a, b): (&Matchable, &Matchable),
    first: MapPair,
    parts: Option<(&[u32], &[u32])>,
    refinement: Refinement,
    schedule: &Schedule,
    progress: &mut Progress<'_>,
) -> Result<Refined, Cancelled> {
    let smallest = first.c_ab.nrows();
    let largest = if refinement == Refinement::None { smallest } else { a.basis.k().min(b.basis.k()) };
    let (parts_a, parts_b) = parts.unzip();
    let at = |rows_a: &[u32], rows_b: &[u32]| {
        [Side::at(device, a, parts_a, rows_a, largest), Side::at(device, b, parts_b, rows_b, largest)]
    };
    let (maps, spectral, laid) = match refinement {
        Refinement::None => (first, 1.0, None),
        Refinement::ZoomOut => {
            (zoom_out(device, &at(&a.coarse, &b.coarse), first, largest, progress).await?, 1.0, None)
        }
        Refinement::Best => {
            let coarse = at(&a.coarse, &b.coarse);
            let mut laying = Laying::new(a, b, COARSE);
            let beside = extra(device, &coarse, 1.0);
            let mut there_and_back = nearest(device, &coarse, &first, 1.0, &beside);
            let mut round = 0;
            loop {
                progress.at(Stage::Refine, round as f64 / schedule.rounds as f64)?;
                let phi = leading(device, &coarse, schedule.basis(round, largest));
                let maps = maps_of_match(device, [&phi[0], &phi[1]], &there_and_back).await;
                let to_b = device.download_indices(&there_and_back.0).await;
                let to_a = device.download_indices(&there_and_back.1).await;
                laying.follow(&to_b, &to_a, schedule.stiffness(round));
                if round + 1 == schedule.rounds {
                    break (maps, schedule.spectral(round), Some(laying));
                }
                let beside = schedule.beside(device, &coarse, &laying.coarse(), round);
                there_and_back = nearest(device, &coarse, &maps, schedule.spectral(round), &beside);
                round += 1;
            }
        }
    };

    progress.at(Stage::Correspondence, 0.0)?;
    let every = |m: &Matchable| (0..m.len() as u32).collect::<Vec<u32>>();
    let full = at(&every(a), &every(b));
    let laid = laid.map(|laying| laying.everywhere());
    let beside = match &laid {
        Some(columns) => schedule.beside(device, &full, columns, schedule.rounds - 1),
        None => extra(device, &full, 1.0),
    };
    let (to_b, to_a) = nearest(device, &full, &maps, spectral, &beside);
    let (to_b, to_a) = (device.download_indices(&to_b).await, device.download_indices(&to_a).await);
    progress.at(Stage::Correspondence, 0.8)?;
    let [laid_a, laid_b] = match &laid {
        Some([a, b]) => [Some(a.laid.view()), Some(b.laid.view())],
        None => [None, None],
    };
    let cues = [Cues::of([a, b], [&to_b, &to_a], laid_a), Cues::of([b, a], [&to_a, &to_b], laid_b)];
    let [confidence_a, confidence_b] = [&cues[0], &cues[1]].map(confidence);
    let a_to_b = Correspondence { target: to_b, confidence: confidence_a };
    let b_to_a = Correspondence { target: to_a, confidence: confidence_b };
    Ok(Refined { a_to_b, b_to_a, maps, cues })
}

/// ZoomOut: matches and maps in turn, the basis growing from that of `maps` to `largest` eigenfunctions.
async fn zoom_out<D: Device>(
    device: &D,
    coarse: &[Side<D::Tensor>; 2],
    mut maps: MapPair,
    largest: usize,
    progress: &mut Progress<'_>,
) -> Result<MapPair, Cancelled> {
    let smallest = maps.c_ab.nrows();
    let mut k = smallest;
    while k < largest {
        progress.at(Stage::Refine, (k - smallest) as f64 / (largest - smallest) as f64)?;
        let there_and_back = nearest(device, coarse, &maps, 1.0, &nothing());
        k = (k + STEP).min(largest);
        let phi = leading(device, coarse, k);
        maps = maps_of_match(device, [&phi[0], &phi[1]], &there_and_back).await;
    }
    Ok(maps)
}

impl<T> Side<T> {
    fn at<D: Device<Tensor = T>>(device: &D, shape: &Matchable, parts: Option<&[u32]>, rows: &[u32], k: usize) -> Self {
        let wide: Vec<usize> = rows.iter().map(|&i| i as usize).collect();
        Self {
            phi: device.upload(shape.phi_at(rows, k).view()),
            extra: shape.extra.as_ref().map(|extra| device.upload(extra.select(Axis(0), &wide).view())),
            parts: parts.map(|parts| wide.iter().map(|&i| parts[i]).collect()),
        }
    }
}

/// What else is known of the points of both sides.
fn extra<D: Device>(device: &D, sides: &[Side<D::Tensor>; 2], weight: f32) -> Beside<D::Tensor> {
    let [a, b] = sides;
    match (&a.extra, &b.extra) {
        (Some(on_a), Some(on_b)) if weight > 0.0 => [on_a, on_b].map(|e| vec![(device.concat(&[(e, 1.0)]), weight)]),
        _ => nothing(),
    }
}

fn nothing<T>() -> Beside<T> {
    [Vec::new(), Vec::new()]
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
    beside: &Beside<D::Tensor>,
) -> (D::Indices, D::Indices) {
    let [phi_a, phi_b] = leading(device, sides, maps.c_ab.nrows());
    let parts = sides[0].parts.as_deref().zip(sides[1].parts.as_deref());
    joint_nearest(device, maps, [&phi_a, &phi_b], spectral, beside, parts)
}

/// The match both ways in the joint embedding [Φ_A C_ba, Φ_A] against [Φ_B, Φ_B C_ab], each times `spectral`/√k, with further columns beside
/// them. First the rows of B for A's, then the rows of A for B's; `parts` are labels of both that keep points apart.
pub(super) fn joint_nearest<D: Device>(
    device: &D,
    maps: &MapPair,
    [phi_a, phi_b]: [&D::Tensor; 2],
    spectral: f32,
    [beside_a, beside_b]: &[Vec<(D::Tensor, f32)>; 2],
    parts: Option<(&[u32], &[u32])>,
) -> (D::Indices, D::Indices) {
    let single = |c: &Array2<f64>| device.upload(c.mapv(|v| v as f32).view());
    let weight = spectral / (maps.c_ab.nrows() as f32).sqrt();
    let embed = |of_a: &D::Tensor, of_b: &D::Tensor, beside: &[(D::Tensor, f32)]| {
        let mut columns = vec![(of_a, weight), (of_b, weight)];
        columns.extend(beside.iter().map(|(column, weight)| (column, *weight)));
        device.concat(&columns)
    };
    let (a_in_b, b_in_a) = (device.matmul(phi_a, &single(&maps.c_ba)), device.matmul(phi_b, &single(&maps.c_ab)));
    device.nearest_rows(&embed(&a_in_b, phi_a, beside_a), &embed(phi_b, &b_in_a, beside_b), parts)
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
