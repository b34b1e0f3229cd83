//! From a scan to its operator, basis and descriptors, before a network looks at it.

use std::collections::BTreeMap;

use super::geometry::{Carriers, Geometry};
use super::surface::Surface;
use super::{Error, Info, PrepareOptions, PreparedShape, ShapeKind};
use crate::graph::components;
use crate::operators::{self, Laplacian, LaplacianKind};
use crate::progress::{Progress, Stage};
use crate::registration::COARSE;
use crate::shape::{
    Aside, Axis, MESH_LIMIT, MIN_POINTS, Repair, Shape, ShapeError, Strays, THIN_LIMIT, counted, farthest_points,
    set_strays_aside, support,
};
use crate::spectrum::{SpectralBasis, SpectrumReport, check_size};
use crate::vector::extents;

/// Code of the repair that says that an eigenpair may be missing.
pub(super) const NOT_PROVED: &str = "spectrum-not-proved";

/// Code of the repair that says that strays were set aside.
pub(super) const STRAYS: &str = "crumbs-set-aside";

/// Says so where it was not proved that a basis misses nothing.
pub(super) fn not_proved(report: &SpectrumReport, basis: &SpectralBasis) -> Option<Repair> {
    let message = "the eigenvalues are right, but it was not proved that none between them is missing";
    (!report.complete).then(|| Repair::noted(NOT_PROVED, basis.k(), message.to_owned()))
}

/// The steps of [`prepare`] before the network, without the points `aside`. Returns what is prepared so far, the carriers that operators were built on, and their Laplacian. The basis has `wanted` eigenpairs
/// where fewer were asked for and memory allows; without memory for those that were asked for it fails.
pub(crate) fn prepare_with_carriers(
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    aside: &Aside,
    wanted: usize,
    progress: &mut Progress,
) -> Result<(PreparedShape, Carriers, Laplacian), Error> {
    options.check()?;
    let as_read = shape;
    let mut repairs = as_read.repairs().to_vec();
    let n = as_read.points().len();
    progress.at(Stage::Sample, 0.0)?;
    let Surface { shape: used_shape, resampled, points: surface } = Surface::of(&as_read, aside, options, &mut repairs);
    // Cotangents need the mesh; the other kinds are built on the points that are used.
    let kind = options.laplacian.unwrap_or(operators::default_kind(&used_shape));
    let on_mesh = kind == LaplacianKind::Cotangent && !used_shape.faces().is_empty();
    let more = if on_mesh { THIN_LIMIT } else { options.points / 2 };
    let most = options.points.saturating_add(more).max(if on_mesh { MESH_LIMIT } else { 0 });
    check_size(surface.len().min(most), options.eigenpairs)?;
    let wanted = if check_size(surface.len().min(most), wanted).is_ok() { wanted } else { 0 };
    let aside = set_strays_aside(&used_shape, &surface, aside);
    let mut unmatched = aside.unmatched();
    unmatched.extend(used_shape.placeless());
    unmatched.sort_unstable();
    unmatched.dedup();
    let Strays { body: surface, strays, far, pieces: stray_pieces, far_vertices, .. } = aside;
    repairs.extend(Repair::counted(STRAYS, strays.len(), || {
        let bits = counted(stray_pieces, "bit", "bits");
        format!(
            "{} in {bits} apart from the body set aside; {} of them too far from it to be matched",
            counted(strays.len(), "point", "points"),
            far.len()
        )
    }));
    repairs.extend(Repair::counted("far-from-surface", far_vertices.len(), || {
        let points = counted(far_vertices.len(), "point that belongs", "points that belong");
        format!("{points} to no face too far from the surface to be matched")
    }));
    if surface.len() < MIN_POINTS {
        return Err(ShapeError::TooFewPoints { found: surface.len(), needed: MIN_POINTS }.into());
    }
    if on_mesh && surface.len() > MESH_LIMIT {
        let count = surface.len();
        let message =
            format!("the mesh has {count} vertices, more than {MESH_LIMIT}: its basis is that of a simplified one");
        repairs.push(Repair::noted("mesh-simplified", count, message));
    }
    let mut share: f64 = 0.0;
    let mut report = |done| {
        // Several samplings follow one another.
        share = share.max(0.9 * done);
        progress.at(Stage::Sample, share)
    };
    let (mut support, mut operator_shape, lost) = support(&used_shape, surface, options.points, on_mesh, &mut report)?;
    if operator_shape.points().len() < MIN_POINTS {
        return Err(ShapeError::TooFewPoints { found: operator_shape.points().len(), needed: MIN_POINTS }.into());
    }
    repairs.extend(Repair::counted("thin-parts-lost", lost, || {
        let points = counted(lost, "point", "points");
        format!("{points} in parts too thin for the simplified mesh; they are matched like what they hang on")
    }));
    repairs.extend(operator_shape.wind_alike());
    support.unmatched = (!unmatched.is_empty()).then_some(unmatched);
    let used: Vec<[f64; 3]> = (0..support.points_used(used_shape.points().len()))
        .map(|row| used_shape.points()[support.uploaded(row)])
        .collect();
    let coarse = farthest_points(&used, &(0..used.len() as u32).collect::<Vec<u32>>(), COARSE, &mut report)?;

    let carriers = Carriers::new(operator_shape);
    let geometry = Geometry::of(&carriers, kind, None, (&support, &coarse), [options.eigenpairs, wanted], progress)?;
    let Geometry { laplacian, basis, report, features, surface } = geometry;
    repairs.extend(not_proved(&report, &basis));

    let info = Info {
        kind: if used_shape.faces().is_empty() { ShapeKind::Cloud } else { ShapeKind::Mesh },
        name,
        points: n,
        faces: as_read.faces().len(),
        pieces: pieces(&laplacian),
        points_used: used.len(),
        unit: None,
        up_axis: options.up.or(as_read.up()).or_else(|| longest_axis(&used)),
        scale: operators::surface_area(&carriers.shape, &laplacian, &carriers.neighbourhood).sqrt(),
        share: 1.0,
        borders: false,
        reliability: 1.0,
        laplacian: kind,
        eigenpairs: basis.k().min(options.eigenpairs),
        residual: report.residual,
        seconds: BTreeMap::new(),
        fallback: None,
    };
    let prepared = PreparedShape {
        shape: as_read,
        resampled,
        info,
        repairs,
        basis,
        support,
        coarse,
        surface,
        features,
        embeddings: Vec::new(),
    };
    Ok((prepared, carriers, laplacian))
}

/// Connected pieces of the surface or neighbourhood graph; points without surface do not count.
fn pieces(laplacian: &Laplacian) -> usize {
    let edges = laplacian.matrix.iter().filter(|&(&value, (i, j))| value != 0.0 && i != j);
    let (label, count) = components(laplacian.len(), edges.map(|(_, (i, j))| (i as u32, j as u32)));
    let mut carries = vec![false; count];
    label.iter().zip(&laplacian.mass).for_each(|(&piece, &mass)| carries[piece as usize] |= mass > 0.0);
    carries.into_iter().filter(|&carries| carries).count()
}

/// The axis along which the scan is much longer (by half) than along the others: that of somebody standing, and not of a quadruped.
fn longest_axis(points: &[[f64; 3]]) -> Option<Axis> {
    let extents = extents(points.iter().copied());
    [Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .enumerate()
        .find_map(|(c, axis)| (0..3).all(|other| other == c || extents[c] > 1.5 * extents[other]).then_some(axis))
}
