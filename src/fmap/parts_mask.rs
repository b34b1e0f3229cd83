//! Given part labels as a hard mask (paper Sec. 3.3, at the level of the map).

use std::collections::BTreeSet;

use ndarray::Array2;

/// One column per label that both shapes have: 1 where a point carries it. Shapes (n_a, labels), (n_b, labels).
///
/// Beside an embedding with a weight far above its own distances, equal labels cost nothing and unequal ones more than any other
/// difference. A label that only one shape has is no constraint.
pub fn one_hot_parts(labels_a: &[u32], labels_b: &[u32]) -> (Array2<f32>, Array2<f32>) {
    let in_a: BTreeSet<u32> = labels_a.iter().copied().collect();
    let shared: Vec<u32> = labels_b.iter().copied().collect::<BTreeSet<u32>>().intersection(&in_a).copied().collect();
    let table = |labels: &[u32]| {
        Array2::from_shape_fn((labels.len(), shared.len()), |(i, c)| if labels[i] == shared[c] { 1.0 } else { 0.0 })
    };
    (table(labels_a), table(labels_b))
}
