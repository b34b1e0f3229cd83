//! What training minimises. Everything is a tensor of one value, differentiable in features and logits.
//!
//! The paper's three losses stand beside those that work (its own alone do not train: the optimum of L_geo is F = ±Φ, which matches nothing).
//! [`LossWeights`] says how much each counts.

use candle_core::{Result, Tensor};
use ndarray::{Array2, ArrayView2};

use super::device::{Autodiff, cross_entropy_rows, tensor};
use crate::device::{Device, exp};
use crate::network::Solver;

/// How much each loss counts.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LossWeights {
    /// Cross-entropy of the parts.
    pub parts: f64,
    /// ‖C_ab C_ba − I‖², both ways round.
    pub bijectivity: f64,
    /// ‖CᵀC − I‖² of both maps. Nothing by default: without it maps came out better in seven of eight comparisons (`benches/results/ablations.md`).
    pub orthogonality: f64,
    /// ‖C − Φ⁺ΠΦ‖² between the functional map and the soft point map.
    pub coupling: f64,
    /// Cross-entropy of the soft point map where samples have places.
    pub places: f64,
    /// In that, how far off on the atlas a wrong point is counts: it weighs this and its distance in √area. With 0 all wrong points weigh alike.
    pub near_weight: f64,
    /// Squared error of the logarithm of the extent, of networks that say how much of a body there is.
    pub extent: f64,
    /// L_sem (paper Sec. 3.4.2). Nothing by default: it was worth nothing that shows at equal steps (`benches/results/ablations.md`).
    pub semantic: f64,
    /// L_geo (paper Sec. 3.4.1).
    pub eigen: f64,
    /// L_orth (paper Sec. 3.4.1).
    pub features_orthogonal: f64,
    /// Temperature of the soft point map in the coupling and for places.
    pub temperature: f64,
    /// Temperature in L_sem.
    pub semantic_temperature: f64,
}

impl Default for LossWeights {
    /// The configuration that works.
    fn default() -> Self {
        Self {
            parts: 1.0,
            bijectivity: 1.0,
            orthogonality: 0.0,
            coupling: 1.0,
            places: 1.0,
            near_weight: 0.5,
            extent: 2.0,
            semantic: 0.0,
            eigen: 0.0,
            features_orthogonal: 0.0,
            temperature: 0.07,
            semantic_temperature: 0.07,
        }
    }
}

impl LossWeights {
    /// As printed: β 1 and 0.5, α 1 and 50, τ 0.1, and nothing else.
    pub fn paper() -> Self {
        Self {
            parts: 0.0,
            bijectivity: 0.0,
            orthogonality: 0.0,
            coupling: 0.0,
            places: 0.0,
            near_weight: 0.0,
            extent: 0.0,
            semantic: 0.5,
            eigen: 1.0,
            features_orthogonal: 50.0,
            temperature: 0.1,
            semantic_temperature: 0.1,
        }
    }
}

/// One shape of a pair, as losses see it.
pub struct Side<'a> {
    /// Features (n, f) of unit length.
    pub features: &'a Tensor,
    /// Part logits (n, c).
    pub logits: &'a Tensor,
    /// Part labels as one-hot rows (n, c).
    pub labels: &'a Tensor,
    /// Φ (n, k).
    pub phi: &'a Tensor,
    /// MΦ (n, k).
    pub projector: &'a Tensor,
    /// λ (k).
    pub lambda: &'a [f64],
    /// Places on the atlas (n, 3), in √area.
    pub places: Option<&'a Array2<f32>>,
}

/// A loss by name, before its weight.
pub type Terms = Vec<(&'static str, f64, Tensor)>;

/// All losses of a pair that count, functional maps being solved for as `solve` says; without `maps` only those of the parts.
pub fn losses(weights: &LossWeights, solve: Solver, a: &Side, b: &Side, maps: bool) -> Result<Terms> {
    let mut terms = Vec::new();
    if weights.parts > 0.0 {
        let both = (cross_entropy(a.logits, a.labels)? + cross_entropy(b.logits, b.labels)?)?;
        terms.push(("parts", weights.parts, both.affine(0.5, 0.0)?));
    }
    let scores = b.features.matmul(&a.features.t()?)?;
    // Rows of B against A, and of A against B.
    let sharp = |temperature: f64| -> Result<[Tensor; 2]> {
        let sharp = scores.affine(1.0 / temperature, 0.0)?;
        Ok([sharp.clone(), sharp.t()?.contiguous()?])
    };
    let at_maps = sharp(weights.temperature)?;
    let soft = |[to_a, to_b]: &[Tensor; 2]| [Autodiff.softmax_rows(to_a), Autodiff.softmax_rows(to_b)];
    let couples = maps && weights.coupling > 0.0;
    let coupled = couples.then(|| soft(&at_maps));
    if weights.semantic > 0.0 {
        let [to_a, to_b] = soft(&sharp(weights.semantic_temperature)?);
        let both = (semantic(&to_a, b.labels, a.labels)? + semantic(&to_b, a.labels, b.labels)?)?;
        terms.push(("semantic", weights.semantic, both.affine(0.5, 0.0)?));
    }
    if let (true, Some(on_a), Some(on_b)) = (weights.places > 0.0, a.places, b.places) {
        let (near, far) = nearby(on_b, on_a, weights.near_weight as f32);
        let [to_a, to_b] = [0, 1].map(|side| {
            let weighed =
                if weights.near_weight > 0.0 { (&at_maps[side] + &far[side])? } else { at_maps[side].clone() };
            cross_entropy(&weighed, &near[side])
        });
        let (to_a, to_b) = (to_a?, to_b?);
        terms.push(("places", weights.places, (to_a + to_b)?.affine(0.5, 0.0)?));
    }
    if weights.eigen > 0.0 {
        terms.push(("eigen", weights.eigen, (eigen(a)? + eigen(b)?)?.affine(0.5, 0.0)?));
    }
    if weights.features_orthogonal > 0.0 {
        let both = (features_orthogonal(a)? + features_orthogonal(b)?)?;
        terms.push(("features_orthogonal", weights.features_orthogonal, both.affine(0.5, 0.0)?));
    }
    if !maps || weights.bijectivity + weights.orthogonality + weights.coupling == 0.0 {
        return Ok(terms);
    }
    let [c_ab, c_ba] = functional_maps(a, b, solve)?;
    let k = a.lambda.len() as f64;
    let from_identity = |product: Tensor| -> Result<Tensor> {
        let identity = tensor(Array2::eye(product.dims()[0]).view());
        (product - identity)?.sqr()?.sum_all()?.affine(1.0 / k, 0.0)
    };
    if weights.bijectivity > 0.0 {
        let both = (from_identity(c_ab.matmul(&c_ba)?)? + from_identity(c_ba.matmul(&c_ab)?)?)?;
        terms.push(("bijectivity", weights.bijectivity, both));
    }
    if weights.orthogonality > 0.0 {
        let both = (from_identity(c_ab.t()?.matmul(&c_ab)?)? + from_identity(c_ba.t()?.matmul(&c_ba)?)?)?;
        terms.push(("orthogonality", weights.orthogonality, both));
    }
    if let Some([to_a, to_b]) = coupled {
        let of_points = |side: &Side, soft: &Tensor, other: &Side| -> Result<Tensor> {
            side.projector.t()?.matmul(&soft.matmul(other.phi)?)
        };
        let apart = |c: &Tensor, p: Tensor| (c - p)?.sqr()?.sum_all()?.affine(1.0 / k, 0.0);
        let both = (apart(&c_ab, of_points(b, &to_a, a)?)? + apart(&c_ba, of_points(a, &to_b, b)?)?)?;
        terms.push(("coupling", weights.coupling, both));
    }
    Ok(terms)
}

/// C_ab and C_ba from the features (paper Sec. 3.3).
pub fn functional_maps(a: &Side, b: &Side, solve: Solver) -> Result<[Tensor; 2]> {
    let project = |side: &Side| side.projector.t()?.matmul(side.features);
    Ok(crate::maps::functional_maps(&Autodiff, [&project(a)?, &project(b)?], [a.lambda, b.lambda], solve))
}

/// Mean of −Σ y ln p over the rows of `labels`, which are one-hot, shares that sum to 1, or nothing where nothing is known.
pub fn cross_entropy(logits: &Tensor, labels: &Tensor) -> Result<Tensor> {
    cross_entropy_rows(logits, labels)?.mean_all()
}

/// How wide a place is, in √area: twice as far as places are off on average.
const BLUR: f32 = 0.03;

/// Where on the atlas row i of `from` and row j of `to` lie near each other: shares of a Gaussian as wide as [`BLUR`], rows summing to 1, or of nothing where
/// all of the other is far, as where a piece is missing. Beside them the logarithms of what each weighs as a wrong answer, its distance and `least`.
/// Both with a row for each of `from`, and with one for each of `to`.
fn nearby(from: &Array2<f32>, to: &Array2<f32>, least: f32) -> ([Tensor; 2], [Tensor; 2]) {
    let to: Vec<[f32; 3]> = to.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    let mut apart = Array2::zeros((from.nrows(), to.len()));
    for (mut row, from) in apart.rows_mut().into_iter().zip(from.rows()) {
        for (apart, to) in row.iter_mut().zip(&to) {
            *apart = (0..3).map(|axis| (from[axis] - to[axis]).powi(2)).sum::<f32>();
        }
    }
    let near = apart.mapv(|apart| exp(-apart / (2.0 * BLUR * BLUR)));
    let far = if least > 0.0 { apart.mapv(|apart| (apart.sqrt() + least).ln()) } else { Array2::zeros((0, 0)) };
    let shares = |of: ArrayView2<f32>| {
        let mut shares = of.as_standard_layout().into_owned();
        for mut row in shares.rows_mut() {
            let sum = row.sum();
            // One point three widths away.
            if sum > 0.01 { row /= sum } else { row.fill(0.0) }
        }
        tensor(shares.view())
    };
    ([shares(near.view()), shares(near.t())], [tensor(far.view()), tensor(far.t())])
}

/// L_sem: how much of each row's soft match goes to points of other parts. `soft` (n, m) has a row per point that is matched; the paper's C is this with
/// B's points as rows, and its indices i and j the other way round. Taken in both directions, over rows of parts that the other shape has.
fn semantic(soft: &Tensor, of_rows: &Tensor, of_columns: &Tensor) -> Result<Tensor> {
    // Σ_j C_ij [y_i = y_j] as (C Y) ⊙ Y, so that no (n, m) mask is made.
    let same = (soft.matmul(of_columns)? * of_rows)?.sum_all()?;
    let present = of_columns.max_keepdim(0)?;
    let possible = of_rows.broadcast_mul(&present)?.sum_all()?.to_scalar::<f32>()?;
    same.affine(-1.0 / f64::from(possible.max(1.0)), 1.0)
}

/// L_geo, with the columns of F as its "eigenvector-aligned embeddings": the i-th column should be an eigenfunction of the i-th eigenvalue. Written on
/// coefficients, where L is diagonal: Σ_i ω_i Σ_j (λ_j − λ_i)² G_ji², ω_i = exp(−i/10). What F holds outside the basis is not seen.
fn eigen(side: &Side) -> Result<Tensor> {
    let g = leading_features(side)?;
    let weight = Array2::from_shape_fn(g.dims2()?, |(j, i)| {
        let apart = side.lambda[j] - side.lambda[i];
        ((-(i as f64) / 10.0).exp() * apart * apart) as f32
    });
    (g.sqr()? * tensor(weight.view()))?.sum_all()
}

/// L_orth: the first k columns of √f F orthonormal under the mass, column i weighing 1/i.
fn features_orthogonal(side: &Side) -> Result<Tensor> {
    let g = leading_features(side)?;
    let columns = g.dims()[1];
    let gram = g.t()?.matmul(&g)?;
    let weight = Array2::from_shape_fn((columns, columns), |(i, _)| 1.0 / (i + 1) as f32);
    let apart = (gram - tensor(Array2::eye(columns).view()))?.sqr()?;
    (apart * tensor(weight.view()))?.sum_all()
}

/// Coefficients (k, ≤ k) of the leading columns of √f F, G for L_geo and L_orth. Not so in the paper: rows of our F are of unit length and masses sum to 1, so
/// tr FᵀMF = 1, and no two columns of F could be orthonormal. Entries of √f F have mean square 1, like those of eigenfunctions.
fn leading_features(side: &Side) -> Result<Tensor> {
    let coefficients = side.projector.t()?.matmul(side.features)?;
    let (k, f) = coefficients.dims2()?;
    coefficients.narrow(1, 0, f.min(k))?.affine((f as f64).sqrt(), 0.0)
}

/// Labels as one-hot rows.
pub fn one_hot(labels: &[u32], parts: usize) -> Array2<f32> {
    let mut rows = Array2::zeros((labels.len(), parts));
    labels.iter().enumerate().for_each(|(i, &label)| rows[(i, label as usize)] = 1.0);
    rows
}

/// Share of rows whose largest logit is at their label.
pub fn part_accuracy(logits: ArrayView2<f32>, labels: &[u32]) -> f64 {
    let right = logits.rows().into_iter().zip(labels).filter(|(row, label)| {
        let best = (0..row.len()).max_by(|&i, &j| row[i].total_cmp(&row[j]));
        best == Some(**label as usize)
    });
    right.count() as f64 / labels.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::{Side, eigen, features_orthogonal, nearby, tensor};
    use crate::train::device::matrix;

    #[test]
    fn a_wrong_point_weighs_by_how_far_off_it_is() {
        let on_a_line =
            |at: &[f32]| Array2::from_shape_fn((at.len(), 3), |(i, axis)| if axis == 0 { at[i] } else { 0.0 });
        let (near, far) = nearby(&on_a_line(&[0.0, 0.3]), &on_a_line(&[0.0, 0.3, 1.5]), 0.5);
        let [near, far] = [near, far].map(|both| both.map(|of| matrix(&of)));
        // Nobody is at 1.5.
        assert!((near[0][(0, 0)] - 1.0).abs() < 1e-6 && near[1].row(2).sum() == 0.0);
        let weights = far[0].row(0).mapv(f32::exp);
        assert!(weights.iter().zip([0.5, 0.8, 2.0]).all(|(w, right)| (w - right).abs() < 1e-6), "{weights}");
        assert_eq!(far[0].t(), far[1]);
    }

    #[test]
    fn features_of_unit_length_can_be_eigenfunctions() {
        // Four points of a quarter of the mass each, eigenfunctions Φ = 2 I.
        let [features, phi, projector] = [1.0, 2.0, 0.5].map(|scale| tensor((Array2::eye(4) * scale).view()));
        let lambda = [0.0, 1.0, 2.0, 3.0];
        let side = Side {
            features: &features,
            logits: &features,
            labels: &features,
            phi: &phi,
            projector: &projector,
            lambda: &lambda,
            places: None,
        };
        for loss in [eigen(&side), features_orthogonal(&side)] {
            assert_eq!(loss.and_then(|loss| loss.to_scalar::<f32>()).expect("a number"), 0.0);
        }
    }
}
