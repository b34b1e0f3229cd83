//! Body parts: their names, how fine ones group into the paper's C = 8, and attention that keeps them apart.

mod attention;

pub(crate) use attention::PartAttention;

/// Names of the sided parts; a label is an index here. Left is the person's own left.
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

/// For each of [`PARTS`] its group among the paper's C = 8: head, torso, and left and right arm with hand, thigh, shank with foot.
pub const GROUPS: [usize; 14] = [0, 1, 2, 3, 2, 3, 2, 3, 4, 5, 6, 7, 6, 7];
