//! How a match looks to who uses it: whether it ends on the right part, and whether it is sure of itself where it is wrong.

use std::collections::BTreeSet;

use super::interval::mean;
use super::report::{GivenParts, PairParts};
use crate::maps::UNMATCHED;

/// What counts as far off, in the unit of the set: a hand's width where that is the metre.
pub(super) const FAR_OFF: f64 = 0.1;
/// A match whose mean confidence is above this is taken for right by who reads it.
const CONFIDENT: f64 = 0.6;
/// With more than this share of its lines far off it is wrong.
const WRONG: f64 = 0.2;

/// The share of A's points that `found` takes to a point of B with the same part; unmatched points are not. Points of a part that B lacks (a floor, a
/// missing hand) have no right answer and do not count.
pub(super) fn same_part(found: &[u32], of_a: &[u32], of_b: &[u32]) -> Option<f64> {
    let on_b: BTreeSet<u32> = of_b.iter().copied().collect();
    let asked = found.iter().zip(of_a).filter(|(_, part)| on_b.contains(part));
    let same = |(&target, part): (&u32, &u32)| target != UNMATCHED && of_b[target as usize] == *part;
    mean(asked.map(|point| f64::from(u8::from(same(point)))))
}

/// Over all pairs that have them.
pub(super) fn given_parts(pairs: impl Iterator<Item = PairParts>) -> Option<GivenParts> {
    let pairs: Vec<PairParts> = pairs.collect();
    Some(GivenParts {
        same_part: mean(pairs.iter().map(|pair| pair.same_part))?,
        confident_wrong: pairs.iter().filter(|pair| is_confident_and_wrong(pair)).count(),
    })
}

/// Whether a pair is confident and wrong.
fn is_confident_and_wrong(pair: &PairParts) -> bool {
    pair.far_off > WRONG && pair.mean_confidence.is_some_and(|confidence| confidence > CONFIDENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unmatched_points_are_wrong_and_parts_that_are_not_there_are_not_asked_for() {
        let of_b = [0, 0, 1];
        assert_eq!(same_part(&[0, 2, UNMATCHED, 1], &[0, 0, 1, 1], &of_b), Some(0.25));
        // Part 7 is not on B.
        assert_eq!(same_part(&[0, 2, 1], &[0, 1, 7], &of_b), Some(1.0));
        assert_eq!(same_part(&[0], &[7], &of_b), None);
    }

    #[test]
    fn doubt_excuses_what_is_wrong() {
        let pair = |mean_confidence, far_off| PairParts { same_part: 0.5, mean_confidence, far_off };
        let pairs = [pair(Some(0.9), 0.3), pair(Some(0.5), 0.3), pair(Some(0.9), 0.1), pair(None, 0.9)];
        let all = given_parts(pairs.into_iter()).expect("pairs");
        assert_eq!((all.confident_wrong, all.same_part), (1, 0.5));
        assert!(given_parts(std::iter::empty()).is_none());
    }
}
