//! `geose-fmap laplacian A -o l.mtx`: every point counts, whatever `--points` says.

use std::fmt::Write as _;

use super::map_file::check_folder;
use super::{Failure, PathBuf, Preparing, Progress, Running, read_scan, write};
use crate::operators::{default_kind, laplacian};

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scan.
    a: PathBuf,
    /// Matrix Market file for L, lower triangle; the mass goes beside it, one number a line, as NAME.mass.txt.
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten)]
    preparing: Preparing,
    #[command(flatten)]
    running: Running,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.running.check_cpu()?;
    arguments.preparing.check()?;
    check_folder(&arguments.output)?;
    let shape = read_scan(&arguments.a)?;
    let kind = arguments.preparing.laplacian.unwrap_or_else(|| default_kind(&shape));
    let built = laplacian(&shape, kind, &mut Progress::silent())?;
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
