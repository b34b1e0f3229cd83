//! Body parts: their names, and attention that keeps them apart.

mod attention;

use ndarray::ArrayView1;

pub(crate) use attention::PartAttention;

/// Names of the sided parts; a label is an index here. Left is the person's own left. The paper has C = 8 and does not say which; these are finer, and sets
/// with other classes are compared after merging by name.
pub const PARTS: [&str; 14] = [
    "head",
    "torso",
    "left upper arm",
    "right upper arm",
    "left forearm",
    "right forearm",
    "left hand",
    "right hand",
    "left thigh",
    "right thigh",
    "left shank",
    "right shank",
    "left foot",
    "right foot",
];

/// Parts that meet on a person, besides each with itself.
const MEETING: [[usize; 2]; 13] =
    [[0, 1], [1, 2], [1, 3], [1, 8], [1, 9], [2, 4], [3, 5], [4, 6], [5, 7], [8, 10], [9, 11], [10, 12], [11, 13]];

/// Probability that two points belong to one part or to parts that meet, by their probabilities (14) of parts.
pub(crate) fn meeting(p: ArrayView1<f32>, q: ArrayView1<f32>) -> f32 {
    let same: f32 = p.dot(&q);
    same + MEETING.iter().map(|&[i, j]| p[i] * q[j] + p[j] * q[i]).sum::<f32>()
}
