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
const CYCLE_SCALE: f64 = 0.05;

impl Correspondence {
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

    /// From the points used to every uploaded point: `nearest` gives each uploaded point's row here, `samples` the uploaded index of each
    /// row of the other shape; `None` where all points are used.
    pub fn lift(&self, nearest: Option<&[u32]>, samples: Option<&[u32]>) -> Self {
        let uploaded = |row: u32| samples.map_or(row, |samples| samples[row as usize]);
        match nearest {
            None => Self {
                target: self.target.iter().map(|&row| uploaded(row)).collect(),
                confidence: self.confidence.clone(),
            },
            Some(nearest) => Self {
                target: nearest.iter().map(|&row| uploaded(self.target[row as usize])).collect(),
                confidence: nearest.iter().map(|&row| self.confidence[row as usize]).collect(),
            },
        }
    }
}
