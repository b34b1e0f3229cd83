//! Whether a match of pieces tells which points have a partner.

use serde::Serialize;

use super::interval::mean;
use crate::maps::UNMATCHED;

/// What is said of the template points on A, of which some are on B too, and have a partner, and the others are alone. A point is said to be alone when
/// its target is [`UNMATCHED`]. Mean over the pairs that have such points; `None` where none has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Overlap {
    /// Intersection over union of the points said to have a partner and those that have one.
    pub iou: Option<f64>,
    /// The share of points alone that are said to be.
    pub alone_said_alone: Option<f64>,
    /// The share of points with a partner that are said to be alone.
    pub paired_said_alone: Option<f64>,
}

impl Overlap {
    /// Of one pair: `points` are (point of A, whether it has a partner), and `found` is a point of B, or [`UNMATCHED`], per point of A.
    pub(super) fn of(points: &[(u32, bool)], found: &[u32]) -> Self {
        // By whether points have a partner and whether they are said to be alone.
        let mut count = [[0usize; 2]; 2];
        for &(i, paired) in points {
            count[usize::from(paired)][usize::from(found[i as usize] == UNMATCHED)] += 1;
        }
        let [[alone_said_paired, alone_said_alone], [paired_said_paired, paired_said_alone]] = count;
        let share = |part: usize, whole: usize| (whole > 0).then(|| part as f64 / whole as f64);
        Self {
            iou: share(paired_said_paired, paired_said_paired + paired_said_alone + alone_said_paired),
            alone_said_alone: share(alone_said_alone, alone_said_alone + alone_said_paired),
            paired_said_alone: share(paired_said_alone, paired_said_alone + paired_said_paired),
        }
    }

    /// Over pairs.
    pub(super) fn mean(pairs: &[Self]) -> Self {
        let over = |score: fn(&Self) -> Option<f64>| mean(pairs.iter().filter_map(score));
        Self {
            iou: over(|pair| pair.iou),
            alone_said_alone: over(|pair| pair.alone_said_alone),
            paired_said_alone: over(|pair| pair.paired_said_alone),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_is_that_worked_out_by_hand() {
        // Five points with a partner, one of them said to be alone; three alone, two of them said to be. Point 0 is two template points.
        let points = [(0, true), (0, true), (1, true), (2, true), (3, true), (4, false), (5, false), (6, false)];
        let found = [9, 9, UNMATCHED, 9, UNMATCHED, UNMATCHED, 9];
        let one = Overlap::of(&points, &found);
        let shares = |iou, alone, paired| Overlap { iou, alone_said_alone: alone, paired_said_alone: paired };
        assert_eq!(one, shares(Some(4.0 / 6.0), Some(2.0 / 3.0), Some(1.0 / 5.0)));
        // A piece of a whole has no point alone.
        let whole = Overlap::of(&points[..5], &[9; 7]);
        assert_eq!(whole, shares(Some(1.0), None, Some(0.0)));
        // Nothing has a partner, and nothing is said to have one.
        let apart = Overlap::of(&points[5..], &[UNMATCHED; 7]);
        assert_eq!(apart, shares(None, Some(1.0), None));
        let mean = Overlap::mean(&[one, whole, apart]);
        let [iou, alone] = [(4.0 / 6.0 + 1.0) / 2.0, (2.0 / 3.0 + 1.0) / 2.0];
        assert_eq!(mean, shares(Some(iou), Some(alone), Some(0.1)));
        assert_eq!(Overlap::mean(&[]), shares(None, None, None));
    }
}
