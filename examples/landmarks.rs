//! Points known to belong together: `cargo run --release --example landmarks -- A B 17:20 400:391`

use std::error::Error;

use geose_fmap::{MatchOptions, Matcher, PrepareOptions, read};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [a, b, pairs @ ..] = &arguments[..] else { return Err("two files are wanted, then pairs i:j".into()) };
    let landmarks = pairs
        .iter()
        .map(|pair| {
            let (i, j) = pair.split_once(':').ok_or("a pair is i:j")?;
            Ok([i.parse()?, j.parse()?])
        })
        .collect::<Result<Vec<[u32; 2]>, Box<dyn Error>>>()?;

    let matcher = Matcher::new();
    let prepare = |path: &str| -> Result<_, Box<dyn Error>> {
        Ok(matcher.prepare(read(&std::fs::read(path)?, Some(path), None)?, &PrepareOptions::default())?)
    };
    let (a, b) = (prepare(a)?, prepare(b)?);
    let found = matcher.match_shapes(&a, &b, &MatchOptions { landmarks: landmarks.clone(), ..Default::default() })?;
    for [i, j] in landmarks {
        println!("{i} -> {} (wanted {j})", found.a_to_b.target[i as usize]);
    }
    // A landmark that the rest of the map contradicts is named.
    found.warnings.iter().for_each(|warning| println!("{}: {}", warning.code, warning.message));
    Ok(())
}
