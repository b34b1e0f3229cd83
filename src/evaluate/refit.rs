//! Fits the constants of confidence again: what they are fitted to is what `evaluate` measures.

use std::collections::BTreeMap;
use std::path::Path;

use super::calibration::{Judged, area_under_curve, calibration_error};
use super::{EvaluationError, Mode, Rotate, Task, over_pairs};
use crate::fmap::{CUES, Refinement, Situation, fit};
use crate::model::Model;
use crate::options::{MatchOptions, Parts, PrepareOptions};
use crate::pipeline::match_with_cues;
use crate::progress::Progress;

/// Points with their cues, and whether they are matched rightly.
type Points = Vec<([f64; CUES], bool)>;

/// Matches pairs of the set in all modes, with and without refinement and the network, and writes the coefficients that explain best which points are right.
/// `told` hears a line now and then.
pub fn refit(
    dataset: &Path,
    limit: Option<usize>,
    model: &Model,
    told: &(dyn Fn(&str) + Sync),
) -> Result<String, EvaluationError> {
    let mut points: BTreeMap<Situation, Points> = BTreeMap::new();
    for mode in [Mode::Mesh, Mode::Cloud, Mode::MeshCloud] {
        let task = Task {
            dataset: dataset.to_owned(),
            pairs: None,
            limit,
            mode,
            preparing: PrepareOptions::default(),
            parts: Parts::Predicted,
            refine: Refinement::Best,
            rotate: Rotate::None,
            seed: 0,
            oracle: false,
        };
        let (.., found) = over_pairs(&task, model, told, |trial| {
            let [a, b] = trial.shapes.map(|shape| shape.clone());
            let unknown = [&a, &b].map(|shape| crate::prepared::PreparedShape { embedding: None, ..shape.clone() });
            let mut found = Vec::new();
            for [a, b] in [[&a, &b], [&unknown[0], &unknown[1]]] {
                for refine in [Refinement::Best, Refinement::None] {
                    let options = MatchOptions { refine, ..MatchOptions::default() };
                    let mut progress = Progress::silent();
                    let matched = pollster::block_on(match_with_cues(model, a, b, &options, &mut progress));
                    let names = || trial.names.map(String::as_str).join(" ");
                    let (matched, [cues, _]) = matched.map_err(|e| EvaluationError::method(names(), e))?;
                    let judged = trial.judge(&matched.a_to_b.target).into_iter().map(|(i, right)| {
                        let row = cues.table.row(a.support.row_of(i as usize));
                        (std::array::from_fn(|c| row[c]), right)
                    });
                    found.push((Situation::of(&cues), judged.collect::<Points>()));
                }
            }
            Ok(found)
        })?;
        for (situation, more) in found.into_iter().flatten() {
            points.entry(situation).or_default().extend(more);
        }
    }
    Ok(points.into_iter().map(|(situation, points)| lines(situation, &points)).collect())
}

/// Coefficients as the source has them.
fn lines(situation: Situation, points: &Points) -> String {
    let coefficients = fit(points);
    let judged: Vec<Judged> = points
        .iter()
        .map(|(cues, right)| Judged {
            confidence: crate::fmap::probability(&coefficients, cues.iter().copied()) as f32,
            right: *right,
        })
        .collect();
    let of = |score: Option<f64>| score.map_or_else(|| "–".to_owned(), |score| format!("{score:.3}"));
    let scores = [of(area_under_curve(&judged)), of(calibration_error(&judged))];
    let values: Vec<String> = coefficients.iter().map(|value| format!("{value:.2}")).collect();
    let (count, [auc, ece]) = (points.len(), scores);
    format!(
        "    // {situation:?}: {count} points, AUC {auc}, calibration error {ece} on themselves.\n    [{}],\n",
        values.join(", ")
    )
}
