//! Fits the constants of confidence again: what they are fitted to is what `evaluate` measures.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use ndarray::{Array1, Array2, ArrayView1};

use super::calibration::{Judged, area_under_curve, calibration_error};
use super::selection::every;
use super::{EvaluationError, Mode, Rotate, Task, over_pairs};
use crate::confidence::{Fit, GENERAL, Situation, fit_of_faults, probability, signs};
use crate::network::{CUES, Model, PRIOR, Weights};
use crate::pipeline::PreparedShape;
use crate::pipeline::match_with_cues;
use crate::pipeline::{MatchOptions, Parts, PrepareOptions};
use crate::progress::Progress;
use crate::registration::Refinement;

/// What few ask for (ZoomOut, no refinement, no network) is fitted to about every so many-th pair.
const RARE: u64 = 4;

/// Points of a situation.
#[derive(Default)]
struct Points {
    /// Cues besides the prior, which is found here, `others` of each.
    cues: Vec<f32>,
    others: usize,
    /// Features, `width` of each; none without the network.
    features: Vec<f32>,
    width: usize,
    /// Whether they are matched rightly.
    right: Vec<bool>,
}

impl Points {
    fn cues(&self, i: usize) -> &[f32] {
        &self.cues[i * self.others..(i + 1) * self.others]
    }

    fn features(&self, i: usize) -> ArrayView1<'_, f32> {
        ArrayView1::from(&self.features[i * self.width..(i + 1) * self.width])
    }

    fn join(&mut self, more: Self) {
        (self.width, self.others) = (more.width, more.others);
        self.cues.extend(more.cues);
        self.features.extend(more.features);
        self.right.extend(more.right);
    }
}

/// Matches pairs of the sets in all modes, with and without refinement and the network. Returns the coefficients that explain best which points are right, as the
/// source has them, and the weights with those of its own and the prior that belongs to them. `log` is given a line now and then.
pub fn refit(
    datasets: &[PathBuf],
    limit: Option<usize>,
    model: &Model,
    log: &(dyn Fn(&str) + Sync),
) -> Result<(String, Weights), EvaluationError> {
    let (mut points, mut partners): (BTreeMap<Situation, Points>, BTreeMap<Situation, Points>) = Default::default();
    let modes = [Mode::Mesh, Mode::Cloud, Mode::MeshCloud];
    for (dataset, mode) in datasets.iter().flat_map(|dataset| modes.map(|mode| (dataset, mode))) {
        let task = Task {
            dataset: dataset.clone(),
            pairs: None,
            limit,
            mode,
            preparing: PrepareOptions::default(),
            parts: Parts::Predicted,
            refine: Refinement::Best,
            network_only: false,
            rotate: Rotate::None,
            seed: 0,
            oracle: false,
        };
        let (.., found) = over_pairs(&task, model, log, |trial| {
            let line = trial.names.map(String::as_str).join(" ");
            let known = trial.shapes.map(PreparedShape::clone);
            let unknown = known.clone().map(|shape| PreparedShape { embeddings: Vec::new(), ..shape });
            let rare = every(RARE, &line);
            // What a piece is no one knows without a network.
            let wholes = known.iter().all(|shape| shape.info.share == 1.0);
            let mut found = Vec::new();
            for (shapes, refine, asked) in [
                (&known, Refinement::Best, true),
                (&known, Refinement::ZoomOut, rare),
                (&known, Refinement::None, rare),
                (&unknown, Refinement::Best, rare && wholes),
                (&unknown, Refinement::ZoomOut, rare && wholes),
                (&unknown, Refinement::None, rare && wholes),
            ] {
                if !asked {
                    continue;
                }
                let options = MatchOptions { refine, ..MatchOptions::default() };
                let [a, b] = shapes;
                let matched = pollster::block_on(match_with_cues(model, a, b, &options, &mut Progress::silent()));
                let (matched, [cues, _]) = matched.map_err(|e| EvaluationError::method(&line, e))?;
                let situation = Situation::of(&cues);
                let features = a.embeddings.first().filter(|_| situation.learned).map(|e| &e.features);
                let others = match situation {
                    Situation { learned: true, pieces: true, .. } => CUES,
                    Situation { learned, .. } => cues.table.ncols() - usize::from(learned),
                };
                let mut points = Points { width: features.map_or(0, Array2::ncols), others, ..Points::default() };
                let mut wrong = BTreeSet::new();
                for (i, right) in trial.judge(&matched.a_to_b.target) {
                    if !right {
                        wrong.insert(i);
                    }
                    let row = a.support.row_of(i as usize);
                    points.cues.extend(cues.table.row(row).iter().take(others).map(|&cue| cue as f32));
                    points.features.extend(features.iter().flat_map(|features| features.row(row)));
                    points.right.push(right);
                }
                let mut partners = Points { others: GENERAL, ..Points::default() };
                let of_pieces = trial.truth.paired.iter().flatten().filter(|_| b.info.share < 1.0);
                // What has a partner and is matched elsewhere looks alone, and tells nothing about those that are.
                for &(i, has) in of_pieces.filter(|(i, has)| !has || !wrong.contains(i)) {
                    let row = cues.table.row(a.support.row_of(i as usize));
                    partners.cues.extend(row.iter().take(GENERAL).map(|&cue| cue as f32));
                    partners.right.push(has);
                }
                found.push((situation, points, partners));
            }
            Ok(found)
        })?;
        for (situation, of_points, of_partners) in found.into_iter().flatten() {
            points.entry(situation).or_default().join(of_points);
            // Whether the network took part says nothing about what these signs mean.
            if !of_partners.right.is_empty() {
                partners.entry(Situation { learned: true, ..situation }).or_default().join(of_partners);
            }
        }
    }
    let points = all_situations(points)?;
    let [trained] = model.networks() else { panic!("one network is fitted at a time") };
    let weights = trained.weights();
    let features = weights.config.feature_columns();
    let mut prior = Array2::<f32>::zeros((features + 1, 2));
    let mut fitted = BTreeMap::new();
    // Refined maps of wholes first: their points say what prior is, and the other wholes take it as it is.
    let (best, others): (Vec<_>, Vec<_>) =
        points.iter().partition(|(s, points)| s.registered && !s.pieces && points.width == features);
    for (&situation, points) in best {
        let others = points.others;
        let found = fit_of_faults(&points.right, others + features, signs(others), |i, row| {
            row[..others].iter_mut().zip(points.cues(i)).for_each(|(x, &cue)| *x = f64::from(cue));
            row[others..].iter_mut().zip(points.features(i)).for_each(|(x, &feature)| *x = f64::from(feature));
        });
        let coefficients = converged(situation, found)?;
        let of_features = &coefficients[1 + others..];
        let mut column = prior.column_mut(usize::from(!situation.meshes));
        (0..features).for_each(|f| column[f] = of_features[f] as f32);
        // About 0 on average, so that a point of which nothing is known is as good as any.
        let direction: Array1<f32> = column.iter().take(features).copied().collect();
        let sum: f64 = (0..points.right.len()).map(|i| f64::from(points.features(i).dot(&direction))).sum();
        let mean = sum / points.right.len() as f64;
        column[features] = -mean as f32;
        let mut of_cues = [&coefficients[..1 + others], &[1.0]].concat();
        of_cues[0] += mean;
        fitted.insert(situation, of_cues);
    }
    let priors = |situation: &Situation, points: &Points, i: usize| {
        let column = prior.column(usize::from(!situation.meshes));
        (situation.learned && !situation.pieces).then(|| prior_of(column, points.features(i)))
    };
    for (&situation, points) in others {
        let inputs = points.others + usize::from(situation.learned && !situation.pieces);
        let found = fit_of_faults(&points.right, inputs, signs(points.others), |i, row| {
            let cues = points.cues(i).iter().map(|&cue| f64::from(cue)).chain(priors(&situation, points, i));
            row.iter_mut().zip(cues).for_each(|(x, cue)| *x = cue);
        });
        fitted.insert(situation, converged(situation, found)?);
    }
    let text = fitted.iter().map(|(situation, coefficients)| {
        let points = &points[situation];
        lines(*situation, points, coefficients, |i| priors(situation, points, i))
    });
    let mut text: String = text.collect();
    if !partners.is_empty() {
        text += "// Whether points have a partner, for src/confidence/overlap.rs:\n";
    }
    for (&situation, points) in &partners {
        // Here not even a wide average may count the other way.
        let each = (0..GENERAL).map(|cue| cue..cue + 1);
        let found = fit_of_faults(&points.right, GENERAL, each, |i, row| {
            row.iter_mut().zip(points.cues(i)).for_each(|(x, &cue)| *x = f64::from(cue));
        });
        text += &lines(situation, points, &converged(situation, found)?, |_| None);
    }
    let mut weights = weights.clone().with(PRIOR, prior.clone());
    let table = |pieces: bool| -> Vec<Vec<f64>> {
        fitted
            .iter()
            .filter(|(s, _)| s.learned && s.pieces == pieces)
            .map(|(s, of_cues)| rounded(of_cues, points[s].others))
            .collect()
    };
    (weights.category.confidence, weights.category.confidence_of_pieces) = (table(false), table(true));
    weights.category.check().map_err(EvaluationError::NotMeasurable)?;
    Ok((text, weights))
}

/// The points, if there are any of every situation.
fn all_situations(points: BTreeMap<Situation, Points>) -> Result<BTreeMap<Situation, Points>, EvaluationError> {
    let empty = |situation: &Situation| points.get(situation).is_none_or(|points| points.right.is_empty());
    let missing: Vec<Situation> = Situation::of_wholes().filter(empty).collect();
    if missing.is_empty() {
        return Ok(points);
    }
    let sentence = format!(
        "the pairs show nothing of {missing:?}: take more, as only about one in {RARE} is matched without network or refinement"
    );
    Err(EvaluationError::NotMeasurable(sentence))
}

/// The coefficients, if they were found.
fn converged(situation: Situation, fit: Fit) -> Result<Vec<f64>, EvaluationError> {
    if fit.converged() {
        return Ok(fit.coefficients);
    }
    let Fit { iterations, last_step, .. } = fit;
    Err(EvaluationError::NotFitted { to: format!("{situation:?}"), iterations, last_step })
}

/// Coefficients in hundredths, the constant first: where rounding lets one of the signs of so many cues raise the probability, the last of its coefficients gives way.
fn rounded(coefficients: &[f64], cues: usize) -> Vec<f64> {
    let mut hundredths: Vec<f64> = coefficients.iter().map(|c| (100.0 * c).round()).collect();
    for sign in signs(cues) {
        let slopes = &mut hundredths[1..][sign];
        let raises = slopes.iter().sum::<f64>().max(0.0);
        slopes.last_mut().into_iter().for_each(|last| *last -= raises);
    }
    hundredths.into_iter().map(|c| c / 100.0).collect()
}

/// Prior of a point by its features; the last of `column` is the constant.
fn prior_of(column: ArrayView1<f32>, features: ArrayView1<f32>) -> f64 {
    f64::from(features.iter().zip(column).fold(column[features.len()], |sum, (x, t)| sum + x * t))
}

/// Coefficients as the source has them.
fn lines(situation: Situation, points: &Points, coefficients: &[f64], prior: impl Fn(usize) -> Option<f64>) -> String {
    let judged = |(i, &right): (usize, &bool)| {
        let cues = points.cues(i).iter().map(|&cue| f64::from(cue)).chain(prior(i));
        Judged { confidence: probability(coefficients, cues) as f32, right }
    };
    let judged: Vec<Judged> = points.right.iter().enumerate().map(judged).collect();
    let of = |score: Option<f64>| score.map_or_else(|| "–".to_owned(), |score| format!("{score:.3}"));
    let scores = [of(area_under_curve(&judged)), of(calibration_error(&judged))];
    let values: Vec<String> = coefficients.iter().map(|value| format!("{value:.2}")).collect();
    let (count, [auc, ece]) = (judged.len(), scores);
    format!(
        "    // {situation:?}: {count} points, AUC {auc}, calibration error {ece} on themselves.\n    [{}],\n",
        values.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(situations: impl Iterator<Item = Situation>) -> BTreeMap<Situation, Points> {
        situations.map(|situation| (situation, Points { right: vec![true], ..Points::default() })).collect()
    }

    #[test]
    fn a_set_that_lacks_a_situation_is_refused() {
        assert!(all_situations(seen(Situation::of_wholes())).is_ok());
        let few = seen(Situation::of_wholes().filter(|situation| situation.learned || situation.registered));
        let refused = all_situations(few).err().expect("two are missing").to_string();
        assert!(refused.matches("learned: false, registered: false").count() == 2, "{refused}");
        let nothing = all_situations(BTreeMap::from([])).err().expect("all are missing");
        assert_eq!(nothing.to_string().matches("Situation").count(), 8);
    }

    #[test]
    fn rounding_raises_no_sign() {
        let general = [2.0, -1.0, 0.5, 0.004, -0.004, 0.0, 0.0];
        assert_eq!(
            rounded(&[&general[..], &[0.855, -0.388, -0.464]].concat(), 9),
            [&[2.0, -1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.86, -0.39, -0.47][..]].concat()
        );
    }

    #[test]
    fn coefficients_that_were_not_found_are_refused() {
        let situation = Situation::of_wholes().last().expect("some");
        let fit = |last_step| Fit { coefficients: vec![1.0], iterations: 30, last_step };
        assert_eq!(converged(situation, fit(1e-9)).expect("found"), [1.0]);
        let refused = converged(situation, fit(250.0)).expect_err("swinging").to_string();
        assert!(
            refused.contains("learned: true") && refused.contains("step 30") && refused.contains("2.5e2"),
            "{refused}"
        );
        assert!(converged(situation, fit(f64::NAN)).is_err());
    }
}
