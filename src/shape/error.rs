//! Why points, faces and labels do not make a shape.

use serde_json::{Value, json};

/// Why points, faces and labels do not make a shape. Indices are 0-based, as uploaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// Fewer than 50 points.
    #[error("the scan has {found} points; at least {needed} are needed")]
    TooFewPoints {
        /// Points in the upload.
        found: usize,
        /// 50 points.
        needed: usize,
    },
    /// More than 2³¹ points.
    #[error("the scan has {found} points; at most {limit} can be indexed")]
    TooManyPoints {
        /// Points in the upload.
        found: usize,
        /// 2³¹ points.
        limit: usize,
    },
    /// A flat array that does not hold whole triples.
    #[error("{array} holds {length} numbers, which is not a multiple of 3")]
    RaggedArray {
        /// `"positions"` or `"faces"`.
        array: &'static str,
        /// Its length.
        length: usize,
    },
    /// NaN or infinity among the coordinates.
    #[error(
        "{count} of the scan's points have a coordinate that is not a finite number; the first is point {index}: leave those points out when saving"
    )]
    NotFinite {
        /// First such point.
        index: usize,
        /// How many points.
        count: usize,
    },
    /// A label array of another length than the points.
    #[error("{labels} labels were given for {points} points; there must be one per point")]
    LabelCount {
        /// Labels given.
        labels: usize,
        /// Points given.
        points: usize,
    },
    /// A coordinate beyond 10³⁰.
    #[error("point {index} has the coordinate {value:e}; beyond {limit:e} areas cannot be computed: rescale the scan")]
    CoordinateTooLarge {
        /// First such point.
        index: usize,
        /// The coordinate.
        value: f64,
        /// 10³⁰.
        limit: f64,
    },
    /// All points lie in one place (within what f64 can tell apart there).
    #[error("all {points} points of the scan lie in the same place")]
    AllEqual {
        /// Points in the upload.
        points: usize,
    },
    /// A bounding box smaller than 10⁻³⁰.
    #[error(
        "the whole scan is only {extent:e} units across; below {limit:e} areas cannot be computed: rescale the scan"
    )]
    ExtentTooSmall {
        /// Longest side of the bounding box.
        extent: f64,
        /// 10⁻³⁰.
        limit: f64,
    },
    /// All points lie on one line: there is no surface.
    #[error("all {points} points of the scan lie on one line (within {width:e} of its length); a surface is needed")]
    Collinear {
        /// Points in the upload.
        points: usize,
        /// Largest distance from the line, as a multiple of the scan's length.
        width: f64,
    },
    /// A face that names a point which is not there.
    #[error("corner {corner} of face {face} names point {index}, but the scan has {points} points (0 to {})", points - 1)]
    FaceIndex {
        /// First such face.
        face: usize,
        /// Its corner: 0, 1 or 2.
        corner: usize,
        /// The point named.
        index: u32,
        /// Points in the upload.
        points: usize,
    },
}

impl ShapeError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooFewPoints { .. } => "too-few-points",
            Self::TooManyPoints { .. } => "too-many-points",
            Self::RaggedArray { .. } => "ragged-array",
            Self::NotFinite { .. } => "not-finite",
            Self::LabelCount { .. } => "label-count",
            Self::CoordinateTooLarge { .. } => "coordinate-too-large",
            Self::AllEqual { .. } => "all-points-equal",
            Self::ExtentTooSmall { .. } => "extent-too-small",
            Self::Collinear { .. } => "collinear-points",
            Self::FaceIndex { .. } => "face-index-out-of-range",
        }
    }

    /// The numbers behind the sentence.
    pub fn details(&self) -> Value {
        match self {
            Self::TooFewPoints { found, needed } => json!({ "found": found, "needed": needed }),
            Self::TooManyPoints { found, limit } => json!({ "found": found, "limit": limit }),
            Self::RaggedArray { array, length } => json!({ "array": array, "length": length }),
            Self::NotFinite { index, count } => json!({ "index": index, "count": count }),
            Self::LabelCount { labels, points } => json!({ "labels": labels, "points": points }),
            Self::CoordinateTooLarge { index, value, limit } => {
                json!({ "index": index, "value": value, "limit": limit })
            }
            Self::AllEqual { points } => json!({ "points": points }),
            Self::ExtentTooSmall { extent, limit } => json!({ "extent": extent, "limit": limit }),
            Self::Collinear { points, width } => json!({ "points": points, "width": width }),
            Self::FaceIndex { face, corner, index, points } => {
                json!({ "face": face, "corner": corner, "index": index, "points": points })
            }
        }
    }
}
