//! What a user should know before trusting a match, in sentences.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView1};
use serde::{Deserialize, Serialize};

use super::PreparedShape;
use super::hypotheses::Home;
use crate::maps::{Correspondence, UNMATCHED};
use crate::network::PointEmbedding;

/// Something to know before trusting a match.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Warning {
    /// Stable name: `"out-of-distribution"`, `"several-pieces"`, …
    pub code: String,
    /// A sentence for a person.
    pub message: String,
}

impl Warning {
    fn new(code: &str, message: impl Into<String>) -> Self {
        Self { code: code.to_owned(), message: message.into() }
    }
}

/// Of a match of geometric descriptors alone.
pub(crate) fn without_network() -> Warning {
    let message = "matched without a trained network: where the poses differ, limbs or the whole body may be matched the wrong way round, also at high confidence";
    Warning::new("no-network", message)
}

/// What the shapes themselves give reason to say.
pub(crate) fn of_shapes(a: &PreparedShape, b: &PreparedShape) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (scan, shape) in [("A", a), ("B", b)] {
        // One view of a body often is in fragments.
        if shape.info.pieces > 1 && shape.info.share == 1.0 {
            let message = format!(
                "scan {scan} is in {} pieces with gaps between them, and how they hang together is not known: close the gaps, or cut off what is no part of the body",
                shape.info.pieces
            );
            warnings.push(Warning::new("several-pieces", message));
        }
    }
    if a.info.eigenpairs != b.info.eigenpairs {
        let message = format!(
            "the scans have {} and {} eigenpairs; the smaller number is used",
            a.info.eigenpairs, b.info.eigenpairs
        );
        warnings.push(Warning::new("eigenpairs-differ", message));
    }
    warnings
}

/// When the network's map is not to be relied on: the pair is unlike those it was trained on, or landmarks contradict it. `without` says that another map than the network's was taken, `by_landmarks` that these spoke
/// against it.
/// Between a piece and a whole no functional map keeps what it takes, and that says nothing.
pub(crate) fn verdict(home: &Home, without: bool, by_landmarks: bool, pieces: bool) -> Option<Warning> {
    let (category, scores) = (&home.embeddings[0].category, home.scores);
    if without && by_landmarks && !scores.is_of_others() {
        let message = "unsure: the landmarks contradict the network's map; one made without it agrees with them better and was taken";
        return Some(Warning::new("landmarks-against-network", message));
    }
    match (without, scores.is_of_others() || scores.is_strange() && !pieces) {
        (true, _) => {
            let message = format!(
                "unsure: at least one of the scans is no {}, and {} are all that the network knows; a map made without it keeps lengths better and was taken; limbs or the whole body may be matched the wrong way round",
                category.one, category.name
            );
            Some(Warning::new("other-category", message))
        }
        (false, true) => {
            let message = format!(
                "unsure: the pair is unlike those that the network was trained on ({}): look at the map before you trust it",
                category.name
            );
            Some(Warning::new("out-of-distribution", message))
        }
        _ => None,
    }
}

/// A map that changes lengths more than this, in the median, is no map between two poses of one kind of body.
const STRETCHED: f64 = 1.2;
/// Median confidence below which most points are more likely wrong than right.
const UNSURE: f32 = 0.5;

/// What the map gives reason to say.
pub(crate) fn of_map(stretch: f64, confidence: &[f32]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if stretch > STRETCHED {
        let message = format!(
            "the map changes lengths by a factor of {stretch:.1} in the median: the scans may show different kinds of bodies, or one of them only a part, or be noisy"
        );
        warnings.push(Warning::new("lengths-changed", message));
    }
    if median(confidence).is_some_and(|median| median < UNSURE) {
        let message = "most points are more likely matched wrongly than rightly: the map is hardly to be trusted";
        warnings.push(Warning::new("low-confidence", message));
    }
    warnings
}

/// A map that takes the point of a landmark farther than this from its partner, in √area of the other body, goes elsewhere. Of 30 pairs of held-out people
/// none of 240 true landmarks was doubted, by this or by parts, and 59 of 60 that joined two places taken at random were.
const ELSEWHERE: f64 = 0.1;
/// The same in distances between neighbouring points, where few were used.
const ELSEWHERE_POINTS: f64 = 2.0;
/// Below this probability of being of one part two points are of two.
const OF_ONE_PART: f32 = 0.05;

/// Landmarks that are contradicted: the map, as it is before they are set, takes a point of theirs elsewhere, or it is a map of bodies that the network
/// knows (`predicted` tells) and they join two parts.
pub(crate) fn contradicted(
    landmarks: &[[u32; 2]],
    [a, b]: [&PreparedShape; 2],
    [a_to_b, b_to_a]: [&Correspondence; 2],
    predicted: Option<[&PointEmbedding; 2]>,
) -> Vec<Warning> {
    let elsewhere = |to: &PreparedShape, found: u32, wanted: u32| {
        let spacing = ELSEWHERE_POINTS / (to.points_used() as f64).sqrt();
        found != UNMATCHED && apart(to.shape.points(), found, wanted) > ELSEWHERE.max(spacing) * to.info.scale
    };
    let of_two_parts = |i: u32, j: u32| {
        let Some([of_a, of_b]) = predicted else { return false };
        let (row_a, row_b) = (a.support.row_of(i as usize), b.support.row_of(j as usize));
        of_a.parts.row(row_a).dot(&of_b.parts.row(row_b)) < OF_ONE_PART
    };
    let doubt = |&[i, j]: &[u32; 2]| {
        let why = if elsewhere(b, a_to_b.target[i as usize], j) || elsewhere(a, b_to_a.target[j as usize], i) {
            "the map around them goes elsewhere"
        } else if of_two_parts(i, j) {
            "as far as the network can tell they are of two parts of the body"
        } else {
            return None;
        };
        let message = format!(
            "a landmark joins point {i} of A with point {j} of B, but {why}: check the two; where they are right, name more points nearby"
        );
        Some(Warning::new("landmark-contradicted", message))
    };
    landmarks.iter().filter_map(doubt).collect()
}

fn apart(points: &[[f64; 3]], i: u32, j: u32) -> f64 {
    let [p, q] = [points[i as usize], points[j as usize]];
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt()
}

/// A part of which less than this share of the points has one label on both bodies is labelled otherwise on one of them.
/// On 30 pairs of held-out people no right labels were doubted, and all with left and right exchanged on one of the two.
const ALIKE: f32 = 0.5;
/// Parts with a smaller share of the points say nothing.
const SEEN: f32 = 0.005;

/// Says so when given labels name other parts on one body than on the other, by the parts (p, c) that the network predicts at the points with those labels.
pub(crate) fn labelled_otherwise(labels: [&[u32]; 2], predicted: [&PointEmbedding; 2]) -> Option<Warning> {
    let [on_a, on_b] = [0, 1].map(|side| labels_of_parts(labels[side], &predicted[side].parts));
    let names = predicted[0].category.part_names();
    let otherwise = names.iter().zip(on_a.iter().zip(&on_b)).filter(|(_, (on_a, on_b))| {
        let alike = |(label, share): (&u32, &f32)| share.min(*on_b.get(label).unwrap_or(&0.0));
        !on_a.is_empty() && !on_b.is_empty() && on_a.iter().map(alike).sum::<f32>() < ALIKE
    });
    let names: Vec<&str> = otherwise.map(|(name, _)| *name).collect();
    (!names.is_empty()).then(|| {
        let message = format!(
            "are both scans labelled alike? As far as the network can tell, these parts have other labels on A than on B: {}",
            names.join(", ")
        );
        Warning::new("labels-differ", message)
    })
}

/// For each part the share of its points that has each label; nothing for a part that is hardly there.
fn labels_of_parts(labels: &[u32], predicted: &Array2<f32>) -> Vec<BTreeMap<u32, f32>> {
    let of_part = |probabilities: ArrayView1<f32>| {
        let all = probabilities.sum();
        let mut shares = BTreeMap::new();
        if all >= SEEN * labels.len() as f32 {
            labels.iter().zip(probabilities).for_each(|(&label, p)| *shares.entry(label).or_default() += p / all);
        }
        shares
    };
    predicted.columns().into_iter().map(of_part).collect()
}

fn median(values: &[f32]) -> Option<f32> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}
