//! What was measured, as JSON for programs and as a few lines for people.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use super::mode::Mode;
use super::overlap::Overlap;
use super::rotation::Rotate;
use crate::pipeline::Parts;
use crate::registration::Refinement;
use crate::shape::counted;

/// The measurements of one set in one mode. What the set has no data for is `None`.
#[derive(Clone, Debug, Serialize)]
pub struct Evaluation {
    /// The set's name.
    pub set: String,
    /// What faces were used for.
    pub mode: Mode,
    /// How far matches were refined.
    pub refine: Refinement,
    /// Whether the network's maps stood, however little it was at home.
    pub network_only: bool,
    /// Where part labels came from.
    pub parts: Parts,
    /// Which rotations shapes got.
    pub rotate: Rotate,
    /// Whether true maps were measured instead of matches.
    pub oracle: bool,
    /// Pairs measured.
    pub pairs: usize,
    /// Different shapes A of these pairs.
    pub sources: usize,
    /// Mean error ×100, mean over pairs.
    pub age: Option<f64>,
    /// 95 % of it, low and high: sources are drawn again, each with all of its pairs. `None` with fewer than two sources.
    pub age_interval: Option<[f64; 2]>,
    /// The same before refinement; without refinement the same number.
    pub age_raw: Option<f64>,
    /// The share of lines with an error of at most the key (in √area), mean over pairs.
    pub accuracy: Option<BTreeMap<&'static str, f64>>,
    /// Pairs nearer to the mirrored truth.
    pub flips: Option<usize>,
    /// The share of lines nearer to the mirrored truth, mean over pairs.
    pub flipped_points: Option<f64>,
    /// What only sets with pieces have.
    #[serde(flatten)]
    pub pieces: Option<Pieces>,
    /// Intersection over union of predicted and given parts by area, mean over parts, then over shapes.
    pub part_miou: Option<f64>,
    /// The share of corresponding points that have the same predicted part, mean over pairs.
    pub part_agreement: Option<f64>,
    /// What only sets with given parts have.
    #[serde(flatten)]
    pub given_parts: Option<GivenParts>,
    /// How often a point with an error of at most 0.05 √area has more confidence than one with a larger error, over the lines of all pairs.
    pub confidence_auc: Option<f64>,
    /// Expected calibration error of confidence, taken as the probability of an error of at most 0.05 √area; ten bins over the lines of all pairs.
    pub ece: Option<f64>,
    /// Mean seconds to prepare a shape.
    pub seconds_per_shape: Option<f64>,
    /// Mean seconds to match a pair, both directions, the match before refinement included.
    pub seconds_per_pair: Option<f64>,
    /// Pair by pair.
    pub per_pair: Vec<PairResult>,
}

/// The measurements of pairs of which one shape lacks what the other has.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Pieces {
    /// Whether matches tell which points have a partner.
    pub overlap: Overlap,
    /// Mean error ×100 over the lines whose point got a partner, mean over pairs that have any. In `age` a point without one is as far off as can be.
    pub age_of_matched: Option<f64>,
    /// The share of pairs whose ratio of scales is found to within 10 %, of those whose set tells it: by the faces of A that are on both.
    pub scale_within_10: Option<f64>,
}

/// The measurements of pairs whose shapes both came with parts.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct GivenParts {
    /// The share of A's points that end on a point of B with the same given part, side included, mean over pairs.
    pub same_part: f64,
    /// Pairs whose mean confidence is above 0.6 though more than a fifth of their lines are off by more than 0.1 of the set's unit.
    pub confident_wrong: usize,
}

/// The same for one pair.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PairParts {
    /// The share of A's points that end on the same given part; unmatched points do not, and points of a part that B lacks do not count.
    pub same_part: f64,
    /// Mean confidence over the lines; none of an oracle.
    pub mean_confidence: Option<f64>,
    /// The share of lines off by more than 0.1 of the set's unit, in a straight line where no path leads along the mesh.
    pub far_off: f64,
}

/// The measurements of one pair.
#[derive(Clone, Debug, Serialize)]
pub struct PairResult {
    /// A.
    pub source: String,
    /// B.
    pub target: String,
    /// Mean error ×100.
    pub age: f64,
    /// The same before refinement.
    pub age_raw: f64,
    /// `age` without the points that were wrongly said to be alone, where a shape lacks what the other has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub age_of_matched: Option<f64>,
    /// Whether it is nearer to the mirrored truth.
    pub flipped: Option<bool>,
    /// What only pairs with given parts on both shapes have.
    #[serde(flatten)]
    pub given_parts: Option<PairParts>,
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let how = match self.oracle {
            true => "oracle".to_owned(),
            false => {
                let alone = if self.network_only { ", the network's maps only" } else { "" };
                format!("refine {}, parts {}{alone}", name(self.refine), name(self.parts))
            }
        };
        let pairs = counted(self.pairs, "pair", "pairs");
        let of = match self.sources {
            0 => String::new(),
            sources => format!(" from {}", counted(sources, "source", "sources")),
        };
        writeln!(f, "{}, mode {}, {how}, rotate {}: {pairs}{of}", self.set, name(self.mode), name(self.rotate))?;
        if let (Some(age), Some(raw)) = (self.age, self.age_raw) {
            let interval = self.age_interval.map(|[low, high]| format!(" (95 % interval {low:.2}–{high:.2})"));
            let before =
                if self.refine == Refinement::None { String::new() } else { format!(", before refinement {raw:.2}") };
            writeln!(f, "mean error {age:.2}{}{before} (×100/√area)", interval.unwrap_or_default())?;
        }
        if let Some(accuracy) = &self.accuracy {
            let shares: Vec<_> =
                accuracy.iter().map(|(t, share)| format!("{:.1} % within {t}", 100.0 * share)).collect();
            writeln!(f, "{}", shares.join(", "))?;
        }
        if let (Some(flips), Some(points)) = (self.flips, self.flipped_points) {
            writeln!(f, "{flips} of {pairs} flipped, {:.1} % of points", 100.0 * points)?;
        }
        if let Some(Pieces { overlap: Overlap { iou, alone_said_alone, paired_said_alone }, age_of_matched, .. }) =
            self.pieces
        {
            if let Some(age) = age_of_matched {
                writeln!(f, "mean error of points with a target {age:.2}")?;
            }
            let shares = [("of points alone", alone_said_alone), ("of points with a partner", paired_said_alone)];
            let shares: Vec<_> =
                shares.iter().filter_map(|(of, s)| Some(format!("{:.1} % {of}", 100.0 * (*s)?))).collect();
            let iou = iou.map_or_else(|| "–".to_owned(), |iou| format!("{iou:.3}"));
            writeln!(f, "overlap: IoU {iou}; said to be alone: {}", shares.join(", "))?;
        }
        let parts = [("mIoU", self.part_miou), ("agreement", self.part_agreement)];
        let confidence = [("AUC", self.confidence_auc), ("calibration error", self.ece)];
        for (of, scores) in [("parts", parts), ("confidence", confidence)] {
            let scores: Vec<_> = scores.iter().filter_map(|(what, s)| Some(format!("{what} {:.3}", (*s)?))).collect();
            if !scores.is_empty() {
                writeln!(f, "{of}: {}", scores.join(", "))?;
            }
        }
        if let Some(GivenParts { same_part, confident_wrong }) = self.given_parts {
            let same = 100.0 * same_part;
            writeln!(f, "{same:.1} % of points on the same part; {confident_wrong} of {pairs} confident and wrong")?;
        }
        let seconds = [("shape", self.seconds_per_shape), ("pair", self.seconds_per_pair)];
        let seconds: Vec<_> =
            seconds.iter().filter_map(|(what, s)| Some(format!("{:.2} s per {what}", (*s)?))).collect();
        write!(f, "{}", seconds.join(", "))
    }
}

/// An option's value as users write it.
fn name(option: impl Serialize) -> String {
    let value = serde_json::to_value(option).unwrap_or_default();
    value.as_str().unwrap_or_default().to_owned()
}
