//! Measuring the method on a set with ground truth. Layout and protocol are those of the evaluation sets' own README;
//! its terms are used here.

mod calibration;
mod cores;
pub(crate) mod dataset;
mod error;
mod interval;
mod mode;
mod oracle;
mod overlap;
mod part_classes;
mod random;
#[cfg(feature = "train")]
pub mod refit;
mod report;
mod rotation;
mod ruler;
mod same_part;
pub(crate) mod selection;
pub(crate) mod table;
mod truth;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use ndarray::Array2;

use crate::network::Model;
use crate::pipeline::Error;
use crate::pipeline::PreparedShape;
use crate::pipeline::{FaceUse, MatchOptions, Parts, PrepareOptions};
use crate::pipeline::{match_with, prepare_with};
use crate::progress::Progress;
use crate::registration::Refinement;
use crate::shape::Axis;
use crate::shape::Shape;
use crate::uses::part_scores;

use calibration::{Judged, RIGHT, area_under_curve, calibration_error};
use cores::on_all_cores;
use dataset::{DataSet, Labelled};
pub use error::EvaluationError;
use interval::{interval, mean};
pub use mode::Mode;
use overlap::Overlap;
use part_classes::class_of_parts;
use report::PairParts;
pub use report::{Evaluation, PairResult, Pieces};
pub use rotation::Rotate;
use ruler::Ruler;
use same_part::{FAR_OFF, given_parts, same_part};
use truth::Truth;

/// Thresholds of accuracy, in √area (paper Sec. 4.2).
const THRESHOLDS: [(&str, f64); 3] = [("0.01", 0.01), ("0.02", 0.02), ("0.05", 0.05)];

impl Task {
    /// Where part labels come from: the oracle needs none.
    fn parts(&self) -> Parts {
        if self.oracle { Parts::None } else { self.parts }
    }
}

/// What to measure.
#[derive(Clone, Debug)]
pub struct Task {
    /// The set's folder.
    pub dataset: PathBuf,
    /// A list of pairs in place of the set's own.
    pub pairs: Option<PathBuf>,
    /// How many pairs, or shapes of a set without pairs; those whose lines come first by a hash.
    pub limit: Option<usize>,
    /// What faces are used for.
    pub mode: Mode,
    /// How shapes are prepared, but for their faces. The oracle uses every point.
    pub preparing: PrepareOptions,
    /// Part labels that matches use.
    pub parts: Parts,
    /// How far matches are refined.
    pub refine: Refinement,
    /// Whether the network's maps stand, however little it is at home with a pair.
    pub network_only: bool,
    /// Which rotations shapes get; `up` is about `preparing.up`, by default y.
    pub rotate: Rotate,
    /// Seed of the rotations.
    pub seed: u64,
    /// True maps in place of matches: neither parts nor refinement.
    pub oracle: bool,
}

/// A pair to measure, prepared.
struct Trial<'t> {
    names: [&'t String; 2],
    shapes: [&'t PreparedShape; 2],
    truth: &'t Truth,
    ruler: &'t Ruler,
    /// Given parts of A's and B's points, where the set has both.
    labels: Option<[&'t [u32]; 2]>,
}

impl Trial<'_> {
    /// For each line of the ground truth the point of A it begins at, and whether `found` takes that to at most [`RIGHT`] of where it belongs.
    #[cfg(feature = "train")]
    fn judge(&self, found: &[u32]) -> Vec<(u32, bool)> {
        let [errors] = self.ruler.errors(self.truth, [found]);
        self.truth.lines.iter().map(|&(i, _)| i).zip(errors.within(RIGHT)).collect()
    }
}

/// Measures. `log` is given a line now and then.
pub fn evaluate(task: &Task, model: &Model, log: &(dyn Fn(&str) + Sync)) -> Result<Evaluation, EvaluationError> {
    let (set, prepared, measured) = over_pairs(task, model, log, |trial| measure(task, model, trial))?;
    let mut ious = Vec::new();
    for (name, shape, _) in prepared.iter().filter(|_| task.parts() == Parts::Predicted) {
        ious.extend(part_iou(&set, name, shape)?);
    }
    Ok(summary(&set, task, prepared.into_iter().map(|(.., seconds)| seconds), ious, measured))
}

/// A shape by name, and the seconds it took.
type Timed = (String, PreparedShape, f64);

/// Prepares the shapes of a task and does something with each of its pairs.
fn over_pairs<R: Send>(
    task: &Task,
    model: &Model,
    log: &(dyn Fn(&str) + Sync),
    each: impl Fn(&Trial) -> Result<R, EvaluationError> + Sync,
) -> Result<(DataSet, Vec<Timed>, Vec<R>), EvaluationError> {
    let set = DataSet::open(&task.dataset)?;
    let pairs = set.pairs(task.pairs.as_deref())?;
    let pairs = selection::select(pairs, |pair| pair.join(" "), task.limit);
    let needed = needed(&set, task, &pairs)?;

    // Everything is read before anything is computed: what is wrong with the files shows at once.
    let (mut shapes, mut labels) = (BTreeMap::new(), BTreeMap::new());
    for (name, faces) in &needed {
        let shape = set.shape(name)?;
        if *faces == FaceUse::Use && shape.faces().is_empty() {
            let sentence = format!("{name} of {} has no faces: measure it with --mode cloud", set.name());
            return Err(EvaluationError::NotMeasurable(sentence));
        }
        if let Some(Labelled { labels: given, .. }) = set.labels_if_any(name, shape.points().len())? {
            labels.insert(name.as_str(), given);
        }
        shapes.insert(name.as_str(), shape);
    }
    let mut rulers = BTreeMap::new();
    let mut trials = Vec::with_capacity(pairs.len());
    for pair @ [a, b] in &pairs {
        let truth = Truth::of(&set, (a, &shapes[a.as_str()]), (b, &shapes[b.as_str()]))?;
        if task.oracle && truth.vertex_of.is_some() {
            let sentence = format!("the clouds of {} share no points, so there is no oracle for them", set.name());
            return Err(EvaluationError::NotMeasurable(sentence));
        }
        if !rulers.contains_key(b.as_str()) {
            let mesh = Truth::mesh(&set, b)?.shape()?;
            if mesh.faces().is_empty() {
                let sentence = format!("{b} of {} has no faces, and distances are measured along them", set.name());
                return Err(EvaluationError::NotMeasurable(sentence));
            }
            rulers.insert(b.as_str(), Ruler::new(&mesh));
        }
        trials.push((pair, truth));
    }

    let started = AtomicUsize::new(0);
    let count = |what: &str, of: usize| {
        log(&format!("{}/{of} {what}", started.fetch_add(1, Ordering::Relaxed) + 1));
    };
    let prepared = on_all_cores(&needed, |(name, faces)| {
        count(name, needed.len());
        prepare_one(&set, task, model, name, &shapes[name.as_str()], *faces)
    })?;
    started.store(0, Ordering::Relaxed);
    let at = |name: &String, faces| {
        let place = needed.iter().position(|(known, used)| known == name && *used == faces);
        &prepared[place.expect("all shapes of the pairs are needed")].0
    };
    let measured = on_all_cores(&trials, |([a, b], truth)| {
        count(&format!("{a} {b}"), trials.len());
        let [faces_a, faces_b] = task.mode.faces();
        let of = |name: &String| labels.get(name.as_str()).map(Vec::as_slice);
        let labels = of(a).zip(of(b)).map(|(a, b)| [a, b]);
        let (shapes, ruler) = ([at(a, faces_a), at(b, faces_b)], &rulers[b.as_str()]);
        each(&Trial { names: [a, b], shapes, truth, ruler, labels })
    })?;
    let prepared = needed.into_iter().zip(prepared).map(|((name, _), (shape, seconds))| (name, shape, seconds));
    Ok((set, prepared.collect(), measured))
}

/// The shapes to prepare, and what for.
fn needed(set: &DataSet, task: &Task, pairs: &[[String; 2]]) -> Result<Vec<(String, FaceUse)>, EvaluationError> {
    let mut needed: Vec<(String, FaceUse)> = Vec::new();
    for both in pairs.iter().flat_map(|pair| pair.iter().cloned().zip(task.mode.faces())) {
        if !needed.contains(&both) {
            needed.push(both);
        }
    }
    if pairs.is_empty() {
        if task.oracle || task.mode == Mode::MeshCloud {
            let sentence = format!("{} has no pairs, which --oracle and --mode mesh-cloud are about", set.name());
            return Err(EvaluationError::NotMeasurable(sentence));
        }
        let shapes = selection::select(set.shapes()?, String::clone, task.limit);
        needed.extend(shapes.into_iter().map(|name| (name, task.mode.faces()[0])));
    }
    Ok(needed)
}

/// A shape as the mode uses it, and the seconds it took.
fn prepare_one(
    set: &DataSet,
    task: &Task,
    model: &Model,
    name: &str,
    shape: &Shape,
    faces: FaceUse,
) -> Result<(PreparedShape, f64), EvaluationError> {
    let (points, failed) = (shape.points(), |e: Error| EvaluationError::method(name, e));
    let labels = match task.parts() {
        Parts::Given => Some(set.labels(name, points.len())?),
        _ => None,
    };
    let turned = task.rotate.turn(points, name, task.seed, task.preparing.up.unwrap_or(Axis::Y));
    let shape = Shape::new(turned, shape.faces().to_vec(), labels).map_err(|e| failed(e.into()))?;
    let mut options = PrepareOptions { faces, ..task.preparing.clone() };
    if task.oracle {
        options.points = options.points.max(points.len());
    }
    let clock = Instant::now();
    let prepared =
        pollster::block_on(prepare_with(model, shape, Some(name.to_owned()), &options, &mut Progress::silent()))
            .map_err(failed)?;
    Ok((prepared, clock.elapsed().as_secs_f64()))
}

/// What one pair contributes.
struct Measured {
    result: PairResult,
    accuracy: [f64; THRESHOLDS.len()],
    part_agreement: Option<f64>,
    flipped_points: Option<f64>,
    /// Where a template point is not on one of the two.
    overlap: Option<Overlap>,
    /// The factor by which the ratio of scales is off, where the set tells it.
    scale_off: Option<f64>,
    /// One per line; none of an oracle, which has no doubts.
    judged: Vec<Judged>,
    seconds: f64,
}

fn measure(task: &Task, model: &Model, trial: &Trial) -> Result<Measured, EvaluationError> {
    let Trial { names: [source, target], shapes: [a, b], truth, ruler, labels } = *trial;
    let failed = |e: Error| EvaluationError::method(format!("{source} {target}"), e);
    let clock = Instant::now();
    let (found, confidence, raw, scale) = if task.oracle {
        let found = oracle::oracle(at_every_point(a).view(), at_every_point(b).view(), &truth.lines);
        let stuck = |_| format!("{source} {target}: the least squares of the oracle do not converge");
        (found.map_err(|e| EvaluationError::NotMeasurable(stuck(e)))?, None, None, None)
    } else {
        let &Task { refine, network_only, .. } = task;
        let (parts, raw) = (task.parts(), refine != Refinement::None);
        let options = MatchOptions { parts, refine, raw, network_only, ..Default::default() };
        let mut progress = Progress::silent();
        let matched = pollster::block_on(match_with(model, a, b, &options, &mut progress)).map_err(failed)?;
        let raw = matched.raw.map(|raw| raw.target);
        (matched.a_to_b.target, Some(matched.a_to_b.confidence), raw, Some(matched.scale.ratio))
    };
    let seconds = clock.elapsed().as_secs_f64();
    let [errors, before] = ruler.errors(truth, [&found, raw.as_ref().unwrap_or(&found)]);
    let flipped = truth.mirrored.as_ref().map(|mirrored| ruler.is_flipped(&errors, mirrored));
    let of_points = confidence.unwrap_or_default();
    let of_lines = truth.lines.iter().filter_map(|&(i, _)| of_points.get(i as usize));
    let judged: Vec<Judged> =
        of_lines.zip(errors.within(RIGHT)).map(|(&confidence, right)| Judged { confidence, right }).collect();
    let given_parts = labels.and_then(|[of_a, of_b]| {
        Some(PairParts {
            same_part: same_part(&found, of_a, of_b)?,
            mean_confidence: mean(judged.iter().map(|judged| f64::from(judged.confidence))),
            far_off: ruler.farther_than(&errors, truth, FAR_OFF),
        })
    });
    Ok(Measured {
        result: PairResult {
            source: source.clone(),
            target: target.clone(),
            age: errors.age(),
            age_raw: before.age(),
            age_of_matched: truth.paired.as_ref().and_then(|_| errors.age_of_matched()),
            flipped,
            given_parts,
        },
        accuracy: THRESHOLDS.map(|(_, threshold)| errors.accuracy(threshold)),
        part_agreement: (task.parts() == Parts::Predicted && truth.vertex_of.is_none())
            .then(|| part_agreement(a, b, &truth.lines))
            .flatten(),
        flipped_points: truth.mirrored.as_ref().map(|mirrored| ruler.flipped_points(&errors, mirrored)),
        scale_off: scale.zip(truth.scale).map(|(found, right)| (found / right).ln().abs().exp()),
        overlap: truth.paired.as_ref().map(|points| Overlap::of(points, &found)),
        judged,
        seconds,
    })
}

/// Intersection over union of predicted parts and a set's own, where it has labels that the parts can be merged to.
fn part_iou(set: &DataSet, name: &str, shape: &PreparedShape) -> Result<Option<f64>, EvaluationError> {
    let Some(Labelled { names, labels: given }) = set.labels_if_any(name, shape.shape.points().len())? else {
        return Ok(None);
    };
    let classes = shape.category().and_then(|category| class_of_parts(category, &names));
    let (Some(predicted), Some(classes)) = (shape.predicted_parts(), classes) else { return Ok(None) };
    let predicted: Vec<u32> = predicted.into_iter().map(|part| classes[part as usize]).collect();
    Ok(Some(part_scores(&predicted, &given, &shape.point_areas()).mean_iou))
}

/// The share of lines whose two points have the same predicted part.
fn part_agreement(a: &PreparedShape, b: &PreparedShape, lines: &[(u32, u32)]) -> Option<f64> {
    if a.embeddings.first()?.weights != b.embeddings.first()?.weights {
        return None;
    }
    let (of_a, of_b) = (a.predicted_parts()?, b.predicted_parts()?);
    mean(lines.iter().map(|&(i, j)| f64::from(u8::from(of_a[i as usize] == of_b[j as usize]))))
}

/// Φ (n, k) at every uploaded point.
fn at_every_point(shape: &PreparedShape) -> Array2<f64> {
    let phi = &shape.basis.eigenvectors;
    match &shape.support.carrier_of {
        None => phi.clone(),
        Some(of) => {
            let uploaded = &of[..shape.shape.points().len()];
            phi.select(ndarray::Axis(0), &uploaded.iter().map(|&carrier| carrier as usize).collect::<Vec<_>>())
        }
    }
}

fn summary(
    set: &DataSet,
    task: &Task,
    seconds_per_shape: impl Iterator<Item = f64>,
    ious: Vec<f64>,
    measured: Vec<Measured>,
) -> Evaluation {
    let over_pairs = |value: &dyn Fn(&Measured) -> f64| mean(measured.iter().map(value));
    let accuracy = THRESHOLDS.iter().enumerate().map(|(t, (name, _))| Some((*name, over_pairs(&|m| m.accuracy[t])?)));
    let flipped: Vec<bool> = measured.iter().filter_map(|m| m.result.flipped).collect();
    let judged: Vec<Judged> = measured.iter().flat_map(|m| m.judged.iter().copied()).collect();
    let sources: BTreeSet<&str> = measured.iter().map(|m| m.result.source.as_str()).collect();
    let overlaps: Vec<Overlap> = measured.iter().filter_map(|m| m.overlap).collect();
    let age_of_matched = mean(measured.iter().filter_map(|m| m.result.age_of_matched));
    let scale_within_10 = mean(measured.iter().filter_map(|m| m.scale_off).map(|off| f64::from(u8::from(off <= 1.1))));
    Evaluation {
        set: set.name(),
        mode: task.mode,
        refine: if task.oracle { Refinement::None } else { task.refine },
        network_only: task.network_only,
        parts: task.parts(),
        rotate: task.rotate,
        oracle: task.oracle,
        pairs: measured.len(),
        sources: sources.len(),
        age: over_pairs(&|m| m.result.age),
        age_interval: interval(measured.iter().map(|m| (m.result.source.as_str(), m.result.age))),
        age_raw: over_pairs(&|m| m.result.age_raw),
        accuracy: accuracy.collect(),
        flips: (!flipped.is_empty()).then(|| flipped.iter().filter(|&&flipped| flipped).count()),
        flipped_points: mean(measured.iter().filter_map(|m| m.flipped_points)),
        pieces: (!overlaps.is_empty()).then(|| Pieces {
            overlap: Overlap::mean(&overlaps),
            age_of_matched,
            scale_within_10,
        }),
        part_miou: mean(ious.into_iter()),
        given_parts: given_parts(measured.iter().filter_map(|m| m.result.given_parts)),
        part_agreement: mean(measured.iter().filter_map(|m| m.part_agreement)),
        confidence_auc: area_under_curve(&judged),
        ece: calibration_error(&judged),
        seconds_per_shape: mean(seconds_per_shape),
        seconds_per_pair: over_pairs(&|m| m.seconds),
        per_pair: measured.into_iter().map(|m| m.result).collect(),
    }
}
