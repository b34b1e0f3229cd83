//! Which point is which, and how sure that is.

use super::Matchable;

/// Target of a point that has none.
pub const UNMATCHED: u32 = u32::MAX;

/// For each point of one shape its point on the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Correspondence {
    /// Index on the other shape, or [`UNMATCHED`].
    pub target: Vec<u32>,
    /// In [0, 1]; 0 where unmatched.
    pub confidence: Vec<f32>,
}

/// Distance at which going there and back again costs e^−½ of the confidence, in √area: about a hand's width on a person.
pub(super) const CYCLE_SCALE: f64 = 0.05;

impl Correspondence {
    /// Says what somebody knows: point `i` belongs to `target`.
    pub fn set(&mut self, i: u32, target: u32) {
        self.target[i as usize] = target;
        self.confidence[i as usize] = 1.0;
    }

    /// The match `there` from the points of `from`, with confidence exp(−d²/2s²), d being how far from its start a point ends that goes `there` and comes
    /// `back`.
    pub(super) fn between(from: &Matchable, there: &[u32], back: &[u32]) -> Self {
        let confidence = there
            .iter()
            .enumerate()
            .map(|(i, &j)| {
                let returned = from.points.row(back[j as usize] as usize);
                let squared: f64 = returned.iter().zip(from.points.row(i)).map(|(x, y)| (x - y).powi(2)).sum();
                (-squared / (2.0 * CYCLE_SCALE * CYCLE_SCALE)).exp() as f32
            })
            .collect();
        Self { target: there.to_vec(), confidence }
    }
}
