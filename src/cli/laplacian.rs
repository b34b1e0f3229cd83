//! `geose-fmap laplacian A -o l.mtx`: every point counts, whatever `--points` says.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::arguments::{Failure, Preparing, Running, WrongUse, write};
use super::map_file::check_folder;
use super::scan_file::{Reading, read_scan};
use crate::operators::{LaplacianBuilder, OperatorError, default_kind};
use crate::pipeline::OptionError;
use crate::progress::Progress;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scan.
    a: PathBuf,
    /// Matrix Market file for L, lower triangle; the mass goes beside it, one number a line, as NAME.mass.txt.
    #[arg(short, long)]
    output: PathBuf,
    /// k₀ of Algorithm 1: neighbours in the graph that geodesics start from (geodesic kinds).
    #[arg(long)]
    k0: Option<usize>,
    /// k of Algorithm 1: candidate neighbours (all kinds but cotangent).
    #[arg(long)]
    k: Option<usize>,
    /// τ of Algorithm 1: a candidate stays while geodesic / Euclidean distance is below (geodesic kinds).
    #[arg(long)]
    tau: Option<f64>,
    /// T of Algorithm 1: rounds in which candidates are considered (geodesic kinds).
    #[arg(long)]
    iterations: Option<usize>,
    /// σ of the weights in units of the scan, by default the mean distance to the k neighbours (gaussian and geodesic-literal).
    #[arg(long)]
    sigma: Option<f64>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    preparing: Preparing,
    #[command(flatten)]
    running: Running,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.running.check_cpu()?;
    arguments.preparing.check()?;
    let builder = |kind| {
        LaplacianBuilder::new(kind)
            .initial_neighbours(arguments.k0)
            .neighbours(arguments.k)
            .ratio(arguments.tau)
            .iterations(arguments.iterations)
            .sigma(arguments.sigma)
    };
    // What can be told to be wrong before the scan is read is.
    arguments.preparing.laplacian.map_or(Ok(()), |kind| builder(kind).check()).map_err(failure)?;
    check_folder(&arguments.output)?;
    let shape = read_scan(&arguments.a, arguments.reading)?;
    let kind = arguments.preparing.laplacian.unwrap_or_else(|| default_kind(&shape));
    let built = builder(kind).build(&shape, &mut Progress::silent()).map_err(failure)?;
    let lower = || built.matrix.iter().filter(|&(_, (i, j))| i >= j);
    let n = built.len();
    let mut text = String::from("%%MatrixMarket matrix coordinate real symmetric\n");
    writeln!(text, "{n} {n} {}", lower().count())?;
    for (value, (i, j)) in lower() {
        writeln!(text, "{} {} {value:e}", i + 1, j + 1)?;
    }
    write(&arguments.output, &text)?;
    let mut masses = String::new();
    for mass in &built.mass {
        writeln!(masses, "{mass:e}")?;
    }
    write(&arguments.output.with_extension("mass.txt"), &masses)
}

/// An option that this kind of Laplacian does not have is wrong use.
fn failure(error: OperatorError) -> Failure {
    match error {
        OperatorError::InvalidOption { message, .. } => WrongUse(OptionError::invalid(message)).into(),
        error => error.into(),
    }
}
