//! A scan, validated once: points, optional triangles, optional part labels.

use serde::{Deserialize, Serialize};

/// Fewest points a shape may have (below it no spectrum worth the name exists).
pub const MIN_POINTS: usize = 50;

/// A mesh (`faces` not empty) or a point cloud. Points keep the order and the number they were uploaded
/// with: index `i` here is index `i` for the user, whatever was repaired.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    points: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    labels: Option<Vec<u32>>,
    repairs: Vec<Repair>,
}

/// One kind of thing that was changed or set aside to make a shape out of an upload.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repair {
    /// Stable name: `"degenerate-faces"`, `"polygons-triangulated"`, …
    pub code: String,
    /// How many times.
    pub count: usize,
    /// A sentence for a person.
    pub message: String,
}

/// Why points, faces and labels do not make a shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// Fewer than [`MIN_POINTS`].
    #[error("the scan has {found} points; at least {needed} are needed")]
    TooFewPoints {
        /// Points in the upload.
        found: usize,
        /// [`MIN_POINTS`].
        needed: usize,
    },
}

impl ShapeError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            ShapeError::TooFewPoints { .. } => "too-few-points",
        }
    }

    /// The numbers behind the sentence.
    pub fn details(&self) -> serde_json::Value {
        match self {
            ShapeError::TooFewPoints { found, needed } => serde_json::json!({ "found": found, "needed": needed }),
        }
    }
}

impl Shape {
    /// Validates and, where that is safe, repairs. `faces` may be empty (a cloud); `labels`, if given, has one entry per point.
    pub fn new(points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, labels: Option<Vec<u32>>) -> Result<Self, ShapeError> {
        if points.len() < MIN_POINTS {
            return Err(ShapeError::TooFewPoints { found: points.len(), needed: MIN_POINTS });
        }
        Ok(Self { points, faces, labels, repairs: Vec::new() })
    }

    /// Positions (n, 3) in the unit of the upload.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Triangles (m, 3); empty for a cloud.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Part label per point, as given.
    pub fn labels(&self) -> Option<&[u32]> {
        self.labels.as_deref()
    }

    /// What was changed on the way in.
    pub fn repairs(&self) -> &[Repair] {
        &self.repairs
    }

    /// The same points without their faces.
    pub fn without_faces(mut self) -> Self {
        self.faces.clear();
        self
    }
}
