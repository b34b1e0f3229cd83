//! `geose-fmap evaluate --dataset DIR --mode mesh|cloud|mesh-cloud`

use std::path::{Path, PathBuf};

use super::arguments::{Failure, Preparing, Running, parse, write};
use super::map_file::check_folder;
use crate::evaluate::{Mode, Rotate, Task, evaluate};
use crate::pipeline::Parts;
use crate::registration::Refinement;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Folder of the set: shapes/, pairs.txt, corres/, labels/.
    #[arg(long)]
    dataset: PathBuf,
    /// mesh: with faces; cloud: all faces dropped; mesh-cloud: those of the second shape dropped.
    #[arg(long, value_parser = parse::<Mode>)]
    mode: Mode,
    /// A file of pairs `A B`, one a line, in place of the set's own.
    #[arg(long)]
    pairs: Option<PathBuf>,
    /// Only that many pairs, a fair sample: those whose lines come first by a hash. Shapes where the set has no pairs.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    limit: Option<u32>,
    /// none, zoomout or best.
    #[arg(long, default_value = "best", value_parser = parse::<Refinement>)]
    refine: Refinement,
    /// predicted, given or none.
    #[arg(long, default_value = "predicted", value_parser = parse::<Parts>)]
    parts: Parts,
    /// Measures the network's maps also where maps made without it compete otherwise, as on animals.
    #[arg(long, conflicts_with = "oracle")]
    network_only: bool,
    /// A random rotation per shape: none, up (about --up, by default y) or so3.
    #[arg(long, default_value = "none", value_parser = parse::<Rotate>)]
    rotate: Rotate,
    /// Measures the functional map of the true match, without refinement or parts: what the bases can do at best.
    #[arg(long)]
    oracle: bool,
    /// Where the measurements go as JSON; - is standard output, which then has nothing else.
    #[arg(long)]
    json: Option<PathBuf>,
    #[command(flatten)]
    preparing: Preparing,
    #[command(flatten)]
    running: Running,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.running.check_cpu()?;
    arguments.preparing.check()?;
    // Measuring may take hours; that the result has nowhere to go should not show at their end.
    arguments.json.as_deref().map_or(Ok(()), check_folder)?;
    let task = Task {
        dataset: arguments.dataset.clone(),
        pairs: arguments.pairs.clone(),
        limit: arguments.limit.map(|limit| limit as usize),
        mode: arguments.mode,
        preparing: arguments.preparing.options(),
        parts: arguments.parts,
        refine: arguments.refine,
        network_only: arguments.network_only,
        rotate: arguments.rotate,
        seed: arguments.running.seed,
        oracle: arguments.oracle,
    };
    let measured = evaluate(&task, &*arguments.running.model()?, &|line| eprintln!("{line}"))?;
    let json = || serde_json::to_string_pretty(&measured);
    match arguments.json.as_deref() {
        Some(file) if file == Path::new("-") => println!("{}", json()?),
        file => {
            println!("{measured}");
            file.map_or(Ok(()), |file| write(file, &(json()? + "\n")))?;
        }
    }
    Ok(())
}
