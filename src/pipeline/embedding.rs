//! What the networks make of a shape.

use std::ops::Range;

use ndarray::{Array2, s};

use super::geometry::Carriers;
use super::share::{certainty, guesses, is_piece, margin, share_of_extent};
use super::{Error, PreparedShape};
use crate::device::{Cpu, Device, Interrupted, still_well};
use crate::network::{InputConfig, Model, PointEmbedding, ShapeInputs, TrainedNetwork};
use crate::operators::{EdgeFilter, Gradient, gradient_around};
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::is_closed;

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
            for guess in guesses(piece) {
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
    Ok((embedding, extent.map_or(1.0, share_of_extent)))
}

/// Categories that know others and are at home with the shape come first, then those that know none, then those that are not at home; and by how much the
/// parts of the shape are more certain than the category asks for.
fn rank(embedding: &PointEmbedding) -> (u8, f64) {
    let margin = margin(embedding);
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
