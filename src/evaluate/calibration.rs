//! Whether confidence means what it says: that of points matched rightly against that of points matched wrongly.

/// Error, in √area, up to which a match is right.
pub(super) const RIGHT: f64 = 0.05;
/// Bins of equal width that confidence is compared with the share of right matches in.
const BINS: usize = 10;

/// What was said of a point and what it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Judged {
    /// In [0, 1].
    pub(super) confidence: f32,
    /// Whether its error is at most [`RIGHT`].
    pub(super) right: bool,
}

/// Area under the receiver operating characteristic: the probability that a right match is given more confidence than a wrong one, equal
/// confidence counting half (Hanley & McNeil 1982). Nothing where all are right, or all wrong.
pub(super) fn area_under_curve(judged: &[Judged]) -> Option<f64> {
    let right = judged.iter().filter(|j| j.right).count();
    let wrong = judged.len() - right;
    if right == 0 || wrong == 0 {
        return None;
    }
    let mut sorted = judged.to_vec();
    sorted.sort_unstable_by(|x, y| x.confidence.total_cmp(&y.confidence));
    let (mut below, mut won) = (0, 0.0);
    for equal in sorted.chunk_by(|x, y| x.confidence == y.confidence) {
        let here = equal.iter().filter(|j| j.right).count();
        won += here as f64 * (below as f64 + 0.5 * (equal.len() - here) as f64);
        below += equal.len() - here;
    }
    Some(won / (right as f64 * wrong as f64))
}

/// Expected calibration error: mean confidence against the share of right matches, bin by bin, each counting as many times as it has points
/// (Guo et al. 2017). Nothing without points.
pub(super) fn calibration_error(judged: &[Judged]) -> Option<f64> {
    let mut surplus = [0.0; BINS];
    for Judged { confidence, right } in judged {
        let bin = ((f64::from(*confidence) * BINS as f64) as usize).min(BINS - 1);
        surplus[bin] += f64::from(*confidence) - f64::from(u8::from(*right));
    }
    (!judged.is_empty()).then(|| surplus.iter().map(|s| s.abs()).sum::<f64>() / judged.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(points: &[(f32, bool)]) -> Vec<Judged> {
        points.iter().map(|&(confidence, right)| Judged { confidence, right }).collect()
    }

    #[test]
    fn the_area_counts_pairs_in_the_right_order() {
        let apart = judged(&[(0.1, false), (0.9, true), (0.8, true), (0.2, false)]);
        assert_eq!(area_under_curve(&apart), Some(1.0));
        // Of six pairs of a right and a wrong one, four are in order and one is equal.
        let mixed = judged(&[(0.1, false), (0.5, true), (0.5, false), (0.9, true), (0.3, true)]);
        assert_eq!(area_under_curve(&mixed), Some(4.5 / 6.0));
        assert_eq!(area_under_curve(&judged(&[(0.4, true); 3])), None);
        assert_eq!(area_under_curve(&judged(&[(0.4, false); 3])), None);
        assert_eq!(area_under_curve(&judged(&[(0.4, false), (0.4, true)])), Some(0.5));
    }

    #[test]
    fn confidence_is_calibrated_when_it_is_how_often_a_match_is_right() {
        let mut three_in_four = vec![(0.75, true); 3];
        three_in_four.push((0.75, false));
        assert_eq!(calibration_error(&judged(&three_in_four)), Some(0.0));
        // One bin too sure by a half, one not sure enough by a quarter; each has half of the points.
        let both = judged(&[(1.0, true), (1.0, false), (0.25, true), (0.25, false)]);
        assert_eq!(calibration_error(&both), Some(0.5 * 0.5 + 0.5 * 0.25));
        // Bins do not make up for each other.
        assert_eq!(calibration_error(&judged(&[(1.0, false), (0.0, true)])), Some(1.0));
        assert_eq!(calibration_error(&[]), None);
    }
}
