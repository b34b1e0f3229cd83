//! The first pair of maps from what the network learned (paper Sec. 3.3): attention between the shapes, then the functional-map solve both ways.

use ndarray::{Array2, ArrayView1, ArrayView2, Axis, concatenate, s};

use super::Matchable;
use super::functional_map::{FunctionalMap, functional_maps};
use super::refine::MapPair;
use crate::device::Device;
use crate::features::weyl_factor;
use crate::model::{Model, Network, PointEmbedding};

/// Basis size of the first maps, as in training.
const FIRST: usize = 60;
/// Key points that a point of the other shape looks at.
const KEYS: usize = 1024;
/// Weights of features of unit length and of roots of probabilities beside spectral columns and positions.
const FEATURES: f32 = 0.7;
const PARTS: f32 = 0.5;

/// How much at home the network is with a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Familiarity {
    /// ‖C_ab C_ba − I‖²/k, mean of both ways round: what the maps there and back leave of functions. Two people give 0.02 to 0.1, whatever their poses;
    /// pairs of animals, a person and an animal, and furniture 0.3 and more (measured on bodies of the generator's held-out seeds, on the CC0
    /// quadrupeds and on a sphere, torus, chair, car and noise).
    pub bijectivity: f64,
    /// Mean probability of the likeliest part, of the shape where it is smaller: people 0.96, animals 0.66 to 0.86.
    pub certainty: f64,
}

impl Familiarity {
    /// Above this the maps there and back do not belong together.
    const STRANGE: f64 = 0.2;
    /// Below this a shape has not the parts of a person.
    const UNCERTAIN: f64 = 0.88;

    /// Whether the pair is unlike what the network was trained on.
    pub fn is_strange(&self) -> bool {
        self.bijectivity.is_nan() || self.bijectivity > Self::STRANGE
    }

    /// Whether the shapes are no people, so that a map that knows nothing of people may be better.
    pub fn is_of_others(&self) -> bool {
        self.certainty.is_nan() || self.certainty < Self::UNCERTAIN
    }
}

/// C_ab and C_ba at k = 60, and how far they can be trusted. Leaves features and `masks` as further columns with both sides. `masks` are probabilities of parts (p, c) that
/// attention masks with; `known` (k, l) are coefficients of functions known to correspond.
pub async fn learned_maps<D: Device>(
    device: &D,
    model: &Model,
    [(a, of_a), (b, of_b)]: [(&mut Matchable, &PointEmbedding); 2],
    [mask_a, mask_b]: [Array2<f32>; 2],
    known: Option<(ArrayView2<'_, f64>, ArrayView2<'_, f64>)>,
) -> (MapPair, Familiarity) {
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
    let projected = [(&*a, &compared[0]), (&*b, &compared[1])].map(|(m, features)| {
        let projector = m.basis.eigenvectors.slice(s![.., ..k]).to_owned() * m.basis.mass.view().insert_axis(Axis(1));
        device.matmul_tn(&device.upload(projector.mapv(|v| v as f32).view()), features)
    });
    let lambda = [&*a, &*b].map(|m| {
        let weyl = weyl_factor(&m.basis);
        m.basis.eigenvalues.iter().take(k).map(|l| l / weyl).collect::<Vec<f64>>()
    });
    let [c_ab, c_ba] = functional_maps(device, [&projected[0], &projected[1]], [&lambda[0], &lambda[1]]);
    // Judged by what the network says alone: what a user knows says nothing about it.
    let maps = MapPair {
        c_ab: device.download(&c_ab).await.mapv(f64::from),
        c_ba: device.download(&c_ba).await.mapv(f64::from),
    };
    let off = |there_and_back: Array2<f64>| (there_and_back - Array2::<f64>::eye(k)).iter().map(|v| v * v).sum::<f64>();
    let familiarity = Familiarity {
        bijectivity: (off(maps.c_ab.dot(&maps.c_ba)) + off(maps.c_ba.dot(&maps.c_ab))) / (2 * k) as f64,
        certainty: certainty(&*a, of_a).min(certainty(&*b, of_b)),
    };
    let maps = match known {
        Some((known_a, known_b)) => {
            let mut joined = Vec::new();
            for (learned, known) in projected.iter().zip([known_a, known_b]) {
                let learned = device.download(learned).await.mapv(f64::from);
                joined.push(concatenate![Axis(1), learned, known.slice(s![..k, ..])]);
            }
            let [g_a, g_b] = [joined[0].view(), joined[1].view()];
            let [lambda_a, lambda_b] = [ArrayView1::from(&lambda[0]), ArrayView1::from(&lambda[1])];
            MapPair {
                c_ab: FunctionalMap::solve(g_a, g_b, lambda_a, lambda_b).matrix,
                c_ba: FunctionalMap::solve(g_b, g_a, lambda_b, lambda_a).matrix,
            }
        }
        None => maps,
    };
    let [features_a, features_b] = compared;
    for (m, mask, features) in [(a, mask_a, features_a), (b, mask_b, features_b)] {
        let features = device.download(&features).await * FEATURES;
        m.extra = Some(concatenate![Axis(1), features, mask.mapv(|p| PARTS * p.sqrt())]);
    }
    (maps, familiarity)
}

/// Mean probability of the likeliest part over the surface.
fn certainty(shape: &Matchable, embedding: &PointEmbedding) -> f64 {
    let likeliest = |row: ArrayView1<f32>| f64::from(row.iter().copied().fold(0.0, f32::max));
    embedding.parts.rows().into_iter().zip(&shape.basis.mass).map(|(row, mass)| likeliest(row) * mass).sum()
}
