//! A Laplacian and its spectrum, and nothing else: `cargo run --release --example spectrum -- SCAN`

use std::error::Error;

use geose_fmap::operators::{default_kind, laplacian};
use geose_fmap::spectrum::spectrum;
use geose_fmap::{Progress, read};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("a file is wanted")?;
    let shape = read(&std::fs::read(&path)?, Some(&path), None)?;
    let mut progress = Progress::silent();
    let built = laplacian(&shape, default_kind(&shape), &mut progress)?;
    let (basis, report) = spectrum(&built.matrix, &built.mass, 30, &mut progress)?;
    println!("{} Laplacian of {} points, area {:.6}", built.kind, built.len(), built.area());
    println!("largest residual {:.1e}", report.residual);
    for (i, eigenvalue) in basis.eigenvalues.iter().enumerate() {
        println!("{i:3} {eigenvalue:.6}");
    }
    Ok(())
}
