//! One side of run.mjs: reads paths of clouds (f64, n by 3) from stdin, answers each with the seconds that 120
//! eigenpairs took.

use std::io::BufRead;
use std::time::Instant;

use geose_fmap::operators::laplacian;
use geose_fmap::spectrum::spectrum;
use geose_fmap::{LaplacianKind, Progress, Shape};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for path in std::io::stdin().lock().lines() {
        let bytes = std::fs::read(path?)?;
        let numbers: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|&b| f64::from_le_bytes(b)).collect();
        let started = Instant::now();
        let shape = Shape::from_arrays(&numbers, &[], None)?;
        let l = laplacian(&shape, LaplacianKind::Geodesic, &mut Progress::silent())?;
        let built = started.elapsed().as_secs_f64();
        let (_, report) = spectrum(&l.matrix, &l.mass, 120, &mut Progress::silent())?;
        let seconds = started.elapsed().as_secs_f64();
        println!(r#"{{"seconds": {seconds}, "laplacian": {built}, "residual": {:e}}}"#, report.residual);
    }
    Ok(())
}
