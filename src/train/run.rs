//! The training loop: one run, resumable at any step.
//!
//! A budget in minutes (`RunConfig::minutes`) is for comparisons at equal cost; what such a run learns depends on the machine, and it is not resumed. Where the
//! system tells, they are minutes of the processor, so that other work beside a run takes nothing from it.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::parameters::Parameters;
use super::pool::Pool;
pub use super::run_config::{Fold, RunConfig, Schedule};
use super::step::{Forward, embed_together};
use crate::network::{Category, ModelConfig, Network, Position, Weights, WeightsError};

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A file.
    #[error("{0}")]
    File(#[from] io::Error),
    /// Weights that do not fit.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// The autodiff library.
    #[error("{0}")]
    Tensor(#[from] candle_core::Error),
    /// Every gradient of many steps was not finite.
    #[error("the gradients were not finite for {0} steps in a row")]
    NotFinite(usize),
    /// No fold can be left out of so few bodies.
    #[error("{folds} folds of {bodies} bodies: there must be at least two folds, and two bodies in each")]
    Folds {
        /// How many folds.
        folds: usize,
        /// Of how many bodies.
        bodies: usize,
    },
}

/// Steps between lines of the log, and between checkpoints.
const LOG: usize = 20;
const CHECKPOINT: usize = 200;
/// Columns of the log after step, rate and seconds.
const MEANS: [&str; 12] = [
    "parts",
    "places",
    "extent",
    "semantic",
    "eigen",
    "features_orthogonal",
    "bijectivity",
    "orthogonality",
    "coupling",
    "part accuracy",
    "same part",
    "gradient",
];

/// Trains in `folder`, which holds `state.safetensors` to resume from, `log.csv`, and at the end `weights.safetensors` (f16). `start` are
/// weights to begin with instead of random ones. Stops when the run is complete (true) or `seconds` are over (false).
pub fn train(
    config: &ModelConfig,
    run: &RunConfig,
    pool: &Pool,
    folder: &Path,
    start: Option<&Weights>,
    seconds: f64,
) -> Result<bool, RunError> {
    if let Some(Fold { of: folds, .. }) = run.fold
        && (folds < 2 || pool.bodies() < 2 * folds)
    {
        return Err(RunError::Folds { folds, bodies: pool.bodies() });
    }
    fs::create_dir_all(folder)?;
    let state = folder.join("state.safetensors");
    let rng = ChaCha8Rng::seed_from_u64(run.seed);
    let saved = match fs::read(&state) {
        _ if run.minutes.is_some() => None,
        Ok(bytes) => Some(bytes),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    let resumed = saved.is_some();
    let mut parameters = match (saved, start) {
        (Some(bytes), _) => {
            let saved = Weights::from_bytes(&bytes)?;
            if saved.config != *config || saved.category != pool.category {
                return Err(WeightsError(format!("{} is of another network", state.display())).into());
            }
            Parameters::from_weights(&saved, rng)
        }
        (None, Some(weights)) => {
            let mut begun = Parameters::from_weights(weights, rng);
            begun.steps = 0;
            begun
        }
        (None, None) => Parameters::new(rng),
    };
    let network = Network::new(config, pool.category.parts.len(), &mut parameters)?;
    println!("{} parameters, at step {} of {}", parameters.count(), parameters.steps, run.steps);

    let began = Instant::now();
    let mut log = Log::open(&folder.join("log.csv"), resumed)?;
    let mut not_finite = 0;
    let mut step = parameters.steps;
    let budget = run.minutes.map(|minutes| 60.0 * minutes);
    let processor_before = processor_seconds();
    loop {
        let clock = began.elapsed().as_secs_f64();
        let spent = || processor_seconds().zip(processor_before).map_or(clock, |(now, before)| now - before);
        let done = budget.map_or(step as f64 / run.steps.max(1) as f64, |budget| spent() / budget);
        if done >= 1.0 {
            break;
        }
        pool.check()?;
        let mut rng = ChaCha8Rng::seed_from_u64(run.seed);
        rng.set_stream(1 + step as u64);
        let bodies = run.bodies_at(step, pool.count);
        let mut total = None;
        let mut samples = Vec::with_capacity(2 * run.batch);
        for _ in 0..2 * run.batch {
            let sample = pool.get(drawn(bodies, pool, run.fold, &mut rng))?;
            let mirrored = rng.random::<f64>() < run.mirrored && config.position == Position::Invariant;
            samples.push(if mirrored { sample.mirrored(&pool.category) } else { sample });
        }
        let (embeddings, statistics) = embed_together(&network, &samples.iter().collect::<Vec<_>>());
        for (pair, of_pair) in samples.as_chunks::<2>().0.iter().zip(embeddings.as_chunks::<2>().0) {
            let pair = pair.each_ref();
            let forward = Forward::new(&network, &run.losses, pair, of_pair.each_ref(), &mut rng);
            let terms = forward.losses(&run.losses, step >= run.maps_from)?;
            for (name, weight, term) in terms {
                log.add(name, f64::from(term.to_scalar::<f32>()?));
                let weighted = term.affine(weight / run.batch as f64, 0.0)?;
                total = Some(match total {
                    None => weighted,
                    Some(total) => (total + weighted)?,
                });
            }
            if step % LOG == 0 {
                log.add("part accuracy", forward.part_accuracy(pair));
                log.add("same part", forward.same_part(pair)?);
            }
        }
        let rate = run.rate_at(step, done as f32);
        if let Some(total) = total {
            let length = parameters.step(&total.backward()?, rate, run.decay, run.clip)?;
            not_finite = if length.is_finite() { 0 } else { not_finite + 1 };
            if not_finite > 50 {
                return Err(RunError::NotFinite(not_finite));
            }
            log.add("gradient", f64::from(length));
        }
        parameters.follow(&statistics, step)?;
        step += 1;
        parameters.steps = step;
        if step % LOG == 0 {
            log.write(step, rate, began.elapsed().as_secs_f64())?;
        }
        let over = clock > seconds;
        if step % CHECKPOINT == 0 || over {
            save(&state, &parameters.weights(config, &pool.category, true).to_bytes(false)?)?;
            finished(&parameters, config, &pool.category, run, folder)?;
        }
        if over {
            return Ok(step == run.steps);
        }
    }
    save(&state, &parameters.weights(config, &pool.category, true).to_bytes(false)?)?;
    finished(&parameters, config, &pool.category, run, folder)?;
    Ok(true)
}

/// One of the first `samples`, but none of the bodies left out.
fn drawn(samples: usize, pool: &Pool, fold: Option<Fold>, rng: &mut ChaCha8Rng) -> usize {
    loop {
        let index = rng.random_range(0..samples);
        if fold.is_none_or(|fold| !fold.holds(pool.body(index))) {
            return index;
        }
    }
}

/// Seconds of processor time that this program has had, in hundredths; `None` where there is no /proc.
fn processor_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the program's name, which may hold spaces: utime and stime are fields 14 and 15.
    let mut ticks = text.rsplit_once(')')?.1.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
    Some((ticks.next()?.ok()? + ticks.next()?.ok()?) / 100.0)
}

/// Writes the weights as they ship.
fn finished(
    parameters: &Parameters,
    config: &ModelConfig,
    category: &Category,
    run: &RunConfig,
    folder: &Path,
) -> Result<(), RunError> {
    let mut weights = parameters.weights(config, category, false);
    weights.about.extend([("name".to_owned(), run.name.clone()), ("version".to_owned(), run.version.clone())]);
    Ok(save(&folder.join("weights.safetensors"), &weights.to_bytes(true)?)?)
}

fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let partial: PathBuf = path.with_extension("partial");
    fs::write(&partial, bytes)?;
    fs::rename(partial, path)
}

/// Means since the last line, as comma-separated values under a head line.
struct Log {
    file: fs::File,
    sums: [(f64, usize); MEANS.len()],
}

impl Log {
    /// Goes on with the file where the run does.
    fn open(path: &Path, resumed: bool) -> io::Result<Self> {
        let mut file = fs::OpenOptions::new().create(true).write(true).append(resumed).truncate(!resumed).open(path)?;
        if file.metadata()?.len() == 0 {
            writeln!(file, "step,rate,seconds,{}", MEANS.join(","))?;
        }
        Ok(Self { file, sums: Default::default() })
    }

    fn add(&mut self, name: &str, value: f64) {
        let column = MEANS.iter().position(|&mean| mean == name).expect("every loss has its column");
        let (sum, count) = &mut self.sums[column];
        (*sum, *count) = (*sum + value, *count + 1);
    }

    fn write(&mut self, step: usize, rate: f32, seconds: f64) -> io::Result<()> {
        let mean =
            |(sum, count): (f64, usize)| if count > 0 { format!("{:.4}", sum / count as f64) } else { String::new() };
        let means = std::mem::take(&mut self.sums).map(mean);
        let known = MEANS.iter().zip(&means).filter(|(_, mean)| !mean.is_empty());
        let told: String = known.map(|(name, mean)| format!(",{name}={mean}")).collect();
        println!("step={step},rate={rate:.2e},seconds={seconds:.0}{told}");
        writeln!(self.file, "{step},{rate:.2e},{seconds:.0},{}", means.join(","))
    }
}
