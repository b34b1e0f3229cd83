//! A scan as its file says it.

use crate::shape::Repair;

/// What a file says, before it is validated as a shape.
#[derive(Debug, Default)]
pub(super) struct Draft {
    pub points: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    pub labels: Option<Vec<u32>>,
    pub repairs: Vec<Repair>,
}
