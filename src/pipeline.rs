//! The method, in order. The only file that knows it.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use ndarray::Array2;

use crate::device::{Cpu, Device, Fallback, Interrupted, still_well};
use crate::doubts::{UNTRAINED, contradicted, doubts, labelled_otherwise, verdict, warnings};
use crate::error::Error;
use crate::features::ShapeInputs;
use crate::fmap::{
    COARSE, Correspondence, Cues, Familiarity, FunctionalMap, Matchable, Refined, Refinement, initial_maps,
    learned_maps, lift, refine, strain, stretch,
};
use crate::geometry::{Geometry, edges_between_limbs};
use crate::graph::components;
use crate::known::{Functions, labels_used, landmarks, parts_in_common, shared_labels, side_by_side};
use crate::model::{Model, PointEmbedding};
use crate::operators::{self, Laplacian, LaplacianKind};
use crate::options::{Axis, FaceUse, MatchOptions, OptionError, Parts, PrepareOptions};
use crate::prepared::{Info, PreparedShape, ShapeKind};
use crate::processor::{DeviceKind, GpuUse};
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::{
    Crumbs, MESH_LIMIT, MIN_POINTS, Repair, Shape, ShapeError, THIN_LIMIT, counted, farthest_points, set_crumbs_aside,
    support,
};
use crate::spectrum::{SpectralBasis, SpectrumReport, check_size};

/// Two scans matched.
#[derive(Clone, Debug)]
pub struct Match {
    /// For each uploaded point of A its point on B.
    pub a_to_b: Correspondence,
    /// For each uploaded point of B its point on A.
    pub b_to_a: Correspondence,
    /// A to B as the first maps had it, before refinement; only where [`MatchOptions::raw`] asked for it.
    pub raw: Option<Correspondence>,
    /// C_ab: functions on A → functions on B.
    pub c_ab: FunctionalMap,
    /// C_ba: functions on B → functions on A.
    pub c_ba: FunctionalMap,
    /// Seconds per stage.
    pub seconds: BTreeMap<String, f64>,
    /// Points of A and B that took part.
    pub points_used: [usize; 2],
    /// What a user should know before trusting the result.
    pub warnings: Vec<String>,
    /// Name and version of the weights that took part; null when none did.
    pub weights: serde_json::Value,
    /// Where and why the CPU took over from the device; nothing when it did not.
    pub fallback: Option<Fallback>,
    /// The device that it ran on, or began on.
    pub device: DeviceKind,
    /// What was asked of a GPU.
    pub gpu: GpuUse,
}

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
    let (mut prepared, operator_shape, laplacian) = prepare_with_shape(shape, name, options, progress)?;
    // Kept through the network only where it may be needed again.
    let by_default = prepared.info.kind == ShapeKind::Cloud && options.laplacian.is_none();
    let laplacian = by_default.then_some(laplacian);
    let parts = ask(model, &mut prepared, &operator_shape, 0.2..0.4, progress).await?;
    if let Some(edges) = laplacian.and_then(|laplacian| edges_between_limbs(&laplacian, &parts)) {
        // A graph and a spectrum again, but for who listens no stage comes twice.
        let mut within = Progress::new(|_, _| progress.at(Stage::Features, 0.5).is_ok());
        let (kind, sampled) = (prepared.info.laplacian, (&prepared.support, &prepared.coarse[..]));
        let apart = Geometry::of(&operator_shape, kind, Some(&parts), sampled, options.eigenpairs, &mut within);
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
                ask(model, &mut prepared, &operator_shape, 0.8..0.9, progress).await?;
            }
            Err(Error::Cancelled(_)) => return Err(Cancelled { stage: Stage::Features }.into()),
            // The basis that knows no parts is there and good.
            Err(_) => {}
        }
    }
    progress.at(Stage::Features, 1.0)?;
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

/// What the network makes of a shape, within a range of the stage; returns the probabilities of parts.
async fn ask<D: Device>(
    model: &Model<D>,
    prepared: &mut PreparedShape,
    operator_shape: &Shape,
    share: Range<f64>,
    progress: &mut Progress<'_>,
) -> Result<Array2<f32>, Error> {
    progress.at(Stage::Features, share.start)?;
    let config = &model.weights().config;
    let inputs = {
        // Gradients take a graph again, but for who listens no stage comes twice.
        let mut within = Progress::new(|_, _| progress.at(Stage::Features, share.start).is_ok());
        ShapeInputs::of(prepared, operator_shape, config.eigenpairs, config.position, &mut within)
            .map_err(|_| Cancelled { stage: Stage::Features })?
    };
    progress.at(Stage::Features, share.end)?;
    let embedding = match embed(model, &inputs).await {
        Ok(embedding) => embedding,
        Err(Interrupted::Cancelled(stop)) => return Err(stop.into()),
        Err(Interrupted::Failed(fallback)) => {
            prepared.info.fallback = Some(fallback);
            model.on_cpu().embed(&inputs).await
        }
    };
    Ok(prepared.embedding.insert(embedding).parts.clone())
}

async fn embed<D: Device>(model: &Model<D>, inputs: &ShapeInputs) -> Result<PointEmbedding, Interrupted> {
    let embedding = model.embed(inputs).await;
    still_well(model.device(), Stage::Features)?;
    Ok(embedding)
}

/// All of [`prepare`] but the network, the shape that operators were built on (its points are the carriers), and its Laplacian.
pub(crate) fn prepare_with_shape(
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    progress: &mut Progress,
) -> Result<(PreparedShape, Shape, Laplacian), Error> {
    options.check()?;
    let as_read = shape;
    let mut repairs = as_read.repairs().to_vec();
    let n = as_read.points().len();
    let in_faces = surface_points(&as_read).len();
    let used_shape = match options.faces {
        FaceUse::Use if as_read.faces().is_empty() || 2 * in_faces >= n => as_read.welded(),
        FaceUse::Use => {
            let message = format!("only {in_faces} of {n} points belong to a face: the scan was taken as a cloud");
            repairs.push(Repair::noted("faces-set-aside", as_read.faces().len(), message));
            as_read.clone().without_faces()
        }
        FaceUse::Ignore => as_read.clone().without_faces(),
    };

    progress.at(Stage::Sample, 0.0)?;
    let surface = surface_points(&used_shape);
    // Cotangents need the mesh; the other kinds are built on the points that are used.
    let kind = options.laplacian.unwrap_or(operators::default_kind(&used_shape));
    let on_mesh = kind == LaplacianKind::Cotangent && !used_shape.faces().is_empty();
    let more = if on_mesh { THIN_LIMIT } else { options.points / 2 };
    let most = options.points.saturating_add(more).max(if on_mesh { MESH_LIMIT } else { 0 });
    check_size(surface.len().min(most), options.eigenpairs)?;
    let Crumbs { body: surface, crumbs, far, pieces: crumb_count } = set_crumbs_aside(&used_shape, &surface);
    repairs.extend(Repair::counted("crumbs-set-aside", crumbs.len(), || {
        let bits = counted(crumb_count, "bit", "bits");
        format!(
            "{} in {bits} apart from the body set aside; {} of them too far from it to be matched",
            counted(crumbs.len(), "point", "points"),
            far.len()
        )
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
    let mut heard = |done| {
        // Several samplings follow one another.
        share = share.max(0.9 * done);
        progress.at(Stage::Sample, share)
    };
    let (mut support, operator_shape, lost) = support(&used_shape, surface, options.points, on_mesh, &mut heard)?;
    if operator_shape.points().len() < MIN_POINTS {
        return Err(ShapeError::TooFewPoints { found: operator_shape.points().len(), needed: MIN_POINTS }.into());
    }
    repairs.extend(Repair::counted("thin-parts-lost", lost, || {
        let points = counted(lost, "point", "points");
        format!("{points} in parts too thin for the simplified mesh; they are matched like what they hang on")
    }));
    support.unmatched = (!far.is_empty()).then_some(far);
    let used: Vec<[f64; 3]> =
        (0..support.points_used(n)).map(|row| used_shape.points()[support.uploaded(row)]).collect();
    let coarse = farthest_points(&used, &(0..used.len() as u32).collect::<Vec<u32>>(), COARSE, &mut heard)?;

    let geometry = Geometry::of(&operator_shape, kind, None, (&support, &coarse), options.eigenpairs, progress)?;
    let Geometry { laplacian, basis, report, features, surface } = geometry;
    repairs.extend(not_proved(&report, &basis));

    let info = Info {
        kind: if used_shape.faces().is_empty() { ShapeKind::Cloud } else { ShapeKind::Mesh },
        name,
        points: n,
        faces: as_read.faces().len(),
        pieces: pieces(&laplacian),
        points_used: used.len(),
        unit: unit(&used),
        up_axis: options.up.or(as_read.up()).or_else(|| longest_axis(&used)),
        scale: operators::surface_area(&operator_shape, &laplacian).sqrt(),
        laplacian: kind,
        eigenpairs: basis.k(),
        residual: report.residual,
        seconds: BTreeMap::new(),
        fallback: None,
    };
    let prepared =
        PreparedShape { shape: as_read, info, repairs, basis, support, coarse, surface, features, embedding: None };
    Ok((prepared, operator_shape, laplacian))
}

/// Features of both → functional maps both ways → refinement → correspondence of every uploaded point, on the CPU with the weights that ship.
pub fn match_shapes(
    a: &PreparedShape,
    b: &PreparedShape,
    options: &MatchOptions,
    progress: &mut Progress,
) -> Result<Match, Error> {
    pollster::block_on(match_with(Model::embedded(), a, b, options, progress))
}

/// [`match_shapes`] with other weights, or on another device.
pub async fn match_with<D: Device>(
    model: &Model<D>,
    a: &PreparedShape,
    b: &PreparedShape,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<Match, Error> {
    match_with_cues(model, a, b, options, progress).await.map(|(matched, _)| matched)
}

/// [`match_with`], and what confidence was judged by, from A to B and back, at the points used.
pub(crate) async fn match_with_cues<D: Device>(
    model: &Model<D>,
    a: &PreparedShape,
    b: &PreparedShape,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<(Match, [Cues; 2]), Error> {
    progress.at(Stage::FunctionalMap, 0.0)?;
    let parts = match options.parts {
        Parts::Given => Some((labels_used(a, "a")?, labels_used(b, "b")?)),
        Parts::Predicted | Parts::None => None,
    };
    let labels = parts.as_ref().and_then(|_| a.shape.labels().zip(b.shape.labels()));
    let parts = parts.as_ref().map(|(of_a, of_b)| (&of_a[..], &of_b[..]));
    if let Some((of_a, of_b)) = labels
        && shared_labels(of_a, of_b).is_empty()
    {
        return Err(OptionError::no_shared_labels(of_a[0], of_b[0]).into());
    }
    let sides = [a, b].map(|shape| {
        let trust = shape.embedding.as_ref().and_then(|embedding| model.trust(embedding));
        Matchable { trust, ..shape.matchable() }
    });
    let [side_a, side_b] = &sides;
    let known = [
        landmarks(a, b, side_a, side_b, &options.landmarks)?,
        parts.map(|(of_a, of_b)| parts_in_common(side_a, of_a, side_b, of_b)),
    ];
    let known = side_by_side(known.into_iter().flatten());
    let pair = Pair { shapes: [a, b], sides: &sides, known, parts };

    let (best, fallback) = match best_maps(model, &pair, options, progress).await {
        Err(Interrupted::Failed(fallback)) => {
            (best_maps(&model.on_cpu(), &pair, options, progress).await, Some(fallback))
        }
        best => (best, None),
    };
    let BestMaps { refined: Refined { a_to_b, b_to_a, maps, cues }, raw, familiarity, weights } = match best {
        Ok(best) => best,
        Err(Interrupted::Cancelled(stop)) => return Err(stop.into()),
        Err(Interrupted::Failed(_)) => unreachable!("the CPU does not fail"),
    };
    let untrained = familiarity.is_none().then(|| UNTRAINED.to_owned());
    let mut warnings: Vec<String> = untrained.into_iter().chain(warnings(a, b)).collect();
    warnings.extend(familiarity.and_then(|at_home| verdict(at_home, weights.is_null())));
    let predicted = match (&a.embedding, &b.embedding, familiarity) {
        (Some(of_a), Some(of_b), Some(at_home)) if !at_home.is_of_others() => Some([&of_a.parts, &of_b.parts]),
        _ => None,
    };
    warnings
        .extend(parts.zip(predicted).and_then(|((of_a, of_b), predicted)| labelled_otherwise([of_a, of_b], predicted)));
    warnings.extend(doubts(stretch(side_a, side_b, &a_to_b), &a_to_b.confidence));
    let (mut a_to_b, mut b_to_a) =
        (lift(&a_to_b, a, b, labels), lift(&b_to_a, b, a, labels.map(|(of_a, of_b)| (of_b, of_a))));
    warnings.extend(contradicted(&options.landmarks, [a, b], [&a_to_b, &b_to_a], predicted));
    for &[i, j] in &options.landmarks {
        a_to_b.set(i, j);
        b_to_a.set(j, i);
    }
    progress.at(Stage::Correspondence, 1.0)?;

    let matched = Match {
        a_to_b,
        b_to_a,
        raw: raw.map(|raw| lift(&raw, a, b, labels)),
        c_ab: FunctionalMap { matrix: in_uploaded_units(maps.c_ab, a, b) },
        c_ba: FunctionalMap { matrix: in_uploaded_units(maps.c_ba, b, a) },
        seconds: progress.take_seconds(),
        points_used: [side_a.len(), side_b.len()],
        warnings,
        weights,
        fallback,
        device: DeviceKind::Cpu,
        gpu: GpuUse::default(),
    };
    Ok((matched, cues))
}

/// What a match starts from. It stays with the CPU, so that whatever becomes of a device nothing is lost.
struct Pair<'a> {
    shapes: [&'a PreparedShape; 2],
    sides: &'a [Matchable; 2],
    known: Option<Functions>,
    parts: Option<(&'a [u32], &'a [u32])>,
}

/// What a match ends with, at the points used.
struct BestMaps {
    refined: Refined,
    raw: Option<Correspondence>,
    familiarity: Option<Familiarity>,
    weights: serde_json::Value,
}

/// The part of a match that runs on the device: first maps, as many as there are hypotheses, each refined, and the best of them.
async fn best_maps<D: Device>(
    model: &Model<D>,
    pair: &Pair<'_>,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<BestMaps, Interrupted> {
    let Pair { shapes: [a, b], sides, parts, .. } = *pair;
    let [side_a, side_b] = sides;
    let device = model.device();
    let known = pair.known.as_ref().map(|(on_a, on_b)| (on_a.view(), on_b.view()));
    let mut candidates = Vec::new();
    let mut familiarity = None;
    if let (Some(of_a), Some(of_b)) = (&a.embedding, &b.embedding)
        && [of_a, of_b].iter().all(|e| e.features.ncols() == model.weights().config.features)
    {
        let soft = masks(options.parts, of_a, of_b, parts);
        let learned = learned_maps(model, [(side_a, of_a), (side_b, of_b)], &soft, known).await?;
        familiarity = Some(learned.familiarity);
        candidates.push((sides, learned.maps, Some(learned.extra), model.weights().named()));
    }
    let without;
    if familiarity.is_none_or(|at_home| at_home.is_of_others() && !options.network_only) {
        // Many steps on few points: a device would mostly wait.
        let maps = initial_maps(&Cpu, side_a, side_b, known, parts).await;
        without = sides.clone().map(|side| Matchable { parts: None, trust: None, ..side });
        candidates.push((&without, maps, None, serde_json::Value::Null));
    }

    // Whatever made it, a map between two poses of one body keeps lengths. So does its mirror image: which of the two it is the features alone can say, and a
    // mirrored start is no candidate.
    let mut best: Option<(f64, Refined, usize)> = None;
    for (index, (sides, maps, extra, _)) in candidates.iter().enumerate() {
        let ([side_a, side_b], first, extra) = (sides, maps.clone(), extra.as_ref());
        let refined = if index + 1 == candidates.len() {
            refine(device, (side_a, side_b), first, extra, parts, options.refine, progress).await?
        } else {
            // For who listens no stage comes twice.
            let mut within = Progress::new(|_, _| progress.at(Stage::Refine, 0.0).is_ok());
            refine(device, (side_a, side_b), first, extra, parts, options.refine, &mut within).await?
        };
        let strain = strain(side_a, side_b, &refined.a_to_b) + strain(side_b, side_a, &refined.b_to_a);
        if best.as_ref().is_none_or(|(least, ..)| strain < *least) {
            best = Some((strain, refined, index));
        }
    }
    let (_, refined, index) = best.expect("a pair without the network's map has the other");
    let ([side_a, side_b], first, extra, weights) = candidates.swap_remove(index);
    let raw = if options.raw {
        let (unheard, extra) = (&mut Progress::silent(), extra.as_ref());
        Some(refine(device, (side_a, side_b), first, extra, parts, Refinement::None, unheard).await?.a_to_b)
    } else {
        None
    };
    Ok(BestMaps { refined, raw, familiarity, weights })
}

/// Probabilities of parts (p, c) on both sides that attention masks with: predicted, given labels as ones and noughts, or one part for all.
fn masks(
    parts: Parts,
    of_a: &PointEmbedding,
    of_b: &PointEmbedding,
    given: Option<(&[u32], &[u32])>,
) -> [Array2<f32>; 2] {
    match (parts, given) {
        (Parts::Given, Some((labels_a, labels_b))) => {
            let all: BTreeSet<u32> = labels_a.iter().chain(labels_b).copied().collect();
            let column: BTreeMap<u32, usize> =
                all.into_iter().enumerate().map(|(column, label)| (label, column)).collect();
            [labels_a, labels_b].map(|labels: &[u32]| {
                let mut rows = Array2::zeros((labels.len(), column.len()));
                labels.iter().enumerate().for_each(|(i, label)| rows[(i, column[label])] = 1.0);
                rows
            })
        }
        (Parts::Predicted, _) => [of_a.parts.clone(), of_b.parts.clone()],
        _ => [of_a, of_b].map(|embedding| Array2::ones((embedding.parts.nrows(), 1))),
    }
}

/// Points that carry surface: of a mesh those that belong to a face, of a cloud one at each place, because copies would take the
/// places of neighbours.
fn surface_points(shape: &Shape) -> Vec<u32> {
    if shape.faces().is_empty() {
        return shape
            .first_at_place()
            .into_iter()
            .enumerate()
            .filter(|&(i, f)| i == f as usize)
            .map(|(_, f)| f)
            .collect();
    }
    let mut on_surface = vec![false; shape.points().len()];
    shape.faces().iter().flatten().for_each(|&i| on_surface[i as usize] = true);
    (0..on_surface.len() as u32).filter(|&i| on_surface[i as usize]).collect()
}

/// C of bases whose masses sum to 1 as C of the bases that users hold.
fn in_uploaded_units(map: Array2<f64>, from: &PreparedShape, to: &PreparedShape) -> Array2<f64> {
    map * (to.basis.mass.sum() / from.basis.mass.sum()).sqrt()
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

/// The unit in which the longest extent is that of a body, between a small animal and a tall person with raised arms: 0.3 m to 2.6 m.
fn unit(points: &[[f64; 3]]) -> Option<String> {
    let longest = extents(points).into_iter().fold(0.0, f64::max);
    [("m", 1.0), ("cm", 100.0), ("mm", 1000.0)]
        .into_iter()
        .find(|(_, per_metre)| (0.3..2.6).contains(&(longest / per_metre)))
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
