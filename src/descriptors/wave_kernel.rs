//! The wave kernel signature (Aubry, Schlickewei & Cremers 2011): how likely a quantum particle of a given energy is at a point.

use ndarray::{Array2, Axis};

use super::PointFeatures;
use crate::spectrum::SpectralBasis;

/// Energies sampled, logarithmic in λ.
pub(crate) const ENERGIES: usize = 32;
/// Width of an energy band in steps between energies. The authors take 7 of their 100 steps; of 32, bands are three times as wide and overlap more.
const WIDTH: f64 = 7.0;

/// Invariant under isometries, rotation, scale and sign of eigenfunctions. Values (n, 32), normalised per column.
pub fn wave_kernel_signature(basis: &SpectralBasis) -> PointFeatures {
    let n = basis.len();
    // Null vectors carry no shape, and there may be several.
    let floor = 1e-6 * basis.eigenvalues.last().copied().unwrap_or(0.0);
    let shapely: Vec<usize> = (0..basis.k()).filter(|&j| basis.eigenvalues[j] > floor).collect();
    let (Some(&first), Some(&last)) = (shapely.first(), shapely.last()) else {
        return PointFeatures { values: Array2::zeros((n, ENERGIES)) };
    };
    // The topmost energies would see only half of their band.
    let low = basis.eigenvalues[first].ln();
    let step = 0.98 * (basis.eigenvalues[last].ln() - low) / (ENERGIES - 1) as f64;
    let sigma = WIDTH * step.abs().max(1e-9);
    let squares = basis.eigenvectors.mapv(|phi| phi * phi);
    let mut bands = Array2::zeros((basis.k(), ENERGIES));
    for e in 0..ENERGIES {
        let energy = low + step * e as f64;
        let weight = |j: &usize| (-(energy - basis.eigenvalues[*j].ln()).powi(2) / (2.0 * sigma * sigma)).exp();
        let total: f64 = shapely.iter().map(weight).sum();
        for j in &shapely {
            bands[(*j, e)] = weight(j) / total.max(f64::MIN_POSITIVE);
        }
    }
    let mut signature = squares.dot(&bands);
    let area: f64 = basis.mass.sum();
    for mut column in signature.axis_iter_mut(Axis(1)) {
        let mean = column.iter().zip(&basis.mass).map(|(v, m)| v * m).sum::<f64>() / area;
        column -= mean;
        let variance = column.iter().zip(&basis.mass).map(|(v, m)| v * v * m).sum::<f64>() / area;
        let inverse = if variance > 0.0 { variance.sqrt().recip() } else { 0.0 };
        column *= inverse;
    }
    PointFeatures { values: signature.mapv(|v| v as f32) }
}
