//! What a user should know before trusting a match, in sentences.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView1};

use crate::fmap::{Correspondence, Familiarity, UNMATCHED};
use crate::prepared::PreparedShape;

/// Why to doubt a match of geometric descriptors alone.
pub(crate) const UNTRAINED: &str = "matched without a trained network: where the poses differ, limbs or the whole body may be matched the wrong way round, also at high confidence";

/// What the shapes themselves give reason to doubt.
pub(crate) fn warnings(a: &PreparedShape, b: &PreparedShape) -> Vec<String> {
    let mut warnings = Vec::new();
    for (scan, shape) in [("A", a), ("B", b)] {
        if shape.info.pieces > 1 {
            let pieces = shape.info.pieces;
            warnings.push(format!(
                "scan {scan} is in {pieces} pieces; how they hang together is not known: a floor or a second body among them should be cut off"
            ));
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
            "unsure: at least one of the scans is not one whole person, and such people are all that the network knows; a map made without it keeps lengths better and was taken; arms, legs or the whole body may be matched the wrong way round"
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
            "the map changes lengths by a factor of {stretch:.1} in the median: the scans may show different kinds of bodies, or one of them only a part, or be noisy"
        ));
    }
    if median(confidence).is_some_and(|median| median < UNSURE) {
        doubts.push(
            "most points are more likely matched wrongly than rightly: the map is hardly to be trusted".to_owned(),
        );
    }
    doubts
}

/// Landmarks that the map puts farther from their partners than this, in √area of the other body, are not followed.
const AWAY: f64 = 0.1;

/// What landmarks give reason to doubt: those that the map around them (both ways, as it is before they are set) does not follow, or only by straining where
/// it does not strain elsewhere.
pub(crate) fn contradicted(
    landmarks: &[[u32; 2]],
    [a, b]: [&PreparedShape; 2],
    [a_to_b, b_to_a]: [&Correspondence; 2],
) -> Option<String> {
    let strained = [a_to_b, b_to_a].map(|map| median(&map.confidence).is_some_and(|median| median >= UNSURE));
    let against = |to: &PreparedShape, map: &Correspondence, sure: bool, from: u32, wanted: u32| {
        let (found, point) = (map.target[from as usize], |index: u32| to.shape.points()[index as usize]);
        if found == UNMATCHED {
            return false;
        }
        let [p, q] = [point(found), point(wanted)];
        let apart = (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt();
        apart > AWAY * to.info.scale || sure && map.confidence[from as usize] < UNSURE
    };
    let wrong = landmarks
        .iter()
        .enumerate()
        .filter(|&(_, &[i, j])| against(b, a_to_b, strained[0], i, j) || against(a, b_to_a, strained[1], j, i));
    let wrong: Vec<String> = wrong.map(|(index, [i, j])| format!("{index} ({i} and {j})")).collect();
    (!wrong.is_empty()).then(|| {
        format!(
            "the map does not agree with landmark {}: check these indices; where they are right, name more points nearby",
            wrong.join(", ")
        )
    })
}

/// Total variation between what a label means on two bodies from which the labels are not of one kind.
const OTHER: f32 = 0.4;

/// Whether given labels name other parts on one body than on the other, by the parts (p, c) that the network predicts at the points with those labels.
pub(crate) fn labelled_otherwise(labels: [&[u32]; 2], predicted: [&Array2<f32>; 2]) -> Option<String> {
    let [on_a, on_b] = [0, 1].map(|side| meanings(labels[side], predicted[side]));
    let (mut apart, mut count) = (0.0, 0.0);
    for (label, (meaning, on_this)) in &on_a {
        let Some((other, on_that)) = on_b.get(label) else { continue };
        let points = on_this + on_that;
        let variation = 0.5 * meaning.iter().zip(other).map(|(p, q)| (p - q).abs()).sum::<f32>();
        (apart, count) = (apart + points * variation, count + points);
    }
    (apart > OTHER * count).then(|| {
        "the labels that were given name other parts on A than on B, as far as the network can tell: are both scans labelled alike?".to_owned()
    })
}

/// For every label the mean probabilities of parts at its points, and how many these are.
fn meanings(labels: &[u32], predicted: &Array2<f32>) -> BTreeMap<u32, (Vec<f32>, f32)> {
    let mut meanings = BTreeMap::new();
    for (label, row) in labels.iter().zip(predicted.rows()) {
        let (sum, count) = meanings.entry(*label).or_insert_with(|| (vec![0.0; row.len()], 0.0));
        add(sum, row);
        *count += 1.0;
    }
    meanings.values_mut().for_each(|(sum, count)| sum.iter_mut().for_each(|p| *p /= *count));
    meanings
}

fn add(sum: &mut [f32], row: ArrayView1<f32>) {
    sum.iter_mut().zip(row).for_each(|(sum, p)| *sum += p);
}

fn median(values: &[f32]) -> Option<f32> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}
