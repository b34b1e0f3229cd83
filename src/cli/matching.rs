//! `geose-fmap match A B -o map.csv`

use std::path::PathBuf;

use super::arguments::{Failure, Preparing, Running, parse};
use super::map_file::{MapFile, Outcome};
use super::scan_file::{Reading, prepare_scan};
use crate::maps::UNMATCHED;
use crate::pipeline::{MatchOptions, Parts};
use crate::progress::{Progress, Stage};
use crate::registration::Refinement;

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scan whose points are matched.
    a: PathBuf,
    /// The scan they are matched to.
    b: PathBuf,
    /// Where the map goes. As .csv: header source,target,confidence; an unmatched point has an empty target. As .json: the same with what it
    /// was made from. As .ply or .glb: A in the colours of the places on B that its points are matched with, and beside it B, as NAME.b.ply.
    #[arg(short, long, value_parser = MapFile::parse)]
    output: MapFile,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    preparing: Preparing,
    /// none, zoomout or best.
    #[arg(long, default_value = "best", value_parser = parse::<Refinement>)]
    refine: Refinement,
    /// predicted, given or none.
    #[arg(long, default_value = "predicted", value_parser = parse::<Parts>)]
    parts: Parts,
    /// Points known to belong together, by index as uploaded: 17:20,400:391.
    #[arg(long, value_delimiter = ',', value_parser = pair)]
    landmarks: Vec<[u32; 2]>,
    #[command(flatten)]
    running: Running,
}

/// `i:j`, a point of A and its point of B.
fn pair(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once(':').and_then(|(i, j)| Some([i.trim().parse().ok()?, j.trim().parse().ok()?]));
    numbers.ok_or_else(|| "a landmark is two indices, i:j".to_owned())
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.output.check(&[&arguments.a, &arguments.b])?;
    let mut on = arguments.running.processor()?;
    let a = prepare_scan(&arguments.a, arguments.reading, &arguments.preparing, &mut on)?;
    let b = prepare_scan(&arguments.b, arguments.reading, &arguments.preparing, &mut on)?;
    let Arguments { parts, refine, ref landmarks, .. } = *arguments;
    let options = MatchOptions { parts, refine, landmarks: landmarks.clone(), ..Default::default() };
    let matched = pollster::block_on(on.match_shapes(&a, &b, &options, &mut Progress::silent()))?;
    let preparing = &arguments.preparing.options();
    arguments.output.write(&Outcome { a: &a, b: &b, preparing, options: &options, matched: &matched })?;
    let (target, confidence) = (&matched.a_to_b.target, &matched.a_to_b.confidence);
    let found = target.iter().filter(|&&target| target != UNMATCHED).count();
    let sure = confidence.iter().filter(|&&confidence| confidence >= 0.5).count();
    eprintln!("{found} of {} points matched, {sure} of them with a confidence of 0.5 or more", target.len());
    if let Some(adapter) = &on.info().adapter {
        eprintln!("device: {adapter}");
    }
    if let Some(fallback) = &matched.fallback {
        eprintln!("note: from stage {} on the CPU did the work: {}", fallback.stage.name(), fallback.reason);
    }
    for (scan, prepared) in [("A", &a), ("B", &b)] {
        eprintln!("scan {scan} prepared: {:.3} s", prepared.info.seconds.values().sum::<f64>());
        if let Some(extent) = prepared.extent() {
            eprintln!("scan {scan} is a piece: {extent}");
        }
    }
    for stage in [Stage::FunctionalMap, Stage::Refine, Stage::Correspondence].map(Stage::name) {
        eprintln!("{stage}: {:.3} s", matched.seconds.get(stage).copied().unwrap_or_default());
    }
    for (scan, prepared) in [("A", &a), ("B", &b)] {
        prepared.repairs.iter().for_each(|repair| eprintln!("note on scan {scan}: {}", repair.message));
    }
    for warning in &matched.warnings {
        eprintln!("note: {}", warning.message);
    }
    Ok(())
}
