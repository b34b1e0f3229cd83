//! Two scans from files, and the map as CSV: `cargo run --release --example two_files -- A B > map.csv`

use std::error::Error;
use std::path::Path;

use geose_fmap::{MatchOptions, Matcher, PrepareOptions, PreparedShape, Progress, Stage, UNMATCHED, read};

fn prepared(matcher: &Matcher, path: &str) -> Result<PreparedShape, Box<dyn Error>> {
    let name = Path::new(path).file_name().map(|name| name.to_string_lossy().into_owned());
    let shape = read(&std::fs::read(path)?, name.as_deref(), None)?;
    let mut options = PrepareOptions { name, ..PrepareOptions::default() };
    options.progress = Progress::listener(|stage: Stage, fraction| {
        eprint!("\r{:<16}{:3.0} %", stage.name(), 100.0 * fraction);
        true // false would stop it
    });
    let prepared = matcher.prepare(shape, &options)?;
    eprintln!();
    prepared.repairs.iter().for_each(|repair| eprintln!("note: {}", repair.message));
    Ok(prepared)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let (Some(a), Some(b)) = (paths.next(), paths.next()) else { return Err("two files are wanted".into()) };
    let matcher = Matcher::new();
    let (a, b) = (prepared(&matcher, &a)?, prepared(&matcher, &b)?);
    let found = matcher.match_shapes(&a, &b, &MatchOptions::default())?;
    println!("source,target,confidence");
    for (source, (&target, confidence)) in found.a_to_b.target.iter().zip(&found.a_to_b.confidence).enumerate() {
        match target {
            UNMATCHED => println!("{source},,0"),
            target => println!("{source},{target},{confidence}"),
        }
    }
    found.warnings.iter().for_each(|warning| eprintln!("{}: {}", warning.code, warning.message));
    Ok(())
}
