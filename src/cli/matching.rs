//! `geose-fmap match A B -o map.csv`

use std::fmt::Write as _;

use super::{Failure, Match, PathBuf, Preparing, Running, parse, prepare_scan, write};
use crate::{Cpu, MatchOptions, Parts, Progress, Refinement, UNMATCHED, match_shapes};

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scan whose points are matched.
    a: PathBuf,
    /// The scan they are matched to.
    b: PathBuf,
    /// Where the map goes: header source,target,confidence; an unmatched point has an empty target.
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten)]
    preparing: Preparing,
    /// none, zoomout or best.
    #[arg(long, default_value = "best", value_parser = parse::<Refinement>)]
    refine: Refinement,
    /// predicted, given or none.
    #[arg(long, default_value = "none", value_parser = parse::<Parts>)]
    parts: Parts,
    #[command(flatten)]
    running: Running,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.running.check()?;
    let a = prepare_scan(&arguments.a, &arguments.preparing)?;
    let b = prepare_scan(&arguments.b, &arguments.preparing)?;
    let options = MatchOptions { parts: arguments.parts, refine: arguments.refine, ..Default::default() };
    let matched = pollster::block_on(match_shapes(&Cpu, &a, &b, &options, &mut Progress::silent()))?;
    write(&arguments.output, &csv(&matched)?)?;
    for (stage, seconds) in &matched.seconds {
        eprintln!("{stage}: {seconds:.3} s");
    }
    for warning in &matched.warnings {
        eprintln!("note: {warning}");
    }
    Ok(())
}

fn csv(matched: &Match) -> Result<String, Failure> {
    let mut text = String::from("source,target,confidence\n");
    for (source, (&target, confidence)) in matched.a_to_b.target.iter().zip(&matched.a_to_b.confidence).enumerate() {
        match target {
            UNMATCHED => writeln!(text, "{source},,0")?,
            target => writeln!(text, "{source},{target},{confidence}")?,
        }
    }
    Ok(text)
}
