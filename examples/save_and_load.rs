//! A prepared scan as bytes, and back: `cargo run --release --example save_and_load -- SCAN PREPARED`

use std::error::Error;

use geose_fmap::{MatchOptions, Matcher, PrepareOptions, PreparedShape, read};

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let (Some(scan), Some(stored)) = (paths.next(), paths.next()) else { return Err("two paths are wanted".into()) };
    let matcher = Matcher::new();
    let prepared = matcher.prepare(read(&std::fs::read(&scan)?, Some(&scan), None)?, &PrepareOptions::default())?;
    std::fs::write(&stored, prepared.to_bytes()?)?;

    let loaded = PreparedShape::from_bytes(&std::fs::read(&stored)?)?;
    let found = matcher.match_shapes(&prepared, &loaded, &MatchOptions::default())?;
    let itself = found.a_to_b.target.iter().enumerate().filter(|&(i, &j)| i == j as usize).count();
    println!("{itself} of {} points of the stored scan are their own match", found.a_to_b.target.len());
    Ok(())
}
