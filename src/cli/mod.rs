//! The command line's verbs over the library; native only.

mod info;
mod laplacian;
mod map_file;
mod matching;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::{LaplacianKind, PrepareOptions, PreparedShape, Progress, Shape, Stage, prepare, read};

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
    /// geodesic, geodesic-literal, euclidean or cotangent; by default cotangent on meshes and geodesic on clouds.
    #[arg(long)]
    laplacian: Option<LaplacianKind>,
}

impl Preparing {
    fn options(&self) -> PrepareOptions {
        PrepareOptions {
            points: self.points,
            eigenpairs: self.eigenpairs,
            laplacian: self.laplacian,
            ..Default::default()
        }
    }
}

/// What went wrong, in a sentence.
type Failure = Box<dyn std::error::Error>;

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    // clap prints what is wrong with the use and leaves with 2.
    let outcome = match CommandLine::parse().verb {
        Verb::Match(arguments) => matching::run(&arguments),
        Verb::Info(arguments) => info::run(&arguments),
        Verb::Laplacian(arguments) => laplacian::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("geose-fmap: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn read_scan(path: &Path) -> Result<Shape, Failure> {
    let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    Ok(read(&bytes, name.as_deref(), None).map_err(|e| format!("{}: {e}", path.display()))?)
}

fn prepare_scan(path: &Path, preparing: &Preparing) -> Result<PreparedShape, Failure> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut progress = Progress::silent();
    progress.at(Stage::Read, 0.0)?;
    let shape = read_scan(path)?;
    Ok(prepare(shape, name, &preparing.options(), &mut progress).map_err(|e| format!("{}: {e}", path.display()))?)
}

fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
    std::fs::write(path, contents).map_err(|e| format!("{}: {e}", path.display()).into())
}
