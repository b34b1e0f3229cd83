//! Which part of a scan is the body, where there may be something else in it: a floor, a box, another body.
//!
//! `shape/scene.rs` proposes from geometry what the scan may be without; the proposal is taken that a network is more certain of. On three sample bodies as meshes and as
//! clouds the mean certainty of parts is 0.973 to 0.976; with a floor plate of 0.7 m it is 0.84 to 0.94, with a floor of 2 m 0.61 to 0.65, with a wall behind 0.68 to
//! 0.76, with a box 0.71 to 0.89, with another person or a child beside 0.72 to 0.93.

use ndarray::Axis;

use super::embedding::ask;
use super::geometry::Carriers;
use super::scan::prepare_with_carriers;
use super::surface::used_as;
use super::{Error, PrepareOptions, PreparedShape};
use crate::device::Device;
use crate::network::Model;
use crate::operators::Laplacian;
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::{Aside, LeftOut, Proposal, Repair, Shape, garments, proposals};

/// By so much more certain a network must be without something for it to be left out, and of a smaller thing than of a larger one.
const MORE_CERTAIN: f64 = 0.02;
/// Of things alone the body is not one that lacks parts: the coverage of its parts is not less than that of all things together by more than this.
const LACKS: f64 = 0.1;
/// Where no network is at home, a plane with at least this share of the area that all else lies on one side of is a floor all the same.
const FLOOR: f64 = 0.15;
/// No garment is looked for where a network is more certain than its category asks for by this part of what there is to 1.
const CLEAR: f64 = 2.0 / 3.0;
/// Rounds: a floor and a second person are two.
const ROUNDS: usize = 3;

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
    let mut found = if whole { Vec::new() } else { proposals(&used, &aside) };
    // Garments are looked for when a mesh turns out to be put together from shells.
    let again =
        (!found.is_empty() || !whole && !used.faces().is_empty()).then(|| (scan.shape.clone(), scan.name.clone()));
    let (mut prepared, carriers, laplacian) =
        prepare_with_carriers(scan.shape, scan.name, scan.options, &aside, scan.wanted, progress)?;
    ask(model, &mut prepared, &carriers, None, 0.2..0.4, progress).await?;
    let mut best = (prepared, carriers, laplacian);
    let Some((shape, name)) = again else { return Ok(best) };
    let mut said: Vec<Repair> = Vec::new();
    for _ in 0..ROUNDS {
        if best.0.resampled.is_some() && !is_clear(&best.0) {
            found.extend(garments(&used, &aside, scan.options.points));
        }
        let mut taken: Option<(Prepared, Proposal)> = None;
        for proposal in found {
            // A listener is not told of a stage twice.
            let mut within = Progress::new(|_, _| progress.at(Stage::Features, 0.4).is_ok());
            let without = aside.and(&proposal);
            let prepared =
                prepare_with_carriers(shape.clone(), name.clone(), scan.options, &without, scan.wanted, &mut within);
            let (mut prepared, carriers, laplacian) = match prepared {
                Ok(prepared) => prepared,
                Err(Error::Cancelled(_)) => return Err(Cancelled { stage: Stage::Features }.into()),
                // What is left is no shape.
                Err(_) => continue,
            };
            ask(model, &mut prepared, &carriers, None, 0.2..0.4, &mut within).await?;
            let than = taken.as_ref().map_or(&best.0, |((prepared, ..), _)| prepared);
            if is_better(&prepared, than, &proposal) {
                taken = Some(((prepared, carriers, laplacian), proposal));
            }
        }
        let Some((prepared, proposal)) = taken else { break };
        aside = aside.and(&proposal);
        said.push(repair(&proposal));
        best = prepared;
        found = proposals(&used, &aside);
    }
    best.0.repairs.extend(said);
    Ok(best)
}

/// Whether a network is more certain of one view of a scan than of another; where none is at home with either, whether what the one is without is a floor.
fn is_better(one: &PreparedShape, other: &PreparedShape, without: &Proposal) -> bool {
    match (margin(one), margin(other)) {
        (Some(certain), Some(less)) if certain >= 0.0 => {
            let whole = without.what != LeftOut::OtherThings || coverage(one) >= coverage(other) - LACKS;
            certain > less + MORE_CERTAIN && whole
        }
        (_, Some(other)) if other >= 0.0 => false,
        _ => without.what == LeftOut::Floor && without.share >= FLOOR,
    }
}

/// Whether a network is as certain of a shape as of bare bodies.
fn is_clear(shape: &PreparedShape) -> bool {
    let asked = shape.embeddings.first().map(|embedding| embedding.category.thresholds.certainty);
    margin(shape).zip(asked).is_none_or(|(margin, asked)| margin >= CLEAR * (1.0 - asked))
}

/// By how much the network that is most at home with a shape is more certain of its parts than it asks for; nothing where none knows others.
fn margin(shape: &PreparedShape) -> Option<f64> {
    let embedding = shape.embeddings.first().filter(|embedding| embedding.category.knows_others())?;
    let share = 1.0 / embedding.parts.nrows().max(1) as f64;
    Some(embedding.certainty(std::iter::repeat(share)) - embedding.category.thresholds.certainty)
}

/// How much of the area that its category expects of each part a shape has: 1 for a whole body, less for one that lacks parts or has too much of some.
fn coverage(shape: &PreparedShape) -> f64 {
    let Some(embedding) = shape.embeddings.first() else { return 0.0 };
    let (parts, points) = (&embedding.category.parts, embedding.parts.nrows().max(1) as f64);
    let found = embedding.parts.sum_axis(Axis(0));
    let (mut covered, mut expected) = (0.0, 0.0);
    for (part, &found) in parts.iter().zip(&found) {
        covered += part.area.min(f64::from(found) / points);
        expected += part.area;
    }
    if expected > 0.0 { covered / expected } else { 1.0 }
}

fn repair(Proposal { what, points, share }: &Proposal) -> Repair {
    let percent = (100.0 * share).round();
    let (code, what) = match what {
        LeftOut::Floor => ("floor-set-aside", "a floor or a wall was set aside"),
        LeftOut::Furniture => ("furniture-set-aside", "what is flat, as a box or a chair is, was set aside"),
        LeftOut::Garment => ("garment-set-aside", "a garment was set aside and goes with the body below it"),
        LeftOut::OtherThings => ("others-set-aside", "other things than the body were set aside"),
    };
    let message = format!("{what}, {percent} % of the surface: what is left looks more like one body");
    Repair::noted(code, points.len(), message)
}
