//! The command line's verbs over the library; native only.

mod arguments;
mod colour;
mod evaluate;
mod info;
mod laplacian;
mod map_file;
mod matching;
mod scan_file;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use arguments::WrongUse;

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
