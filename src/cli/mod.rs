//! The command line's verbs over the library; native only.

mod colour;
mod evaluate;
mod info;
mod laplacian;
mod map_file;
mod matching;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use clap::{Args, Parser, Subcommand};

use crate::network::Model;
use crate::network::Weights;
use crate::operators::LaplacianKind;
use crate::pipeline::{DeviceChoice, OptionError, Processor};
use crate::pipeline::{PrepareOptions, PreparedShape};
use crate::progress::{Progress, Stage};
use crate::read::read;
use crate::shape::{Axis, Shape};

/// Which point of one deformable 3D scan is which point of the other.
#[derive(Parser)]
#[command(name = "geose-fmap", version)]
struct CommandLine {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Matches every point of A to a point of B.
    Match(matching::Arguments),
    /// Says what a scan is and what was found odd about it.
    Info(info::Arguments),
    /// Measures the method on a data set with ground truth.
    Evaluate(evaluate::Arguments),
    /// Writes the Laplacian of a scan, every point counting.
    Laplacian(laplacian::Arguments),
}

/// Options that prepare a scan.
#[derive(Args, Clone, Debug)]
struct Preparing {
    /// Points that take part in the matching; up to 1.5 times as many stay whole.
    #[arg(long, default_value_t = 5000)]
    points: usize,
    /// Eigenpairs of the basis.
    #[arg(long, default_value_t = 120)]
    eigenpairs: usize,
    /// geodesic, geodesic-literal, euclidean, gaussian or cotangent; by default cotangent on meshes and geodesic on clouds.
    #[arg(long)]
    laplacian: Option<LaplacianKind>,
    /// The axis that points up: x, y or z.
    #[arg(long, value_parser = parse::<Axis>)]
    up: Option<Axis>,
}

impl Preparing {
    fn options(&self) -> PrepareOptions {
        PrepareOptions {
            points: self.points,
            eigenpairs: self.eigenpairs,
            laplacian: self.laplacian,
            up: self.up,
            ..Default::default()
        }
    }
}

impl Preparing {
    /// Refuses what is out of range, before anything is read.
    fn check(&self) -> Result<(), Failure> {
        Ok(self.options().check().map_err(WrongUse)?)
    }
}

/// Options on what a program runs with.
#[derive(Args, Clone, Debug)]
struct Running {
    /// What computes: auto, cpu or webgpu.
    #[arg(long, default_value = "auto", value_parser = parse::<DeviceChoice>)]
    device: DeviceChoice,
    /// Network weights in place of the built-in ones.
    #[arg(long)]
    weights: Option<PathBuf>,
    /// Seed of whatever is random; a match has nothing random in it.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

impl Running {
    /// The device of choice, with the network.
    fn processor(&self) -> Result<Processor, Failure> {
        Ok(pollster::block_on(Processor::open(self.model()?, self.device))?)
    }

    /// For what runs on the processor only.
    fn check_cpu(&self) -> Result<(), Failure> {
        match self.device {
            DeviceChoice::Webgpu => Err("this runs on the CPU only: use --device auto or cpu".into()),
            DeviceChoice::Auto | DeviceChoice::Cpu => Ok(()),
        }
    }

    /// The network.
    fn model(&self) -> Result<Arc<Model>, Failure> {
        let Some(path) = &self.weights else { return Ok(Model::embedded().clone()) };
        let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let model = Weights::from_bytes(&bytes).and_then(Model::new).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Arc::new(model))
    }
}

/// What went wrong, in a sentence.
type Failure = Box<dyn std::error::Error>;

/// An option that can be told to be wrong before anything is read.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
struct WrongUse(#[from] OptionError);

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    // clap prints what is wrong with the use and leaves with 2.
    let outcome = match CommandLine::parse().verb {
        Verb::Match(arguments) => matching::run(&arguments),
        Verb::Info(arguments) => info::run(&arguments),
        Verb::Evaluate(arguments) => evaluate::run(&arguments),
        Verb::Laplacian(arguments) => laplacian::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("geose-fmap: {failure}");
            if failure.is::<WrongUse>() { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}

/// A name as the options of the library spell it.
fn parse<T: serde::de::DeserializeOwned>(name: &str) -> Result<T, String> {
    serde_json::from_value(name.into()).map_err(|e| e.to_string())
}

fn read_scan(path: &Path) -> Result<Shape, Failure> {
    let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    Ok(read(&bytes, name.as_deref(), None).map_err(|e| format!("{}: {e}", path.display()))?)
}

fn prepare_scan(path: &Path, preparing: &Preparing, on: &mut Processor) -> Result<PreparedShape, Failure> {
    preparing.check()?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut progress = Progress::silent();
    progress.at(Stage::Read, 0.0)?;
    let shape = read_scan(path)?;
    Ok(pollster::block_on(on.prepare(shape, name, &preparing.options(), &mut progress))
        .map_err(|e| format!("{}: {e}", path.display()))?)
}

/// Writes a file and says so: some verbs write two.
fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
    std::fs::write(path, contents).map_err(|e| format!("{}: {e}", path.display()))?;
    eprintln!("written: {}", path.display());
    Ok(())
}
