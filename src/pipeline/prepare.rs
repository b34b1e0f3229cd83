//! From a scan to what can be matched.

use std::collections::BTreeMap;
use std::ops::Range;

use ndarray::{Array2, s};

use super::body::{Scan, body_of};
use super::contact::edges_between_limbs;
use super::geometry::{Carriers, Geometry};
use super::reliability::reliability;
use super::surface::Surface;
use super::{Error, Info, PrepareOptions, PreparedShape, ShapeKind};
use crate::device::{Cpu, Device, Interrupted, still_well};
use crate::graph::components;
use crate::network::{InputConfig, Model, PointEmbedding, ShapeInputs, TrainedNetwork};
use crate::operators::{self, EdgeFilter, Laplacian, LaplacianKind, gradient_around};
use crate::progress::{Cancelled, Progress, Stage};
use crate::registration::COARSE;
use crate::shape::{
    Axis, MESH_LIMIT, MIN_POINTS, Repair, Shape, ShapeError, Strays, THIN_LIMIT, counted, farthest_points,
    set_strays_aside, support,
};
use crate::spectrum::{SpectralBasis, SpectrumReport, check_size};

/// Scan → graph → Laplacian → spectrum → features and parts, on the CPU with the weights that ship; on a cloud on which limbs touch from the graph on once more,
/// limbs told apart by those parts.
pub fn prepare(
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    progress: &mut Progress,
) -> Result<PreparedShape, Error> {
    // Nothing on the CPU ever waits.
    pollster::block_on(prepare_with(Model::embedded(), shape, name, options, progress))
}

/// [`prepare`] with other weights, or on another device.
pub async fn prepare_with<D: Device>(
    model: &Model<D>,
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    progress: &mut Progress<'_>,
) -> Result<PreparedShape, Error> {
    let wanted = model.weights().map(|weights| weights.config.eigenpairs).max().unwrap_or(0);
    let scan = Scan { shape, name, options, wanted };
    let (mut prepared, carriers, laplacian) = body_of(model, scan, progress).await?;
    if prepared.basis.k() < wanted {
        let found = prepared.basis.k();
        let message = format!(
            "the scan has {found} eigenpairs and the network looks at {wanted}: it sees less of it than it should"
        );
        prepared.repairs.push(Repair::noted("few-eigenpairs", found, message));
    }
    // Kept through the network only where it may be needed again.
    let by_default = prepared.info.kind == ShapeKind::Cloud && options.laplacian.is_none();
    let laplacian = by_default.then_some(laplacian);
    let home = prepared.embeddings.first().cloned();
    let in_contact =
        laplacian.zip(home).and_then(|(laplacian, home)| Some((edges_between_limbs(&laplacian, &home)?, home)));
    if let Some((edges, PointEmbedding { category, parts, .. })) = in_contact {
        // A Laplacian and a spectrum again, but a listener is not told of a stage twice.
        let mut within = Progress::new(|_, _| progress.at(Stage::Features, 0.5).is_ok());
        let (kind, sampled) = (prepared.info.laplacian, (&prepared.support, &prepared.coarse[..]));
        let meet = |i: u32, j: u32| f64::from(category.meeting(parts.row(i as usize), parts.row(j as usize)));
        let apart =
            Geometry::of(&carriers, kind, Some(&meet), sampled, [options.eigenpairs, prepared.basis.k()], &mut within);
        drop(within);
        match apart {
            Ok(apart) => {
                let message = format!(
                    "{} of neighbours join parts of the body that do not meet, as where a hand rests on a hip: they were told apart",
                    counted(edges, "pair", "pairs")
                );
                prepared.repairs.retain(|repair| repair.code != NOT_PROVED);
                prepared.repairs.push(Repair::noted("limbs-told-apart", edges, message));
                prepared.repairs.extend(not_proved(&apart.report, &apart.basis));
                prepared.info.residual = apart.report.residual;
                (prepared.basis, prepared.features, prepared.surface) = (apart.basis, apart.features, apart.surface);
                let filter = options.part_aware_gradients.then_some(&meet as EdgeFilter);
                ask(model, &mut prepared, &carriers, filter, 0.8..0.9, progress).await?;
            }
            Err(Error::Cancelled(_)) => return Err(Cancelled { stage: Stage::Features }.into()),
            // The basis that knows no parts is there and good.
            Err(_) => {}
        }
    }
    let extent = prepared.embeddings.first().and_then(|home| home.category.extent);
    prepared.info.unit = extent.and_then(|extent| unit(&prepared.points_of_rows(), extent));
    progress.at(Stage::Features, 1.0)?;
    if prepared.basis.k() > prepared.info.eigenpairs {
        prepared.basis = prepared.basis.truncated(prepared.info.eigenpairs);
    }
    prepared.info.seconds = progress.take_seconds();
    Ok(prepared)
}

/// Code of the repair that says that an eigenpair may be missing.
const NOT_PROVED: &str = "spectrum-not-proved";

/// Says so where it was not proved that a basis misses nothing.
fn not_proved(report: &SpectrumReport, basis: &SpectralBasis) -> Option<Repair> {
    let message = "the eigenvalues are right, but it was not proved that none between them is missing";
    (!report.complete).then(|| Repair::noted(NOT_PROVED, basis.k(), message.to_owned()))
}

/// What the networks make of a shape, within a range of the stage: first that of the category that the shape is most at home with.
pub(super) async fn ask<D: Device>(
    model: &Model<D>,
    prepared: &mut PreparedShape,
    carriers: &Carriers,
    filter: Option<EdgeFilter<'_>>,
    share: Range<f64>,
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    progress.at(Stage::Features, share.start)?;
    prepared.embeddings.clear();
    for (index, trained) in model.networks().iter().enumerate() {
        let inputs = {
            // Gradients ask for a graph again, but a listener is not told of a stage twice.
            let mut within = Progress::new(|_, _| progress.at(Stage::Features, share.start).is_ok());
            network_inputs(prepared, carriers, filter, &trained.weights().config.input(), &mut within)
                .map_err(|_| Cancelled { stage: Stage::Features })?
        };
        progress.at(Stage::Features, share.end)?;
        let embedding = match embed(model.device(), trained, &inputs).await {
            Ok(embedding) => embedding,
            Err(Interrupted::Cancelled(stop)) => return Err(stop.into()),
            Err(interrupted) => {
                prepared.info.fallback = interrupted.fallback();
                model.on_cpu().networks()[index].embed(&Cpu, &inputs).await
            }
        };
        if !embedding.is_finite() {
            return Err(Error::NotFinite { what: "what the network says of a scan".to_owned() });
        }
        prepared.embeddings.push(embedding);
    }
    prepared.embeddings.sort_by(|x, y| rank(x).0.cmp(&rank(y).0).then(rank(y).1.total_cmp(&rank(x).1)));
    Ok(())
}

/// Categories that know others and are at home with the shape come first, then those that know none, then those that are not at home; and by how much the
/// parts of the shape are more certain than the category asks for.
fn rank(embedding: &PointEmbedding) -> (u8, f64) {
    let share = 1.0 / embedding.parts.nrows().max(1) as f64;
    let margin = embedding.certainty(std::iter::repeat(share)) - embedding.category.thresholds.certainty;
    let place = match (embedding.category.knows_others(), margin >= 0.0) {
        (true, true) => 0,
        (false, _) => 1,
        (true, false) => 2,
    };
    (place, margin)
}

async fn embed<D: Device>(
    device: &D,
    trained: &TrainedNetwork<D::Tensor>,
    inputs: &ShapeInputs,
) -> Result<PointEmbedding, Interrupted> {
    let embedding = trained.embed(device, inputs).await;
    still_well(device, Stage::Features)?;
    if embedding.is_finite() { Ok(embedding) } else { Err(Interrupted::NotFinite(Stage::Features)) }
}

/// All of [`prepare`] but the network, the carriers that operators were built on, and their Laplacian. Points `aside` (ascending) belong to something else. The basis has `wanted` eigenpairs where fewer were asked for; memory for those
/// that were must be there, for the others it is nice to have.
pub(crate) fn prepare_with_carriers(
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    aside: &[u32],
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
    repairs.extend(Repair::counted("crumbs-set-aside", strays.len(), || {
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
    let (reliability, doubt) = reliability(&used, &carriers, &laplacian.mass);
    repairs.extend(doubt);

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
        reliability,
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

/// What the network sees of a prepared shape, whose operators were built on `carriers` with `filter`.
pub(crate) fn network_inputs(
    prepared: &PreparedShape,
    carriers: &Carriers,
    filter: Option<EdgeFilter>,
    config: &InputConfig,
    progress: &mut Progress,
) -> Result<ShapeInputs, Cancelled> {
    let matchable = prepared.matchable();
    let gradient = gradient_around(&carriers.shape, &carriers.neighbourhood, filter, progress)?;
    let k = config.eigenpairs.min(prepared.basis.k());
    let unit_area = prepared.basis.mass.sum();
    let rows: Vec<usize> = match &prepared.support.used {
        Some(used) => used.iter().map(|&carrier| carrier as usize).collect(),
        None => (0..prepared.basis.len()).collect(),
    };
    // Φ grows with √area and ∂ with it once more when lengths are measured in √area.
    let scale = unit_area.sqrt() * prepared.info.scale;
    let gradients = gradient.along.map(|along| {
        let mut out = Array2::zeros((rows.len(), k));
        for (mut out, &i) in out.rows_mut().into_iter().zip(&rows) {
            for (j, &g) in along.outer_view(i).iter().flat_map(|row| row.iter()) {
                let phi = prepared.basis.eigenvectors.slice(s![j, ..k]);
                out.zip_mut_with(&phi, |out, phi| *out += (g * phi * scale) as f32);
            }
        }
        out
    });
    let [along, across] = &gradients;
    Ok(ShapeInputs::new(&matchable.basis, [along.view(), across.view()], matchable.points.view(), config))
}

/// Connected pieces of the surface or neighbourhood graph; points without surface do not count.
fn pieces(laplacian: &Laplacian) -> usize {
    let edges = laplacian.matrix.iter().filter(|&(&value, (i, j))| value != 0.0 && i != j);
    let (label, count) = components(laplacian.len(), edges.map(|(_, (i, j))| (i as u32, j as u32)));
    let mut carries = vec![false; count];
    label.iter().zip(&laplacian.mass).for_each(|(&piece, &mass)| carries[piece as usize] |= mass > 0.0);
    carries.into_iter().filter(|&carries| carries).count()
}

/// Extents along the three axes.
fn extents(points: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|c| {
        let (low, high) =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[c]), high.max(p[c])));
        high - low
    })
}

/// The unit in which the longest side of the scan's box is that of a body of the category, `shortest` to `longest` metres.
fn unit(points: &[[f64; 3]], [shortest, longest]: [f64; 2]) -> Option<String> {
    let side = extents(points).into_iter().fold(0.0, f64::max);
    [("m", 1.0), ("cm", 100.0), ("mm", 1000.0)]
        .into_iter()
        .find(|(_, per_metre)| (shortest..longest).contains(&(side / per_metre)))
        .map(|(name, _)| name.to_owned())
}

/// The axis along which the scan is much longer (by half) than along the others: that of somebody standing, and not of a quadruped.
fn longest_axis(points: &[[f64; 3]]) -> Option<Axis> {
    let extents = extents(points);
    [Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .enumerate()
        .find_map(|(c, axis)| (0..3).all(|other| other == c || extents[c] > 1.5 * extents[other]).then_some(axis))
}
