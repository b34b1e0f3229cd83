//! The method, in order. The only file that knows it.

use std::collections::BTreeMap;

use ndarray::Array2;

use crate::device::Device;
use crate::error::Error;
use crate::features::wave_kernel_signature;
use crate::fmap::{Correspondence, FunctionalMap, Matchable, initial_maps, landmark_functions, one_hot_parts, refine};
use crate::graph::components;
use crate::operators::{self, Laplacian, LaplacianKind};
use crate::options::{Axis, FaceUse, MatchOptions, OptionError, Parts, PrepareOptions};
use crate::prepared::{Info, PreparedShape, ShapeKind};
use crate::progress::{Progress, Stage};
use crate::shape::{Repair, Shape, farthest_points, nearest_samples};
use crate::spectrum::{SpectralBasis, check_size, spectrum};

/// Points of the even sampling that refinement iterates on.
const COARSE: usize = 2000;
/// Meshes beyond this many vertices are matched as clouds of their samples.
const MESH_LIMIT: usize = 30_000;

/// Two scans matched.
#[derive(Clone, Debug)]
pub struct Match {
    /// For each uploaded point of A its point on B.
    pub a_to_b: Correspondence,
    /// For each uploaded point of B its point on A.
    pub b_to_a: Correspondence,
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
}

/// Scan → graph → Laplacian → spectrum → features.
pub fn prepare(
    shape: Shape,
    name: Option<String>,
    options: &PrepareOptions,
    progress: &mut Progress,
) -> Result<PreparedShape, Error> {
    options.check()?;
    let as_read = shape;
    let mut repairs = as_read.repairs().to_vec();
    let used_shape = match options.faces {
        FaceUse::Ignore => as_read.clone().without_faces(),
        FaceUse::Use => as_read.welded(),
    };

    progress.at(Stage::Sample, 0.0)?;
    let n = used_shape.points().len();
    let surface = surface_points(&used_shape);
    let whole = surface.len() <= options.points + options.points / 2;
    let samples = match (whole, surface.len() == n) {
        (true, true) => None,
        (true, false) => Some(surface.clone()),
        (false, _) => Some(farthest_points(used_shape.points(), &surface, options.points)),
    };
    // A mesh keeps its own operator; a cloud, or a mesh too large for that, gets the operator of its samples.
    let on_mesh = !used_shape.faces().is_empty() && (samples.is_none() || surface.len() <= MESH_LIMIT);
    if !used_shape.faces().is_empty() && !on_mesh {
        let message = format!(
            "the mesh has {} vertices, more than {MESH_LIMIT}: it was matched as a cloud of {} samples",
            surface.len(),
            options.points
        );
        repairs.push(Repair::noted("mesh-taken-as-cloud", surface.len(), message));
    }
    let kind = options.laplacian.unwrap_or(if on_mesh { LaplacianKind::Cotangent } else { LaplacianKind::Geodesic });
    let on_all_points = samples.is_none() || (on_mesh && kind == LaplacianKind::Cotangent);
    let operator_shape = match &samples {
        Some(samples) if !on_all_points => used_shape.at(samples)?,
        _ => used_shape.clone(),
    };
    check_size(operator_shape.points().len(), options.eigenpairs)?;

    let laplacian = operators::laplacian(&operator_shape, kind, progress)?;
    let (mut basis, report) = spectrum(&laplacian.matrix, &laplacian.mass, options.eigenpairs, progress)?;
    if on_all_points {
        carry_to_bare_points(&mut basis, used_shape.points(), &surface);
    }

    progress.at(Stage::Features, 0.0)?;
    let area = laplacian.area();
    let features = wave_kernel_signature(&at_unit_area(&basis, area)).values;
    let features = match &samples {
        Some(samples) if on_all_points => {
            Array2::from_shape_fn((samples.len(), features.ncols()), |(r, c)| features[(samples[r] as usize, c)])
        }
        _ => features,
    };
    let rows: Vec<[f64; 3]> = match &samples {
        Some(samples) => samples.iter().map(|&i| used_shape.points()[i as usize]).collect(),
        None => used_shape.points().to_vec(),
    };
    let everything: Vec<u32> = (0..rows.len() as u32).collect();
    let coarse = farthest_points(&rows, &everything, COARSE);
    let nearest = samples.as_ref().map(|samples| nearest_samples(used_shape.points(), samples));
    progress.at(Stage::Features, 1.0)?;

    let info = Info {
        kind: if used_shape.faces().is_empty() || !on_mesh { ShapeKind::Cloud } else { ShapeKind::Mesh },
        name,
        points: n,
        faces: as_read.faces().len(),
        pieces: pieces(&laplacian),
        points_used: rows.len(),
        unit: unit(used_shape.points()),
        up_axis: options.up.or_else(|| longest_axis(used_shape.points())),
        scale: area.sqrt(),
        laplacian: kind,
        eigenpairs: basis.k(),
        residual: report.residual,
        seconds: progress.take_seconds(),
    };
    Ok(PreparedShape { shape: as_read, info, repairs, basis, samples, nearest, coarse, features })
}

/// Features of both → functional maps both ways → refinement → correspondence of every uploaded point.
pub async fn match_shapes<D: Device>(
    device: &D,
    a: &PreparedShape,
    b: &PreparedShape,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<Match, Error> {
    progress.at(Stage::FunctionalMap, 0.0)?;
    let parts = match options.parts {
        Parts::Predicted => return Err(OptionError::no_weights().into()),
        Parts::Given => Some(one_hot_parts(&labels_used(a, "a")?, &labels_used(b, "b")?)),
        Parts::None => None,
    };
    let (side_a, side_b) = (a.matchable(), b.matchable());
    let landmarks = landmarks(a, b, &side_a, &side_b, &options.landmarks)?;
    let landmarks = landmarks.as_ref().map(|(on_a, on_b)| (on_a.view(), on_b.view()));
    let (first, rotation) = initial_maps(device, &side_a, &side_b, landmarks).await;

    let parts = parts.as_ref().map(|(on_a, on_b)| (on_a.view(), on_b.view()));
    let (a_to_b, b_to_a, maps) =
        refine(device, (&side_a, &side_b), first, &rotation, parts, options.refine, progress).await?;
    let a_to_b = a_to_b.lift(a.nearest.as_deref(), b.samples.as_deref());
    let b_to_a = b_to_a.lift(b.nearest.as_deref(), a.samples.as_deref());
    progress.at(Stage::Correspondence, 1.0)?;

    Ok(Match {
        a_to_b,
        b_to_a,
        c_ab: FunctionalMap { matrix: in_uploaded_units(maps.c_ab, a, b) },
        c_ba: FunctionalMap { matrix: in_uploaded_units(maps.c_ba, b, a) },
        seconds: progress.take_seconds(),
        points_used: [side_a.len(), side_b.len()],
        warnings: warnings(a, b),
    })
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

/// Points without surface (split at seams, or used by no face) take the eigenfunctions of the nearest point that has some.
fn carry_to_bare_points(basis: &mut SpectralBasis, points: &[[f64; 3]], surface: &[u32]) {
    if surface.len() == points.len() {
        return;
    }
    for (i, row) in nearest_samples(points, surface).into_iter().enumerate() {
        let nearest = surface[row as usize] as usize;
        if nearest != i {
            let values = basis.eigenvectors.row(nearest).to_owned();
            basis.eigenvectors.row_mut(i).assign(&values);
        }
    }
}

/// λ·A, φ·√A, m/A: the basis as if the surface area A were 1.
fn at_unit_area(basis: &SpectralBasis, area: f64) -> SpectralBasis {
    SpectralBasis {
        eigenvalues: &basis.eigenvalues * area,
        eigenvectors: &basis.eigenvectors * area.sqrt(),
        mass: &basis.mass / area,
    }
}

/// C of unit-area bases as C of the bases that users hold, whose eigenfunctions are smaller by √area.
fn in_uploaded_units(map: Array2<f64>, from: &PreparedShape, to: &PreparedShape) -> Array2<f64> {
    map * (to.info.scale / from.info.scale)
}

/// Part labels at the points used.
fn labels_used(shape: &PreparedShape, scan: &str) -> Result<Vec<u32>, OptionError> {
    let labels = shape.shape.labels().ok_or_else(|| OptionError::no_labels(scan))?;
    Ok((0..shape.points_used()).map(|row| labels[shape.uploaded(row)]).collect())
}

/// Coefficients (k, l) of functions that correspond, on A and on B.
type Functions = (Array2<f64>, Array2<f64>);

/// Known pairs as functions on both sides, from uploaded indices.
fn landmarks(
    a: &PreparedShape,
    b: &PreparedShape,
    side_a: &Matchable,
    side_b: &Matchable,
    pairs: &[[u32; 2]],
) -> Result<Option<Functions>, OptionError> {
    if pairs.is_empty() {
        return Ok(None);
    }
    let rows = |shape: &PreparedShape, scan: &str, side: usize| -> Result<Vec<u32>, OptionError> {
        let points = shape.shape.points().len();
        let row = |pair: &[u32; 2]| match pair[side] {
            index if (index as usize) < points => Ok(shape.row_of(index)),
            index => Err(OptionError::landmark(index, scan, points)),
        };
        pairs.iter().map(row).collect()
    };
    let (rows_a, rows_b) = (rows(a, "a", 0)?, rows(b, "b", 1)?);
    Ok(Some((landmark_functions(&side_a.basis, &rows_a), landmark_functions(&side_b.basis, &rows_b))))
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

/// The axis along which the scan is clearly (a fifth) longer than along the others.
fn longest_axis(points: &[[f64; 3]]) -> Option<Axis> {
    let extents = extents(points);
    [Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .enumerate()
        .find_map(|(c, axis)| (0..3).all(|other| other == c || extents[c] > 1.2 * extents[other]).then_some(axis))
}

fn warnings(a: &PreparedShape, b: &PreparedShape) -> Vec<String> {
    let mut warnings =
        vec!["matched without a trained network: where the poses differ, limbs or the whole body may be matched the wrong way round, also at high confidence".to_owned()];
    for (scan, shape) in [("a", a), ("b", b)] {
        if shape.info.pieces > 1 {
            warnings
                .push(format!("scan {scan} is in {} pieces, which have no geodesic between them", shape.info.pieces));
        }
    }
    if a.info.eigenpairs != b.info.eigenpairs {
        warnings.push(format!(
            "the scans have {} and {} eigenpairs; the smaller number is used",
            a.info.eigenpairs, b.info.eigenpairs
        ));
    }
    warnings
}
