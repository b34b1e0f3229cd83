//! Body parts: their names, and attention that keeps them apart.

mod attention;

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
