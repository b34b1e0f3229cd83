//! What the networks make of a shape.

use std::ops::Range;

use ndarray::{Array2, Axis, s};

use super::geometry::Carriers;
use super::options::LEAST;
use super::{Error, PreparedShape};
use crate::device::{Cpu, Device, Interrupted, still_well};
use crate::network::{InputConfig, Model, PointEmbedding, ShapeInputs, TrainedNetwork};
use crate::operators::{EdgeFilter, Gradient, gradient_around};
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::is_closed;

/// A shape with this share of a body's surface is taken for a whole one.
const NEARLY_WHOLE: f64 = 0.85;
/// What a piece is looked at as: so many times what it is taken for as if it were whole. The most certain look counts. On 48 held-out pieces of five kinds (cuts, few and many holes, single views, boxes) 73, 89,
/// 71, 67 and 82 % of points had the right of 14 parts when the first guess was believed, 72, 86, 81, 83 and 95 % when it was taken only where that made the network more certain, and with these guesses
/// 77, 87, 82, 85 and 96 %.
const GUESSES: [f64; 5] = [1.0, 0.5, 0.7, 1.4, 2.0];
/// Of the certainty that a category asks of a shape, a piece needs this share: it has fewer marks to be known by. On 48 held-out pieces certainty was 0.69 to 0.97, on one of them
/// below 0.75; heaps of eggs that were taken for half a person had 0.73.
const OF_PIECES: f64 = 0.85;
/// Of the area that a body has of a part, a shape on which it is there has more than this share; and the parts that are there have on a body this share of the shape's at the least.
const THERE: f64 = 0.1;
const LARGEST: f64 = 0.5;

/// What the networks make of a shape, within a range of the stage: first that of the category that the shape is most at home with. Where it is not `known` how much of a body it is, it is looked
/// at as if it were whole, and a piece then as about as much of a body as it is taken for.
pub(super) async fn ask<D: Device>(
    model: &Model<D>,
    prepared: &mut PreparedShape,
    carriers: &Carriers,
    filter: Option<EdgeFilter<'_>>,
    known: Option<f64>,
    span: Range<f64>,
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    progress.at(Stage::Features, span.start)?;
    if model.networks().is_empty() {
        return Ok(());
    }
    // Gradients ask for a graph again, but a listener is not told of a stage twice.
    let mut within = Progress::new(|_, _| progress.at(Stage::Features, span.start).is_ok());
    let gradient = gradient_around(&carriers.shape, &carriers.neighbourhood, filter, &mut within)
        .map_err(|_| Cancelled { stage: Stage::Features })?;
    drop(within);
    let mut seen = Vec::new();
    for index in 0..model.networks().len() {
        prepared.take_for_piece(known.unwrap_or(1.0));
        let (whole, piece) = look(model, index, prepared, &gradient).await?;
        progress.at(Stage::Features, span.end)?;
        if let Some(known) = known {
            seen.push((whole, known));
            continue;
        }
        // A surface without an end is whole, as nothing that the network learned from was cut and closed again. How large the whole body is tells what a limb looks like.
        let piece = if piece < 1.0 && is_closed(carriers.shape.faces()) { 1.0 } else { piece };
        let mut closest: Option<(PointEmbedding, f64)> = None;
        if piece < 1.0 {
            // As whole it was seen before.
            for guess in GUESSES.map(|factor| factor * piece).into_iter().filter(|&guess| guess < 1.0) {
                prepared.take_for_piece(guess);
                let closer = look(model, index, prepared, &gradient).await?;
                if certainty(&closer.0) > certainty(closest.as_ref().map_or(&whole, |(embedding, _)| embedding)) {
                    closest = Some(closer);
                }
            }
        }
        // What is no piece is seen as whole.
        seen.push(match closest {
            Some(closer) if is_piece(&closer.0, closer.1) => closer,
            None if is_piece(&whole, piece) => (whole, piece),
            _ => (whole, 1.0),
        });
    }
    seen.sort_by(|(x, _), (y, _)| rank(x).0.cmp(&rank(y).0).then(rank(y).1.total_cmp(&rank(x).1)));
    prepared.take_for_piece(seen.first().map_or(1.0, |&(_, piece)| piece));
    prepared.embeddings = seen.into_iter().map(|(embedding, _)| embedding).collect();
    Ok(())
}

/// What one of the networks makes of a shape, taken for as much of a body as `prepared` says; and how much of a body it is by what the network says, 1 of what is nearly whole.
async fn look<D: Device>(
    model: &Model<D>,
    index: usize,
    prepared: &mut PreparedShape,
    gradient: &Gradient,
) -> Result<(PointEmbedding, f64), Error> {
    let trained = &model.networks()[index];
    let inputs = network_inputs(prepared, gradient, &trained.weights().config.input());
    let (embedding, extent) = match embed(model.device(), trained, &inputs).await {
        Ok(seen) => seen,
        Err(Interrupted::Cancelled(stop)) => return Err(stop.into()),
        Err(interrupted) => {
            prepared.info.fallback = interrupted.fallback();
            model.on_cpu().networks()[index].embed(&Cpu, &inputs).await
        }
    };
    if !embedding.is_finite() {
        return Err(Error::NotFinite { what: "what the network says of a scan".to_owned() });
    }
    let piece = extent.map_or(1.0, |extent| f64::from(extent * extent));
    Ok((embedding, if piece < NEARLY_WHOLE { piece.max(LEAST) } else { 1.0 }))
}

/// Whether a shape may be that much of the surface of a body: its parts are certain enough, and those that are there at all make up for it. What is none of the category is no piece of it.
fn is_piece(embedding: &PointEmbedding, share: f64) -> bool {
    let category = &embedding.category;
    let parts = embedding.parts.mean_axis(Axis(0)).unwrap_or_default();
    let there = category
        .parts
        .iter()
        .zip(&parts)
        .filter(|(part, of_points)| f64::from(**of_points) * share > THERE * part.area);
    let most: f64 = there.map(|(part, _)| part.area).sum();
    share < 1.0 && certainty(embedding) >= OF_PIECES * category.thresholds.certainty && most >= LARGEST * share
}

/// Categories that know others and are at home with the shape come first, then those that know none, then those that are not at home; and by how much the
/// parts of the shape are more certain than the category asks for.
fn rank(embedding: &PointEmbedding) -> (u8, f64) {
    let margin = certainty(embedding) - embedding.category.thresholds.certainty;
    let place = match (embedding.category.knows_others(), margin >= 0.0) {
        (true, true) => 0,
        (false, _) => 1,
        (true, false) => 2,
    };
    (place, margin)
}

/// How certain a network is of the parts of a shape, every point counting the same.
fn certainty(embedding: &PointEmbedding) -> f64 {
    embedding.certainty(std::iter::repeat(1.0 / embedding.parts.nrows().max(1) as f64))
}

async fn embed<D: Device>(
    device: &D,
    trained: &TrainedNetwork<D::Tensor>,
    inputs: &ShapeInputs,
) -> Result<(PointEmbedding, Option<f32>), Interrupted> {
    let (embedding, extent) = trained.embed(device, inputs).await;
    still_well(device, Stage::Features)?;
    if embedding.is_finite() { Ok((embedding, extent)) } else { Err(Interrupted::NotFinite(Stage::Features)) }
}

/// What the network sees of a prepared shape with this gradient at its carriers.
pub(crate) fn network_inputs(prepared: &PreparedShape, gradient: &Gradient, config: &InputConfig) -> ShapeInputs {
    let matchable = prepared.matchable();
    let k = config.eigenpairs.min(prepared.basis.k());
    let unit_area = prepared.basis.mass.sum();
    let rows: Vec<usize> = match &prepared.support.used {
        Some(used) => used.iter().map(|&carrier| carrier as usize).collect(),
        None => (0..prepared.basis.len()).collect(),
    };
    // Φ grows with √area and ∂ with it once more when lengths are measured in √area of the shape.
    let extent = prepared.info.share.sqrt();
    let scale = unit_area.sqrt() * prepared.info.scale * extent;
    let gradients = gradient.along.each_ref().map(|along| {
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
    ShapeInputs::new(&matchable.basis, [along.view(), across.view()], matchable.points.view(), extent, config)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_has_parts_that_make_up_for_it_and_is_certain_of_them() {
        let trained = &Model::embedded().networks()[0];
        let category = trained.category();
        // Ten points of each of these parts, with this certainty.
        let seen = |parts: &[usize], certainty: f32| {
            let rest = (1.0 - certainty) / (category.parts.len() - 1) as f32;
            let of = |(i, part)| if parts[i / 10] == part { certainty } else { rest };
            PointEmbedding {
                weights: trained.id().clone(),
                category: category.clone(),
                features: Array2::zeros((10 * parts.len(), 1)),
                parts: Array2::from_shape_fn((10 * parts.len(), category.parts.len()), of),
            }
        };
        let above_the_waist: Vec<usize> = (0..8).collect();
        assert!(is_piece(&seen(&above_the_waist, 0.95), 0.5));
        assert!(!is_piece(&seen(&above_the_waist, 0.6), 0.5), "not certain");
        assert!(!is_piece(&seen(&above_the_waist, 0.95), 1.0), "whole");
        // A ball is all head.
        assert!(is_piece(&seen(&[0], 0.95), 0.1));
        assert!(!is_piece(&seen(&[0], 0.95), 0.7));
    }
}
