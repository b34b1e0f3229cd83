//! Scans that bring part labels (a PLY property `label`, or an array): points stay in their part. `cargo run --release --example given_parts -- A B`

use std::error::Error;

use geose_fmap::{MatchOptions, Matcher, Parts, PrepareOptions, read};

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let (Some(a), Some(b)) = (paths.next(), paths.next()) else { return Err("two labelled files are wanted".into()) };
    let matcher = Matcher::new();
    let prepare = |path: &str| -> Result<_, Box<dyn Error>> {
        Ok(matcher.prepare(read(&std::fs::read(path)?, Some(path), None)?, &PrepareOptions::default())?)
    };
    let (a, b) = (prepare(&a)?, prepare(&b)?);
    let found = matcher.match_shapes(&a, &b, &MatchOptions { parts: Parts::Given, ..Default::default() })?;
    let (of_a, of_b) = (a.shape.labels().ok_or("no labels")?, b.shape.labels().ok_or("no labels")?);
    let kept = found.a_to_b.target.iter().zip(of_a).filter(|&(&j, label)| of_b.get(j as usize) == Some(label)).count();
    println!("{kept} of {} points go to their own part", of_a.len());
    Ok(())
}
