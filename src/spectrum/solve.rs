//! The first eigenpairs of L φ = λ M φ, with proof that none is missing.

use std::borrow::Cow;

use faer::prelude::ReborrowMut;
use faer::{Mat, MatMut, MatRef};
use ndarray::{Array1, Array2};
use serde::Serialize;
use sprs::CsMat;

use super::dense::smallest_eigenpairs;
use super::factor::{Factor, Pencil};
use super::lanczos::Lanczos;
use super::problem::{active_points, restrict, scales};
use super::signs::make_canonical;
use super::sweeps::LANES;
use super::{SpectralBasis, SpectrumError};
use crate::graph::components;
use crate::progress::{Progress, Stage};

/// Columns that are solved for, orthogonalised and found together.
const BLOCK: usize = LANES;
/// Largest problem whose whole spectrum is computed at once.
const DENSE: usize = 300;
/// Residual of every pair, in the M⁻¹ norm and relative to the largest eigenvalue asked for.
const RESIDUAL: f64 = 1e-6;
/// The same, of Ritz pairs: a digit below what is promised.
const RITZ_RESIDUAL: f64 = 1e-7;
/// An eigenvalue below this multiple of the mean of all is held against that instead of itself, because 1e-6 of it is rounding: pieces that
/// hang together by next to nothing, or more of them than eigenpairs.
const ROUNDING: f64 = 1e-8;
/// Share of the eigenvalues asked for that the shift is to have below it.
const BELOW: f64 = 0.6;
/// Shifts tried before a safe one is taken; ordinary shapes need one or two.
const GUESSES: usize = 24;
/// Restarts before giving up; ordinary shapes need none or one.
const RESTARTS: usize = 60;

/// How the eigenpairs were found and how good they are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpectrumReport {
    /// Solves with the factorised matrix, in blocks.
    pub applications: usize,
    /// Thick restarts.
    pub restarts: usize,
    /// Largest ‖Lφ − λMφ‖ in the M⁻¹ norm, divided by the largest eigenvalue found.
    pub residual: f64,
    /// Connected pieces, each with an eigenvalue zero of its own.
    pub pieces: usize,
    /// True when the inertia of L − μM, μ just under the last eigenvalue, proved that none below was missed.
    pub complete: bool,
}

/// The `eigenpairs` smallest eigenpairs of L φ = λ M φ, or n − 2 where there are not so many points.
///
/// L (n, n) is symmetric positive semi-definite with a full diagonal, `mass` (n) its lumped mass. Points without mass and
/// without entries (vertices no face uses) take no part: their eigenfunctions are zero. ΦᵀMΦ = I to 1e-8 and every
/// residual is within 1e-6 of the largest eigenvalue, or it is an error. The same input gives the same bytes.
///
/// Shift-inverted block Lanczos; the null vectors of the connected pieces are known and start the basis.
pub fn spectrum(
    matrix: &CsMat<f64>,
    mass: &[f64],
    eigenpairs: usize,
    progress: &mut Progress,
) -> Result<(SpectralBasis, SpectrumReport), SpectrumError> {
    progress.at(Stage::Spectrum, 0.0)?;
    let n = mass.len();
    if eigenpairs == 0 {
        return Err(SpectrumError::NoEigenpairs);
    }
    let active = active_points(matrix, mass)?;
    let k = eigenpairs.min(n.saturating_sub(2)).min(active.len().saturating_sub(2));
    if k == 0 {
        return Err(SpectrumError::TooFewPoints { found: active.len() });
    }
    let (mut matrix, mut mass_of_active) = restrict(matrix, mass, &active);
    let (weight, root_mass) = scales(&matrix, &mass_of_active);
    matrix.map_inplace(|value| value / weight);
    mass_of_active.iter_mut().for_each(|m| *m /= root_mass * root_mass);
    let (eigenvalues, vectors, report) = solve(&matrix, &mass_of_active, k, progress)?;
    let mut eigenvectors = Array2::zeros((n, k));
    for (row, &i) in active.iter().enumerate() {
        for j in 0..k {
            eigenvectors[(i, j)] = vectors[(row, j)] / root_mass;
        }
    }
    let eigenvalues = Array1::from(eigenvalues) * (weight / (root_mass * root_mass));
    let basis = SpectralBasis { eigenvalues, eigenvectors, mass: Array1::from(mass.to_vec()) };
    progress.at(Stage::Spectrum, 1.0)?;
    Ok((basis, report))
}

/// Columns of the Lanczos basis for k eigenpairs.
fn subspace(k: usize) -> usize {
    (2 * k + 10 * BLOCK).max(40)
}

/// Bytes that k eigenpairs of n points take, or the error that they are too many: known before there is a matrix.
pub(crate) fn check_size(n: usize, k: usize) -> Result<u64, SpectrumError> {
    let k = k.min(n);
    let bytes = (n as u64) * (subspace(k) + 2 * k + 4 * BLOCK) as u64 * 8;
    if bytes > u64::from(u32::MAX) / 2 {
        return Err(SpectrumError::TooLarge { eigenpairs: k, points: n, bytes });
    }
    Ok(bytes)
}

fn solve(
    matrix: &CsMat<f64>,
    mass: &[f64],
    k: usize,
    progress: &mut Progress,
) -> Result<(Vec<f64>, Mat<f64>, SpectrumReport), SpectrumError> {
    let n = mass.len();
    let root_mass: Vec<f64> = mass.iter().map(|m| m.sqrt()).collect();
    let edges = matrix.iter().filter(|&(&value, _)| value != 0.0).map(|(_, (i, j))| (i as u32, j as u32));
    let (piece, pieces) = components(n, edges);
    let mean = mean_eigenvalue(matrix, mass);
    let known = null_vectors(matrix, &root_mass, &piece, pieces, k, mean);
    if known.ncols() == k {
        let report = SpectrumReport { applications: 0, restarts: 0, residual: 0.0, pieces, complete: true };
        return finish(matrix, mass, &root_mass, vec![0.0; k], known, report);
    }
    let subspace = subspace(k);
    let dense_bytes = 3 * (n as u64).pow(2) * 8;
    let dense_fits = dense_bytes <= u64::from(u32::MAX) / 2;
    if n <= DENSE || (subspace + 2 * BLOCK >= n && dense_fits) {
        let (values, vectors) = smallest_eigenpairs(matrix, &root_mass, k).ok_or(SpectrumError::NotFactorised)?;
        let report = SpectrumReport { applications: 0, restarts: 0, residual: 0.0, pieces, complete: true };
        return finish(matrix, mass, &root_mass, values, vectors, report);
    }
    if subspace + 2 * BLOCK >= n {
        return Err(SpectrumError::TooLarge { eigenpairs: k, points: n, bytes: dense_bytes });
    }
    check_size(n, k)?;

    let pencil = Pencil::new(Cow::Borrowed(matrix), Cow::Borrowed(mass)).ok_or(SpectrumError::NotFactorised)?;
    let (mut factor, mu) = shifted(&pencil, &root_mass, mean, known.ncols(), k).ok_or(SpectrumError::NotFactorised)?;
    let rounding = (RESIDUAL * mu.abs()).max(ROUNDING * mean);
    let definite = || pencil.factor(rounding).is_some_and(|factor| factor.negative_pivots() == 0);
    if !diagonally_dominant(matrix, mass, mean) && !definite() {
        return Err(SpectrumError::NotFactorised);
    }
    progress.at(Stage::Spectrum, 0.1)?;

    let apply = |columns: MatMut<'_, f64>| apply_inverse(&mut factor, &root_mass, columns);
    let capacity = subspace + known.ncols();
    let mut lanczos = Lanczos::new(apply, known.as_ref(), -1.0 / mu, BLOCK, capacity);
    let mut report = SpectrumReport { applications: 0, restarts: 0, residual: 0.0, pieces, complete: false };
    let mut next_look = lanczos.applied() + k / 5 * 9 + 2 * BLOCK;
    let mut share = 0.0_f64;
    let (values, ritz, wanted) = loop {
        while lanczos.has_room() && lanczos.applied() < next_look {
            lanczos.step();
            // A restart falls back, which is nothing to show.
            share = share.max(lanczos.applied() as f64 / capacity as f64);
            progress.at(Stage::Spectrum, 0.1 + 0.7 * share)?;
        }
        next_look = lanczos.applied() + (k / 10).max(2 * BLOCK);
        let ritz = lanczos.ritz().ok_or(SpectrumError::NotFactorised)?;
        let lambda = |j: usize| mu + 1.0 / ritz.values[j];
        let mut wanted = smallest(ritz.values.len(), lambda, mean);
        let others = wanted.split_off(k.min(wanted.len()));
        let largest = wanted.last().map_or(0.0, |&j| lambda(j)).max(ROUNDING * mean);
        // Of the pair as it will be returned, ‖Lφ − λMφ‖ is ‖r‖/θ².
        let residual = |j: usize| ritz.residuals[j] / (ritz.values[j] * ritz.values[j]) / largest;
        let converged = wanted.iter().filter(|&&j| residual(j) <= RITZ_RESIDUAL).count();
        let worst = wanted.iter().map(|&j| residual(j)).fold(0.0, f64::max);
        if converged == k {
            let eigenvalues: Vec<f64> = wanted.iter().map(|&j| lambda(j)).collect();
            match missed(&pencil, &eigenvalues, mean) {
                Some(0) => report.complete = true,
                Some(_) if report.restarts < RESTARTS => {
                    report.restarts += 1;
                    lanczos.restart(&ritz, &wanted, true);
                    next_look = lanczos.applied() + k / 2 + 4 * BLOCK;
                    continue;
                }
                Some(missed) => {
                    return Err(SpectrumError::NotConverged {
                        converged: k - missed.min(k),
                        wanted: k,
                        residual: worst,
                    });
                }
                None => {}
            }
            break (eigenvalues, ritz, wanted);
        }
        if !lanczos.has_room() {
            if report.restarts == RESTARTS {
                return Err(SpectrumError::NotConverged { converged, wanted: k, residual: worst });
            }
            report.restarts += 1;
            wanted.extend(&others[..others.len().min(lanczos.applied().saturating_sub(k) / 3)]);
            lanczos.restart(&ritz, &wanted, false);
            next_look = lanczos.applied() + k / 3;
        }
    };
    report.applications = lanczos.applications;
    progress.at(Stage::Spectrum, 0.9)?;
    let found = finish(matrix, mass, &root_mass, values.clone(), lanczos.vectors(&ritz, &wanted), report);
    let Err(SpectrumError::NotConverged { .. }) = found else { return found };
    // Where triangles differ in size by orders of magnitude, L amplifies the least trace of high frequency. One more solve removes it.
    let mut vectors = lanczos.vectors(&ritz, &wanted);
    apply_inverse(&mut factor, &root_mass, vectors.as_mut());
    finish(matrix, mass, &root_mass, values, vectors.qr().compute_thin_Q(), report)
}

/// Factors L − μM with μ within the eigenvalues asked for, `known` of which are zeros.
///
/// From there both ends of what is wanted are about equally far, half as far as from zero. For 120 pairs of a cloud of 5000 points
/// μ above [`BELOW`] of them takes 220 columns, above a half 240, above a quarter 280, and just under zero more than 300 and a restart.
///
/// By Weyl's law eigenvalues grow linearly, steeper beside their mean where points have more neighbours: the guess is right on
/// clouds with 20 of them and on triangles with 6. A few needles or a patch of tiny triangles raise the mean out of all
/// proportion, so the guess is corrected by how many eigenvalues turn out to lie below it.
///
/// L − μM is not definite, and without pivoting its factors may be of no use: they are tried out, and μ is moved where they fail.
fn shifted<'p>(
    pencil: &'p Pencil<'_>,
    root_mass: &[f64],
    mean: f64,
    known: usize,
    k: usize,
) -> Option<(Factor<'p>, f64)> {
    let asked = (k - known) as f64;
    let mut mu = 0.9 * pencil.neighbours().sqrt() * mean * k as f64 / root_mass.len() as f64;
    if !(mu > 0.0 && mu.is_finite()) {
        return None;
    }
    let (mut under, mut over) = (0.0, f64::INFINITY);
    for tries in 0..GUESSES {
        // Clusters may leave no room for precision.
        let slack = if tries < 3 { 0.15 } else { 0.3 };
        if let Some(mut factor) = pencil.factor(-mu) {
            let below = factor.negative_pivots().saturating_sub(known) as f64;
            let few = below < ((BELOW - slack) * asked).floor();
            let many = below > ((BELOW + slack) * asked).ceil();
            if (few && over > 1.01 * under) || (many && mu > ROUNDING * mean) {
                if few {
                    under = mu
                } else {
                    over = mu
                }
                let guess = mu * (BELOW * asked / below).clamp(1e-3, 8.0);
                let inside = guess > 1.001 * under && guess < 0.999 * over;
                let between = if under > 0.0 { (under * over).sqrt() } else { 0.1 * over };
                mu = if inside { guess } else { between }.max(0.5 * ROUNDING * mean);
                continue;
            }
            if solves(pencil, &mut factor, root_mass, mu) {
                return Some((factor, mu));
            }
        }
        mu *= 0.97;
    }
    // The other side of zero is always safe.
    Some((pencil.factor(0.2 * mu)?, -0.2 * mu))
}

/// Whether a factor of L − μM solves with it to ten digits, and μ is no eigenvalue.
fn solves(pencil: &Pencil<'_>, factor: &mut Factor<'_>, root_mass: &[f64], mu: f64) -> bool {
    let n = root_mass.len();
    // Anything that is not smooth and in which no eigenvector is missing.
    let right =
        Mat::from_fn(n, 1, |i, _| ((i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 16_777_216.0 - 0.5);
    let mut x = right.clone();
    apply_inverse(factor, root_mass, x.as_mut());
    let error = pencil.residual(root_mass, mu, x.col(0), right.col(0));
    error <= 1e-10 * right.norm_l2() && mu * x.norm_l2() <= 1e5 * right.norm_l2()
}

/// Whether no eigenvalue can be negative, by Gershgorin's circles.
fn diagonally_dominant(matrix: &CsMat<f64>, mass: &[f64], mean: f64) -> bool {
    matrix.outer_iterator().zip(mass).enumerate().all(|(i, (row, m))| {
        let slack: f64 = row.iter().map(|(j, &value)| if i == j { value } else { -value.abs() }).sum();
        slack >= -1e-10 * mean * m
    })
}

/// Ritz pairs in order of their eigenvalue `lambda` of (L, M), without those below zero. There are none: what lies there has
/// not converged, in the gap that the shift-inverted operator has between −1/μ and 0.
fn smallest(count: usize, lambda: impl Fn(usize) -> f64, mean: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).filter(|&j| lambda(j) >= -ROUNDING * mean).collect();
    order.sort_by(|&i, &j| lambda(i).total_cmp(&lambda(j)));
    order
}

/// Replaces columns y by M^½ (L + shift·M)⁻¹ M^½ y.
fn apply_inverse(factor: &mut Factor<'_>, root_mass: &[f64], mut columns: MatMut<'_, f64>) {
    let scale = |columns: &mut MatMut<'_, f64>| {
        for column in columns.rb_mut().col_iter_mut() {
            column.iter_mut().zip(root_mass).for_each(|(y, root)| *y *= root);
        }
    };
    scale(&mut columns);
    factor.solve(columns.rb_mut());
    scale(&mut columns);
}

/// M^½ times the indicator of each piece, normalised, where they really are null vectors of L (rows that sum to zero); the first k of them.
fn null_vectors(
    matrix: &CsMat<f64>,
    root_mass: &[f64],
    piece: &[u32],
    pieces: usize,
    k: usize,
    mean_eigenvalue: f64,
) -> Mat<f64> {
    let balanced = matrix.outer_iterator().zip(root_mass).all(|(row, root)| {
        let sum: f64 = row.iter().map(|(_, &value)| value).sum();
        sum.abs() <= 1e-10 * mean_eigenvalue * root * root
    });
    let count = if balanced { pieces.min(k) } else { 0 };
    let mut squared = vec![0.0; pieces];
    for (&p, root) in piece.iter().zip(root_mass) {
        squared[p as usize] += root * root;
    }
    let mut vectors = Mat::zeros(root_mass.len(), count);
    for (i, (&p, root)) in piece.iter().zip(root_mass).enumerate() {
        if (p as usize) < count {
            vectors[(i, p as usize)] = root / squared[p as usize].sqrt();
        }
    }
    vectors
}

/// How many eigenvalues lie below the last of those found beyond the ones found there. Counted just under the cluster that the last belongs
/// to: how much of a cluster lies beyond k says nothing, and counting above it would ask for all of it.
/// `None` when the factorisation breaks down, so that nothing can be said.
fn missed(pencil: &Pencil<'_>, eigenvalues: &[f64], mean: f64) -> Option<usize> {
    let k = eigenvalues.len();
    let clear = 1e-6 * eigenvalues[k - 1].max(ROUNDING * mean);
    let first = (1..k).rev().find(|&c| eigenvalues[c] - eigenvalues[c - 1] > clear).unwrap_or(0);
    let gap = if first > 0 { eigenvalues[first] - eigenvalues[first - 1] } else { f64::INFINITY };
    let mu = eigenvalues[first] - 0.1 * gap.min(1e3 * clear);
    let below = pencil.factor(-mu)?.negative_pivots();
    Some(below.saturating_sub(first))
}

/// From orthonormal vectors y to eigenfunctions φ = M^−½y: sorted, signed, and their residual measured.
fn finish(
    matrix: &CsMat<f64>,
    mass: &[f64],
    root_mass: &[f64],
    values: Vec<f64>,
    mut vectors: Mat<f64>,
    mut report: SpectrumReport,
) -> Result<(Vec<f64>, Mat<f64>, SpectrumReport), SpectrumError> {
    let inverse: Vec<f64> = root_mass.iter().map(|root| 1.0 / root).collect();
    for column in vectors.as_mut().col_iter_mut() {
        column.iter_mut().zip(&inverse).for_each(|(y, inverse)| *y *= inverse);
    }
    make_canonical(vectors.as_mut(), mass);
    let floor = (ROUNDING * mean_eigenvalue(matrix, mass)).max(f64::MIN_POSITIVE);
    let largest = values.iter().fold(floor, |m: f64, value| m.max(value.abs()));
    if values.iter().any(|&value| value < -RESIDUAL * largest) {
        return Err(SpectrumError::NotFactorised);
    }
    let mut residuals = residuals(matrix, mass, vectors.as_ref(), &values);
    residuals.iter_mut().for_each(|r| *r /= largest);
    report.residual = residuals.iter().copied().fold(0.0, f64::max);
    // Written so that NaN fails too, which the maximum passes over.
    if !residuals.iter().all(|&r| r <= RESIDUAL) {
        let converged = residuals.iter().filter(|&&r| r <= RESIDUAL).count();
        return Err(SpectrumError::NotConverged { converged, wanted: values.len(), residual: report.residual });
    }
    let values = values.into_iter().map(|value| value.max(0.0)).collect();
    Ok((values, vectors, report))
}

/// Mean of all n eigenvalues: the trace of M⁻¹L over n.
fn mean_eigenvalue(matrix: &CsMat<f64>, mass: &[f64]) -> f64 {
    matrix.diag_iter().zip(mass).map(|(d, m)| d.copied().unwrap_or(0.0) / m).sum::<f64>() / mass.len() as f64
}

/// ‖Lφ − λMφ‖ in the M⁻¹ norm of every pair. Four go through the matrix together, which reads it as many times less.
fn residuals(matrix: &CsMat<f64>, mass: &[f64], phi: MatRef<'_, f64>, lambda: &[f64]) -> Vec<f64> {
    let mut squares = vec![0.0; lambda.len()];
    let mut rows = vec![[0.0; LANES]; mass.len()];
    for (first, squares) in (0..).step_by(LANES).zip(squares.chunks_mut(LANES)) {
        let column = |c: usize| first + c.min(squares.len() - 1);
        for c in 0..LANES {
            rows.iter_mut().zip(phi.col(column(c)).iter()).for_each(|(row, &phi)| row[c] = phi);
        }
        let lambda: [f64; LANES] = std::array::from_fn(|c| lambda[column(c)]);
        let mut sums = [0.0; LANES];
        for (i, entries) in matrix.outer_iterator().enumerate() {
            let mut r: [f64; LANES] = std::array::from_fn(|c| -lambda[c] * mass[i] * rows[i][c]);
            for (&j, &value) in entries.indices().iter().zip(entries.data()) {
                (0..LANES).for_each(|c| r[c] += value * rows[j][c]);
            }
            (0..LANES).for_each(|c| sums[c] += r[c] * r[c] / mass[i]);
        }
        squares.copy_from_slice(&sums[..squares.len()]);
    }
    squares.into_iter().map(f64::sqrt).collect()
}
