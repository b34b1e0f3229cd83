//! Loss weights chosen by cross-validation (paper Sec. 4.1: five folds), over the generator's subjects: every body is another person.
//!
//! A run is scored by what labels can tell, as they are all the supervision there is: the share of points that the functional map, without refinement, sends
//! to a point of their own part.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use candle_core::Tensor;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use super::parameters::Parameters;
use super::pool::Pool;
use super::run::{Fold, RunConfig, RunError, train};
use super::step::{Forward, embed};
use crate::network::{ModelConfig, Network, Weights};

/// Pairs that a run is scored on.
const PAIRS: usize = 60;

/// Trains every candidate once for each of `folds` folds, in folders of `folder`, and writes `folds.csv` there: a line per candidate with its scores.
/// Returns the index of the best by mean score. What an earlier call scored is not trained again, as long as `run.json` beside the score says the same.
pub fn cross_validate(
    config: &ModelConfig,
    candidates: &[RunConfig],
    folds: usize,
    pool: &Pool,
    folder: &Path,
) -> Result<Option<usize>, RunError> {
    let mut means = Vec::new();
    fs::create_dir_all(folder)?;
    let mut table = fs::File::create(folder.join("folds.csv"))?;
    let heads: Vec<String> = (0..folds).map(|fold| format!("fold {fold}")).collect();
    writeln!(table, "candidate,mean,{},losses", heads.join(","))?;
    for (i, candidate) in candidates.iter().enumerate() {
        let mut scores = Vec::new();
        for held in 0..folds {
            let fold = Fold { of: folds, held };
            let run = RunConfig { fold: Some(fold), ..candidate.clone() };
            let place = folder.join(format!("candidate-{i}-fold-{held}"));
            let scored = place.join("score");
            begin_anew_unless_same(&place, &json!({ "network": config, "run": run, "bodies": pool.count }))?;
            let score = match fs::read_to_string(&scored).ok().and_then(|text| text.trim().parse::<f64>().ok()) {
                Some(score) => score,
                None => {
                    train(config, &run, pool, &place, None, f64::INFINITY)?;
                    let weights = Weights::from_bytes(&fs::read(place.join("weights.safetensors"))?)?;
                    let score = score(&weights, &run, pool, fold)?;
                    fs::write(&scored, score.to_string())?;
                    score
                }
            };
            scores.push(score);
        }
        let mean = scores.iter().sum::<f64>() / folds.max(1) as f64;
        let each: Vec<String> = scores.iter().map(|score| format!("{score:.4}")).collect();
        let losses = serde_json::to_string(&candidate.losses).unwrap_or_default().replace('"', "'");
        writeln!(table, "{i},{mean:.4},{},\"{losses}\"", each.join(","))?;
        println!("candidate {i}: {:.2} % of points keep their part ({})", 100.0 * mean, each.join(", "));
        means.push(mean);
    }
    Ok((0..means.len()).max_by(|&i, &j| means[i].total_cmp(&means[j])))
}

/// Keeps `settings` in `place`; what was made there by others is not gone on with.
fn begin_anew_unless_same(place: &Path, settings: &Value) -> io::Result<()> {
    let file = place.join("run.json");
    let known = fs::read(&file).ok().and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok());
    if known.as_ref() == Some(settings) {
        return Ok(());
    }
    for made in ["score", "state.safetensors"] {
        match fs::remove_file(place.join(made)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    fs::create_dir_all(place)?;
    fs::write(file, format!("{settings:#}\n"))
}

/// Mean share of points of one part, over pairs of bodies of the fold.
fn score(weights: &Weights, run: &RunConfig, pool: &Pool, fold: Fold) -> Result<f64, RunError> {
    let mut rng = ChaCha8Rng::seed_from_u64(fold.held as u64);
    let mut parameters = Parameters::from_weights(weights, rng.clone());
    let network: Network<Tensor> = Network::new(&weights.config, weights.category.parts.len(), &mut parameters)?;
    let held: Vec<usize> = (0..pool.count).filter(|&index| fold.holds(pool.body(index))).collect();
    let mut sum = 0.0;
    for _ in 0..PAIRS {
        let [a, b] = [0; 2].map(|_| held[rng.random_range(0..held.len())]);
        let pair = [&pool.get(a)?, &pool.get(b)?];
        let [on_a, on_b] = pair.map(|sample| embed(&network, sample));
        sum += Forward::new(&network, &run.losses, pair, [&on_a, &on_b], &mut rng).same_part(pair)?;
    }
    Ok(sum / PAIRS as f64)
}
