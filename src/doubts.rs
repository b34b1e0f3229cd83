//! What a user should know before trusting a match, in sentences.

use crate::fmap::Familiarity;
use crate::prepared::PreparedShape;

/// Why to doubt a match of geometric descriptors alone.
pub(crate) const UNTRAINED: &str = "matched without a trained network: where the poses differ, limbs or the whole body may be matched the wrong way round, also at high confidence";

/// What the shapes themselves give reason to doubt.
pub(crate) fn warnings(a: &PreparedShape, b: &PreparedShape) -> Vec<String> {
    let mut warnings = Vec::new();
    for (scan, shape) in [("A", a), ("B", b)] {
        if shape.info.pieces > 1 {
            let pieces = shape.info.pieces;
            warnings.push(format!("scan {scan} is in {pieces} pieces; how they hang together is not known"));
        }
    }
    if a.info.eigenpairs != b.info.eigenpairs {
        warnings.push(format!(
            "the scans have {} and {} eigenpairs; the smaller number is used",
            a.info.eigenpairs, b.info.eigenpairs
        ));
    }
    warnings
}

/// What it means when the pair is unlike those the network was trained on; `without` says that another map than the network's was taken.
pub(crate) fn verdict(familiarity: Familiarity, without: bool) -> Option<String> {
    let unsure = match (without, familiarity.is_of_others() || familiarity.is_strange()) {
        (true, _) => {
            "unsure: these are not two people, and people are all that the network knows; a map made without it keeps lengths better and was taken; arms, legs or the whole body may be matched the wrong way round"
        }
        (false, true) => {
            "unsure: the pair is unlike those that the network was trained on (whole people): look at the map before you trust it"
        }
        _ => return None,
    };
    Some(unsure.to_owned())
}

/// A map that changes lengths more than this, in the median, is no map between two poses of one kind of body.
const STRETCHED: f64 = 1.2;
/// Median confidence below which most points are more likely wrong than right.
const UNSURE: f32 = 0.5;

/// What the map gives reason to doubt.
pub(crate) fn doubts(stretch: f64, confidence: &[f32]) -> Vec<String> {
    let mut doubts = Vec::new();
    if stretch > STRETCHED {
        doubts.push(format!(
            "the map changes lengths by a factor of {stretch:.1} in the median: the scans may show different kinds of bodies, or one of them only a part"
        ));
    }
    let mut sorted = confidence.to_vec();
    sorted.sort_by(f32::total_cmp);
    if sorted.get(sorted.len() / 2).is_some_and(|&median| median < UNSURE) {
        doubts.push(
            "most points are more likely matched wrongly than rightly: the map is hardly to be trusted".to_owned(),
        );
    }
    doubts
}
