//! Which part of a scan is the body, where there may be something else in it: a floor, a box, another body.
//!
//! `shape/scene.rs` proposes from geometry what the scan may be without; the proposal is taken that a network is more certain of, or
//! as certain while the body has more of its parts. With version 4 of the weights on three sample bodies as meshes and as
//! clouds the mean certainty of parts is 0.973 to 0.976; with a floor plate of 0.7 m it is 0.84 to 0.94, with a floor of 2 m 0.61 to 0.65, with a wall behind 0.68 to
//! 0.76, with a box 0.71 to 0.89, with another person or a child beside 0.72 to 0.93.

use ndarray::Array1;

use super::embedding::ask;
use super::geometry::Carriers;
use super::reliability::reliability;
use super::scan::{STRAYS, prepare_with_carriers};
use super::surface::used_as;
use super::{Error, FaceUse, PrepareOptions, PreparedShape, share};
use crate::device::Device;
use crate::network::Model;
use crate::operators::Laplacian;
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::{
    Aside, COARSE_NUMBERS, LeftOut, Proposal, Repair, Shape, has_borders, loose_pieces, proposals, thin_parts,
};

/// By so much more certain a network must be without something for it to be left out, and of a smaller thing than of a larger one.
const MORE_CERTAIN: f64 = 0.02;
/// Of a plane that lies free under or behind all else geometry is nearly certain already.
const A_FLOOR: f64 = 0.005;
/// Without something that is no part of it a body lacks no more parts than before: their coverage is not less by more than this. Of fifteen views of `faust_pieces`
/// in fragments coverage is less by 0.01 to 0.35 without some in thirteen, and more in two; without a floor, a box, a ball or another person it is more.
const LACKS: f64 = 0.03;
/// A part is plainly there where a shape has this share of the area that is expected of it, and gone where it has less than the other.
const PLAINLY_THERE: f64 = 0.5;
const GONE: f64 = 0.2;
/// With so much more of the area that is expected of its parts a view of a scan need only be as certain: a network may be as sure of a box as of a chest, but then
/// the body has too much of that, and too little of all else (coverage 0.52 with a box behind, 0.84 with a ball before a hand, 0.98 without).
const MORE_COVERED: f64 = 0.05;
/// A mesh with borders is looked at as a cloud, too, unless a network is clear about it: more certain than the category's threshold by this part of the way from there to 1. Worked out from
/// matches as meshes and as clouds, with a quarter taken so, errors of 48 pairs with held-out pieces go from 19.2 to 15.9 with version 6 of the weights; measured, those of 120 of
/// `faust_pieces` from 6.1 to 4.9. The border of a hole is nothing that a body has.
const SURE: f64 = 0.5;
/// Of that cloud the network may be less certain than the category's threshold by this much.
const NEARLY_SURE: f64 = 0.06;
/// The network that ships learned from clouds of 1100 points and more. Of fewer it may be certain by chance, as of a wavy grid of 144.
const FEWEST: usize = 1000;
/// Where no network is at home, a plane with at least this share of the area that all else lies on one side of is a floor all the same.
const FLOOR: f64 = 0.15;
/// No loose piece is looked for where a network is clear about the body: by this part of the way from the category's threshold to 1.
const CLEAR: f64 = 2.0 / 3.0;
/// Fewer strays are dirt, and no part of a body.
const LEFT_OF_A_LIMB: usize = 8;
/// What confidence is worth where a limb may have been set aside.
const DOUBTFUL: f64 = 0.5;
/// Rounds: a floor and a second person are two.
const ROUNDS: usize = 3;

/// The code of a repair.
const THIN_PARTS: &str = "thin-parts-kept";

/// What is to be prepared.
pub(super) struct Scan<'o> {
    pub(super) shape: Shape,
    pub(super) name: Option<String>,
    pub(super) options: &'o PrepareOptions,
    pub(super) wanted: usize,
}

/// A scan before limbs are told apart.
type Prepared = (PreparedShape, Carriers, Laplacian);

/// The body in a scan, looked at by the networks.
pub(super) async fn body_of<D: Device>(
    model: &Model<D>,
    scan: Scan<'_>,
    progress: &mut Progress<'_>,
) -> Result<Prepared, Error> {
    let used = used_as(&scan.shape, scan.options.faces, &mut Vec::new());
    let mut aside = Aside::default();
    let whole = scan.options.whole_scan;
    // Between coordinates in coarse steps the surface lies in sheets, which are no floors.
    let in_sheets = scan.shape.repairs().iter().any(|repair| repair.code == COARSE_NUMBERS);
    let mut found = if whole || in_sheets { Vec::new() } else { proposals(&used, &aside) };
    let (as_read, name) = (scan.shape.clone(), scan.name.clone());
    let (mut prepared, carriers, laplacian) =
        prepare_with_carriers(as_read, name, scan.options, &aside, scan.wanted, progress)?;
    ask(model, &mut prepared, &carriers, None, scan.options.share, 0.2..0.4, progress).await?;
    let whole_scan = cover(&prepared);
    let mut best = (prepared, carriers, laplacian);
    let mut left = 1.0;
    let mut said: Vec<Repair> = Vec::new();
    for _ in 0..if whole { 0 } else { ROUNDS } {
        // More is looked for when a mesh turns out to be put together from shells, or a cloud to have strays.
        if best.0.resampled.is_some() && !is_clear(&best.0, CLEAR) {
            found.extend(loose_pieces(&used, &aside, scan.options.points));
        }
        if used.faces().is_empty()
            && aside.thin_parts.is_empty()
            && best.0.repairs.iter().any(|repair| repair.code == STRAYS)
        {
            found.extend(thin_parts(&used, &aside));
        }
        let mut taken: Option<(Prepared, Proposal)> = None;
        for proposal in found {
            let without = aside.and(&proposal);
            let Some(view) = view(model, &scan, scan.options, &without, progress).await? else { continue };
            let than = taken.as_ref().map_or(&best.0, |((prepared, ..), _)| prepared);
            if is_better(&view.0, than, &proposal) && !lacks_parts_of(&view.0, &whole_scan, &proposal) {
                taken = Some((view, proposal));
            }
        }
        let Some((prepared, proposal)) = taken else { break };
        aside = aside.and(&proposal);
        said.push(repair(&proposal, left * proposal.share));
        left *= if proposal.what == LeftOut::NoThinParts { 1.0 } else { 1.0 - proposal.share };
        best = prepared;
        found = if in_sheets { Vec::new() } else { proposals(&used, &aside) };
    }
    let enough = scan.shape.points().len().min(scan.options.points) >= FEWEST;
    if has_borders(used.faces()) && enough && scan.options.laplacian.is_none() && !is_clear(&best.0, SURE) {
        let options = PrepareOptions { faces: FaceUse::Ignore, ..scan.options.clone() };
        let cloud = view(model, &scan, &options, &aside, progress).await?;
        if let Some(cloud) = cloud.filter(|cloud| is_more_of_a_body([margin(&cloud.0), margin(&best.0)])) {
            let message = "the mesh has borders, and without its faces it looks more like a part of a body: its points were taken as a cloud";
            said.push(Repair::noted("taken-as-cloud", used.faces().len(), message.to_owned()));
            best = cloud;
        }
    }
    let (mut prepared, carriers, laplacian) = best;
    prepared.info.borders = has_borders(used.faces());
    let (reliability, doubt) = reliability(&prepared, &carriers, &laplacian.mass);
    prepared.info.reliability = reliability;
    prepared.repairs.extend(doubt.into_iter().chain(said));
    if let Some(doubt) = lost_limbs(&prepared) {
        // A piece lacks parts as pieces do.
        prepared.info.reliability *= if prepared.info.share < 1.0 { 1.0 } else { DOUBTFUL };
        prepared.repairs.push(doubt);
    }
    Ok((prepared, carriers, laplacian))
}

/// A scan without the points `aside`, and what networks make of that; nothing where what is left is no shape.
async fn view<D: Device>(
    model: &Model<D>,
    scan: &Scan<'_>,
    options: &PrepareOptions,
    aside: &Aside,
    progress: &mut Progress<'_>,
) -> Result<Option<Prepared>, Error> {
    // A listener is not told of a stage twice.
    let mut within = Progress::new(|_, _| progress.at(Stage::Features, 0.4).is_ok());
    let (shape, name) = (scan.shape.clone(), scan.name.clone());
    let (mut prepared, carriers, laplacian) =
        match prepare_with_carriers(shape, name, options, aside, scan.wanted, &mut within) {
            Ok(prepared) => prepared,
            Err(Error::Cancelled(_)) => return Err(Cancelled { stage: Stage::Features }.into()),
            Err(_) => return Ok(None),
        };
    ask(model, &mut prepared, &carriers, None, options.share, 0.2..0.4, &mut within).await?;
    Ok(Some((prepared, carriers, laplacian)))
}

/// Whether the points of a mesh as a cloud may be a body or a piece of one, and a network is more certain of them than of the mesh, by the [`margin`] of either: a cloud hangs together across
/// holes.
fn is_more_of_a_body([cloud, mesh]: [Option<f64>; 2]) -> bool {
    cloud.zip(mesh).is_some_and(|(cloud, mesh)| cloud > mesh + MORE_CERTAIN && cloud >= -NEARLY_SURE)
}

/// Whether a network is more certain of one view of a scan than of another; where none is at home with either, whether what the one is without is a floor.
fn is_better(one: &PreparedShape, other: &PreparedShape, without: &Proposal) -> bool {
    match (margin(one), margin(other)) {
        (Some(certain), Some(less)) if certain >= 0.0 => {
            let (covered, before) = (coverage(one), coverage(other));
            let floor = without.what == LeftOut::Floor;
            let more = if floor { A_FLOOR } else { MORE_CERTAIN };
            certain > less + more && (floor || covered >= before - LACKS)
                || certain >= less && covered >= before + MORE_COVERED
        }
        (_, Some(other)) if other >= 0.0 => false,
        _ => without.what == LeftOut::Floor && without.share >= FLOOR,
    }
}

/// Whether a network is more certain of a shape than the category's threshold by this part of the way from there to 1, or none knows others.
fn is_clear(shape: &PreparedShape, by: f64) -> bool {
    let asked = shape.embeddings.first().map(|embedding| embedding.category.thresholds.certainty);
    margin(shape).zip(asked).is_none_or(|(margin, asked)| margin >= by * (1.0 - asked))
}

/// By how much the network that is most at home with a shape is more certain of its parts than it asks for; nothing where none knows others.
fn margin(shape: &PreparedShape) -> Option<f64> {
    shape.embeddings.first().filter(|embedding| embedding.category.knows_others()).map(share::margin)
}

/// How much of the area that its category expects of each part a shape has, at most 1 of each.
fn cover(shape: &PreparedShape) -> Vec<f64> {
    let Some(embedding) = shape.embeddings.first() else { return Vec::new() };
    let rows = embedding.parts.nrows();
    // Of a simplified mesh points are evenly spread, and have no mass each.
    let even = Array1::ones(rows);
    let mass = if shape.basis.mass.len() == rows { &shape.basis.mass } else { &even };
    let mut found = vec![0.0_f64; embedding.category.parts.len()];
    for (row, mass) in embedding.parts.outer_iter().zip(mass) {
        found.iter_mut().zip(row).for_each(|(sum, &share)| *sum += mass * f64::from(share));
    }
    let all: f64 = mass.iter().sum();
    embedding.category.parts.iter().zip(found).map(|(part, found)| (found / (all * part.area)).min(1.0)).collect()
}

/// The same of all parts together: 1 for a whole body, less for one that lacks parts or has too much of some.
fn coverage(shape: &PreparedShape) -> f64 {
    let Some(embedding) = shape.embeddings.first() else { return 0.0 };
    let parts = &embedding.category.parts;
    let expected: f64 = parts.iter().map(|part| part.area).sum();
    let covered: f64 = parts.iter().zip(cover(shape)).map(|(part, cover)| part.area * cover).sum();
    if expected > 0.0 { covered / expected } else { 1.0 }
}

/// Says so where strays were set aside and the body lacks parts: a few points of a leg are no surface.
fn lost_limbs(shape: &PreparedShape) -> Option<Repair> {
    let strays = shape.repairs.iter().find(|repair| repair.code == STRAYS && repair.count >= LEFT_OF_A_LIMB)?;
    let at_home = margin(shape).is_some_and(|margin| margin >= 0.0);
    let parts = &shape.embeddings.first().filter(|_| at_home)?.category.parts;
    let gone: Vec<&str> =
        parts.iter().zip(cover(shape)).filter(|(_, cover)| *cover < GONE).map(|(part, _)| &*part.name).collect();
    let message =
        format!("the body seems to have no {}; the points set aside may be what the scan has of it", gone.join(", "));
    (!gone.is_empty()).then(|| Repair::noted("limbs-lost", strays.count, message))
}

/// Whether one of several things lacks a part that the whole scan has: then the others are no other things but limbs, beyond a gap.
fn lacks_parts_of(one: &PreparedShape, whole_scan: &[f64], without: &Proposal) -> bool {
    let now = cover(one);
    without.what == LeftOut::OtherThings
        && now.iter().zip(whole_scan).any(|(&now, &before)| before >= PLAINLY_THERE && now < GONE)
}

fn repair(Proposal { what, points, .. }: &Proposal, share: f64) -> Repair {
    let percent = (100.0 * share).round();
    let (code, what) = match what {
        LeftOut::Floor => ("floor-set-aside", "a floor or a wall was set aside"),
        LeftOut::Furniture => ("furniture-set-aside", "what is flat, as a box or a chair is, was set aside"),
        LeftOut::NoThinParts => (THIN_PARTS, "parts with so few points that they looked like strays were kept"),
        LeftOut::Garment => ("garment-set-aside", "a garment was set aside and goes with the body below it"),
        LeftOut::Piece => ("piece-set-aside", "a piece that is no part of the body was set aside"),
        LeftOut::OtherThings => ("others-set-aside", "other things than the body were set aside"),
    };
    let message = match code {
        THIN_PARTS => format!("{what}, {percent} % of the surface"),
        _ => format!("{what}, {percent} % of the surface: what is left looks more like one body"),
    };
    Repair::noted(code, points.len(), message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_taken_as_a_cloud_where_a_network_is_more_and_nearly_certain_of_that() {
        let taken = |cloud: f64, mesh: f64| is_more_of_a_body([Some(cloud), Some(mesh)]);
        assert!(taken(0.05, 0.0) && taken(0.9 * -NEARLY_SURE, -0.2));
        assert!(!taken(0.5 * MORE_CERTAIN, 0.0), "as certain of the mesh");
        assert!(!taken(1.1 * -NEARLY_SURE, -0.2), "certain of neither");
        assert!(!is_more_of_a_body([Some(0.1), None]) && !is_more_of_a_body([None, Some(-0.1)]), "nobody is asked");
    }
}
