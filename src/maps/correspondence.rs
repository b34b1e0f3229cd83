//! Which point is which, and how sure that is.

/// Target of a point that has none.
pub const UNMATCHED: u32 = u32::MAX;

/// For each point of one shape its point on the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Correspondence {
    /// Index on the other shape, or [`UNMATCHED`].
    pub target: Vec<u32>,
    /// Probability that the target is within 0.05 √area of the right one along the surface, about a hand's width on a person; 0 where unmatched.
    pub confidence: Vec<f32>,
}

impl Correspondence {
    /// Says what somebody knows: point `i` belongs to `target`.
    pub fn set(&mut self, i: u32, target: u32) {
        self.target[i as usize] = target;
        self.confidence[i as usize] = 1.0;
    }
}
