//! The first pair of maps from what the network learned (paper Sec. 3.3): attention between the shapes, then the functional-map solve both ways.

use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

use super::refine::MapPair;
use super::{FunctionalMap, Matchable};
use crate::device::Device;
use crate::model::{Model, Network, PointEmbedding};

/// Basis size of the first maps, as in training.
const FIRST: usize = 60;
/// Key points that a point of the other shape looks at.
const KEYS: usize = 1024;
/// Weights of features of unit length and of roots of probabilities beside spectral columns and positions.
const FEATURES: f32 = 0.7;
const PARTS: f32 = 0.5;

/// C_ab and C_ba at k = 60. Leaves features and parts as further columns with both sides, for refinement. `masks` are probabilities of parts (p, c) that
/// attention masks with; `known` (k, l) are coefficients of functions known to correspond.
pub async fn learned_maps<D: Device>(
    device: &D,
    model: &Model,
    [(a, of_a), (b, of_b)]: [(&mut Matchable, &PointEmbedding); 2],
    [mask_a, mask_b]: [Array2<f32>; 2],
    known: Option<(ArrayView2<'_, f64>, ArrayView2<'_, f64>)>,
) -> MapPair {
    let weights = model.weights();
    let network = Network::new(&weights.config, &mut weights.on(device)).expect("a model's weights fit its network");
    let sides = [(&*a, of_a, &mask_a), (&*b, of_b, &mask_b)];
    let on = sides.map(|(_, e, mask)| (device.upload(e.features.view()), device.upload(mask.view())));
    let keys = sides.map(|(m, e, mask)| {
        let rows: Vec<usize> = m.coarse.iter().take(KEYS).map(|&row| row as usize).collect();
        let at = |matrix: &Array2<f32>| device.upload(matrix.select(Axis(0), &rows).view());
        (at(&e.features), at(mask))
    });
    let compared = [0, 1].map(|side: usize| {
        let (own, other) = (&on[side], &keys[1 - side]);
        network.compare(device, (&own.0, &own.1), (&other.0, &other.1))
    });
    let k = FIRST.min(a.basis.k()).min(b.basis.k());
    let mut coefficients = Vec::new();
    for (m, features) in [&*a, &*b].into_iter().zip(&compared) {
        let projector = m.basis.eigenvectors.slice(s![.., ..k]).to_owned() * m.basis.mass.view().insert_axis(Axis(1));
        let projected = device.matmul_tn(&device.upload(projector.mapv(|v| v as f32).view()), features);
        coefficients.push(device.download(&projected).await.mapv(f64::from));
    }
    if let Some((known_a, known_b)) = known {
        for (g, known) in coefficients.iter_mut().zip([known_a, known_b]) {
            *g = concatenate![Axis(1), *g, known.slice(s![..k, ..])];
        }
    }
    let (g_a, g_b) = (coefficients[0].view(), coefficients[1].view());
    let (lambda_a, lambda_b) = (a.basis.eigenvalues.slice(s![..k]), b.basis.eigenvalues.slice(s![..k]));
    let maps = MapPair {
        c_ab: FunctionalMap::solve(g_a, g_b, lambda_a, lambda_b).matrix,
        c_ba: FunctionalMap::solve(g_b, g_a, lambda_b, lambda_a).matrix,
    };
    let [features_a, features_b] = compared;
    for (m, e, features) in [(a, of_a, features_a), (b, of_b, features_b)] {
        let features = device.download(&features).await * FEATURES;
        m.extra = Some(concatenate![Axis(1), features, e.parts.mapv(|p| PARTS * p.sqrt())]);
    }
    maps
}
