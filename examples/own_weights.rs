//! Weights of one's own in place of those that ship: `cargo run --release --example own_weights -- WEIGHTS A B`

use std::error::Error;

use geose_fmap::{MatchOptions, Matcher, PrepareOptions, Weights, read};

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let mut next = || paths.next().ok_or("a file of weights and two scans are wanted");
    let weights = Weights::from_bytes(&std::fs::read(next()?)?)?;
    println!("{}, which knows {}: {}", weights.id(), weights.category.name, weights.category.part_names().join(", "));
    let matcher = Matcher::with_weights([weights])?;
    let mut prepare = || -> Result<_, Box<dyn Error>> {
        let path = next()?;
        Ok(matcher.prepare(read(&std::fs::read(&path)?, Some(&path), None)?, &PrepareOptions::default())?)
    };
    let (a, b) = (prepare()?, prepare()?);
    let found = matcher.match_shapes(&a, &b, &MatchOptions::default())?;
    println!("taken for: {}", found.category.as_deref().unwrap_or("nothing that it knows"));
    Ok(())
}
