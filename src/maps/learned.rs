//! The first pair of maps from what the network learned (paper Sec. 3.3): attention between the shapes, then the functional-map solve both ways.

use ndarray::{Array2, ArrayView1, ArrayView2, Axis, concatenate, s};

use super::functional_map::{FunctionalMap, functional_maps};
use super::{MapPair, Matchable};
use crate::device::{Device, Interrupted, still_well};
use crate::network::{PointEmbedding, Solver, Thresholds, TrainedNetwork};
use crate::progress::Stage;

/// Key points that a point of the other shape looks at.
const KEYS: usize = 1024;
/// Weights of features of unit length and of roots of probabilities beside spectral columns and positions.
const OF_FEATURES: f32 = 0.7;
const OF_PARTS: f32 = 0.5;

/// Out-of-distribution scores of a pair, by what a network makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutOfDistribution {
    /// ‖C_ab C_ba − I‖²/k, mean of both ways round: what the maps there and back leave of functions. Two people give 0.02 to 0.1, whatever their poses;
    /// pairs of animals, a person and an animal, and furniture 0.3 and more (by weights that know people; measured on bodies of the generator's held-out seeds,
    /// on the CC0 quadrupeds and on a sphere, torus, chair, car and noise).
    pub bijectivity: f64,
    /// Mean probability of the likeliest part, of the shape where it is smaller: of people 0.96, of animals 0.66 to 0.86.
    pub certainty: f64,
    thresholds: Thresholds,
}

impl OutOfDistribution {
    /// Whether the pair is unlike what the network was trained on: the maps there and back do not belong together.
    pub fn is_strange(&self) -> bool {
        self.bijectivity.is_nan() || self.bijectivity > self.thresholds.bijectivity
    }

    /// Whether another network's view of the same pair is the less likely one. A category that knows others and is at home comes before one that knows none.
    pub fn is_more_at_home_than(&self, other: &Self) -> bool {
        let rank = |scores: &Self| {
            let off = scores.bijectivity / scores.thresholds.bijectivity;
            let place = match (scores.thresholds.certainty > 0.0, scores.is_of_others()) {
                (true, false) => 0,
                (false, _) => 1,
                (true, true) => 2,
            };
            (place, if off.is_nan() { f64::INFINITY } else { off })
        };
        rank(self) <= rank(other)
    }

    /// Whether a shape has not the parts of the network's category, so that a map that knows nothing of it may be better.
    pub fn is_of_others(&self) -> bool {
        self.certainty.is_nan() || self.certainty < self.thresholds.certainty
    }
}

/// What the network makes of a pair.
pub(crate) struct Learned<T> {
    /// The first maps, of as many eigenfunctions as in training.
    pub maps: MapPair,
    /// How far they can be trusted.
    pub out_of_distribution: OutOfDistribution,
    /// Features after attention and roots of parts, weighted, of the points of A (n, f + c) and of B: what tells points apart beside the maps.
    pub extra: [T; 2],
}

/// The first maps. `masks` are probabilities of parts (p, c) that attention masks with; `known` (k, l) are coefficients of functions known to correspond.
pub(crate) async fn learned_maps<D: Device>(
    device: &D,
    trained: &TrainedNetwork<D::Tensor>,
    [(a, of_a), (b, of_b)]: [(&Matchable, &PointEmbedding); 2],
    [mask_a, mask_b]: &[Array2<f32>; 2],
    known: Option<(ArrayView2<'_, f64>, ArrayView2<'_, f64>)>,
) -> Result<Learned<D::Tensor>, Interrupted> {
    let network = trained.network();
    let sides = [(a, of_a, mask_a), (b, of_b, mask_b)];
    let on = sides.map(|(_, e, mask)| (device.upload(e.features.view()), device.upload(mask.view())));
    let keys = sides.map(|(m, ..)| device.upload_indices(&m.coarse[..KEYS.min(m.coarse.len())]));
    let compared = network.compare(device, [0, 1].map(|side: usize| (&on[side].0, &on[side].1, &keys[side])));
    let solve = network.config.solve;
    let k = network.config.map.min(a.basis.k()).min(b.basis.k());
    let projected = [(a, &compared[0]), (b, &compared[1])].map(|(m, features)| {
        let projector = m.basis.eigenvectors.slice(s![.., ..k]).to_owned() * m.basis.mass.view().insert_axis(Axis(1));
        device.matmul_tn(&device.upload(projector.mapv(|v| v as f32).view()), features)
    });
    let lambda = [a, b].map(|m| {
        let weyl = m.basis.weyl_factor();
        m.basis.eigenvalues.iter().take(k).map(|l| l / weyl).collect::<Vec<f64>>()
    });
    let [c_ab, c_ba] = functional_maps(device, [&projected[0], &projected[1]], [&lambda[0], &lambda[1]], solve);
    // Side by side they come down together.
    let width = network.config.feature_columns();
    let together = device.concat(&[(&c_ab, 1.0), (&c_ba, 1.0), (&projected[0], 1.0), (&projected[1], 1.0)]);
    let down = device.download(&together).await.mapv(f64::from);
    still_well(device, Stage::FunctionalMap)?;
    let columns = |from: usize, count: usize| down.slice(s![.., from..from + count]);
    // Judged by what the network says alone: what a user knows says nothing about it.
    let mut maps = MapPair { c_ab: columns(0, k).to_owned(), c_ba: columns(k, k).to_owned() };
    let [lambda_a, lambda_b] = [ArrayView1::from(&lambda[0]), ArrayView1::from(&lambda[1])];
    let learned = |side: usize| columns(2 * k + side * width, width);
    let solve_both = |g_a: ArrayView2<f64>, g_b: ArrayView2<f64>| {
        let [c_ab, c_ba] = match solve {
            Solver::Masked => {
                [FunctionalMap::solve(g_a, g_b, lambda_a, lambda_b), FunctionalMap::solve(g_b, g_a, lambda_b, lambda_a)]
            }
            Solver::LeastSquares => [FunctionalMap::least_squares(g_a, g_b), FunctionalMap::least_squares(g_b, g_a)],
        };
        MapPair { c_ab: c_ab.matrix, c_ba: c_ba.matrix }
    };
    if !maps.is_finite() {
        // In f64 a system is positive definite that is not in f32.
        maps = solve_both(learned(0), learned(1));
        if !maps.is_finite() {
            return Err(Interrupted::NotFinite(Stage::FunctionalMap));
        }
    }
    let off = |there_and_back: Array2<f64>| (there_and_back - Array2::<f64>::eye(k)).iter().map(|v| v * v).sum::<f64>();
    let out_of_distribution = OutOfDistribution {
        bijectivity: (off(maps.c_ab.dot(&maps.c_ba)) + off(maps.c_ba.dot(&maps.c_ab))) / (2 * k) as f64,
        certainty: certainty(a, of_a).min(certainty(b, of_b)),
        thresholds: trained.category().thresholds,
    };
    let maps = match known {
        Some((known_a, known_b)) => {
            let joined =
                |side: usize, known: ArrayView2<f64>| concatenate![Axis(1), learned(side), known.slice(s![..k, ..])];
            solve_both(joined(0, known_a).view(), joined(1, known_b).view())
        }
        None => maps,
    };
    let extra = [(&compared[0], mask_a), (&compared[1], mask_b)].map(|(features, mask)| {
        let roots = device.upload(mask.mapv(f32::sqrt).view());
        device.concat(&[(features, OF_FEATURES), (&roots, OF_PARTS)])
    });
    Ok(Learned { maps, out_of_distribution, extra })
}

/// Mean probability of the likeliest part over the surface.
fn certainty(shape: &Matchable, embedding: &PointEmbedding) -> f64 {
    embedding.certainty(shape.basis.mass.iter().copied())
}
