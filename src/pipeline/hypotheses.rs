//! Where a match may start from, each start refined, and the best of what comes out.

use ndarray::Array2;

use super::given::{Functions, indicators};
use super::{MatchOptions, Parts, PreparedShape};
use crate::confidence::strain;
use crate::device::{Cpu, Device, Interrupted};
use crate::maps::{Correspondence, Matchable, OutOfDistribution, learned_maps};
use crate::network::{Model, PointEmbedding};
use crate::progress::{Progress, Stage};
use crate::registration::{AWAY, Constraints, Refined, Refinement, initial_maps, refine};

/// What a match starts from. It stays with the CPU, so that whatever becomes of a device nothing is lost.
pub(super) struct Pair<'a> {
    pub(super) shapes: [&'a PreparedShape; 2],
    pub(super) sides: &'a [Matchable; 2],
    pub(super) known: Option<Functions>,
    pub(super) constraints: Constraints<'a>,
}

/// What a match ends with, at the points used.
pub(super) struct BestMaps {
    pub(super) refined: Refined,
    pub(super) raw: Option<Correspondence>,
    pub(super) out_of_distribution: Option<OutOfDistribution>,
    pub(super) weights: serde_json::Value,
    /// Whether landmarks contradict the network's map, so that one made without it was tried as well.
    pub(super) contradicted: bool,
}

/// The part of a match that runs on the device: first maps, as many as there are hypotheses, each refined, and the best of them.
pub(super) async fn best_maps<D: Device>(
    model: &Model<D>,
    pair: &Pair<'_>,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<BestMaps, Interrupted> {
    let Pair { shapes: [a, b], sides, constraints, .. } = *pair;
    let [side_a, side_b] = sides;
    let device = model.device();
    let known = pair.known.as_ref().map(|(on_a, on_b)| (on_a.view(), on_b.view()));
    let mut candidates = Vec::new();
    let mut out_of_distribution = None;
    let mut contradicted = false;
    if let (Some(of_a), Some(of_b)) = (&a.embedding, &b.embedding)
        && [of_a, of_b].iter().all(|e| e.features.ncols() == model.weights().config.features)
    {
        let soft = masks(options.parts, of_a, of_b, constraints.parts);
        let learned = learned_maps(model, [(side_a, of_a), (side_b, of_b)], &soft, known).await?;
        out_of_distribution = Some(learned.out_of_distribution);
        // One landmark may be wrong; where two and more agree with each other and not with the network, another map may agree with them.
        if constraints.landmarks.len() > 1 && !options.network_only {
            let (first, unheard) = (learned.maps.clone(), &mut Progress::silent());
            let as_is = Refinement::None;
            let found =
                refine(device, (side_a, side_b), first, Some(&learned.extra), constraints, as_is, unheard).await?;
            contradicted = found.residual > AWAY;
        }
        candidates.push((sides, learned.maps, Some(learned.extra), model.weights().named()));
    }
    let without;
    if contradicted || out_of_distribution.is_none_or(|at_home| at_home.is_of_others() && !options.network_only) {
        // Many steps on few points: a device would mostly wait.
        let maps = initial_maps(&Cpu, side_a, side_b, known, constraints).await;
        if !maps.is_finite() {
            return Err(Interrupted::NotFinite(Stage::FunctionalMap));
        }
        without = sides.clone().map(|side| Matchable { parts: None, prior: None, ..side });
        candidates.push((&without, maps, None, serde_json::Value::Null));
    }

    // Whatever made it, a map between two poses of one body keeps lengths. So does its mirror image: which of the two it is the features alone can say, and a
    // mirrored start is no candidate. What a map passes landmarks by counts as well as what it strains.
    let mut best: Option<(f64, Refined, usize)> = None;
    for (index, (sides, maps, extra, _)) in candidates.iter().enumerate() {
        let ([side_a, side_b], first, extra) = (sides, maps.clone(), extra.as_ref());
        let refined = if index + 1 == candidates.len() {
            refine(device, (side_a, side_b), first, extra, constraints, options.refine, progress).await?
        } else {
            // For who listens no stage comes twice.
            let mut within = Progress::new(|_, _| progress.at(Stage::Refine, 0.0).is_ok());
            refine(device, (side_a, side_b), first, extra, constraints, options.refine, &mut within).await?
        };
        let strain = strain(side_a, side_b, &refined.a_to_b) + strain(side_b, side_a, &refined.b_to_a);
        let cost = strain + refined.residual;
        if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
            best = Some((cost, refined, index));
        }
    }
    let (_, refined, index) = best.expect("a pair without the network's map has the other");
    let ([side_a, side_b], first, extra, weights) = candidates.swap_remove(index);
    let raw = if options.raw {
        let (unheard, extra) = (&mut Progress::silent(), extra.as_ref());
        Some(refine(device, (side_a, side_b), first, extra, constraints, Refinement::None, unheard).await?.a_to_b)
    } else {
        None
    };
    Ok(BestMaps { refined, raw, out_of_distribution, weights, contradicted })
}

/// Probabilities of parts (p, c) on both sides that attention masks with: predicted, given labels as ones and noughts, or one part for all.
fn masks(
    parts: Parts,
    of_a: &PointEmbedding,
    of_b: &PointEmbedding,
    given: Option<(&[u32], &[u32])>,
) -> [Array2<f32>; 2] {
    match (parts, given) {
        (Parts::Given, Some((labels_a, labels_b))) => indicators(labels_a, labels_b),
        (Parts::Predicted, _) => [of_a.parts.clone(), of_b.parts.clone()],
        _ => [of_a, of_b].map(|embedding| Array2::ones((embedding.parts.nrows(), 1))),
    }
}
