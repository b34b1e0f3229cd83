//! Where a match may start from, each start refined, and the best of what comes out.

use ndarray::Array2;

use super::given::{Functions, indicators};
use super::{MatchOptions, Parts, PreparedShape};
use crate::confidence::{relative_scale, strain};
use crate::device::{Cpu, Device, Interrupted};
use crate::maps::{Correspondence, LearnedCues, MapPair, Matchable, OutOfDistribution, learned_maps};
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
pub(super) struct BestMaps<'a> {
    pub(super) refined: Refined,
    pub(super) raw: Option<Correspondence>,
    /// The network that is most at home with the pair; nothing where none was asked.
    pub(super) home: Option<Home<'a>>,
    /// Whether its map was taken.
    pub(super) by_network: bool,
    /// Whether landmarks contradict the network's map, so that one made without it was tried as well.
    pub(super) contradicted: bool,
    /// How much longer lengths of A turned out to be than they were taken for, where one of the two is a piece.
    pub(super) longer: f64,
}

/// A network's view of a pair.
pub(super) struct Home<'a> {
    pub(super) embeddings: [&'a PointEmbedding; 2],
    pub(super) scores: OutOfDistribution,
}

/// A map to refine.
struct Start<T> {
    sides: [Matchable; 2],
    maps: MapPair,
    extra: Option<[T; 2]>,
}

/// The part of a match that runs on the device: first maps, as many as there are hypotheses, each refined, and the best of them.
pub(super) async fn best_maps<'a, D: Device>(
    model: &Model<D>,
    pair: &Pair<'a>,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<BestMaps<'a>, Interrupted> {
    let Pair { sides, constraints, .. } = *pair;
    let device = model.device();
    let (home, mut starts) = match learned_start(model, pair, options).await? {
        Some((home, start)) => (Some(home), vec![start]),
        None => (None, Vec::new()),
    };
    let mut contradicted = false;
    // One landmark may be wrong; where two and more agree with each other and not with the network, another map may agree with them.
    if let Some(Start { sides: [side_a, side_b], maps, extra }) = starts.first()
        && constraints.landmarks.len() > 1
        && !options.network_only
    {
        let (first, silent, as_is) = (maps.clone(), &mut Progress::silent(), Refinement::None);
        let found = refine(device, (side_a, side_b), first, extra.as_ref(), constraints, as_is, silent).await?;
        contradicted = found.residual > AWAY;
    }
    // Without a network a piece is laid onto whatever is as large.
    let piece = sides.iter().any(|side| side.share < 1.0);
    if contradicted || home.as_ref().is_none_or(|home| home.scores.is_of_others() && !options.network_only && !piece) {
        let known = pair.known.as_ref().map(|(on_a, on_b)| (on_a.view(), on_b.view()));
        // Many steps on few points: a device would mostly wait.
        let maps = initial_maps(&Cpu, &sides[0], &sides[1], known, constraints).await;
        if !maps.is_finite() {
            return Err(Interrupted::NotFinite(Stage::FunctionalMap));
        }
        starts.push(Start { sides: sides.clone(), maps, extra: None });
    }

    // Whatever made it, a map between two poses of one body keeps lengths. So does its mirror image: which of the two it is the features alone can say, and a
    // mirrored start is no candidate. What a map passes landmarks by counts as well as what it strains.
    let mut best: Option<(f64, Refined, usize, f64)> = None;
    let count = starts.len();
    for (index, Start { sides, maps, extra }) in starts.iter_mut().enumerate() {
        let (first, extra) = (maps.clone(), extra.as_ref());
        let longer = match piece && extra.is_some() && options.refine != Refinement::None {
            true => to_scale(device, sides, maps, extra, constraints).await?,
            false => 1.0,
        };
        let [side_a, side_b] = &*sides;
        let refined = if index + 1 == count {
            refine(device, (side_a, side_b), first, extra, constraints, options.refine, progress).await?
        } else {
            // A listener is not told of a stage twice.
            let mut within = Progress::new(|_, _| progress.at(Stage::Refine, 0.0).is_ok());
            refine(device, (side_a, side_b), first, extra, constraints, options.refine, &mut within).await?
        };
        let strain = strain(side_a, side_b, &refined.a_to_b) + strain(side_b, side_a, &refined.b_to_a);
        let cost = strain + refined.residual;
        if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
            best = Some((cost, refined, index, longer));
        }
    }
    let (_, refined, index, longer) = best.expect("a pair without the network's map has the other");
    let Start { sides: [side_a, side_b], maps, extra } = starts.swap_remove(index);
    let by_network = extra.is_some();
    let raw = if options.raw {
        let (silent, extra) = (&mut Progress::silent(), extra.as_ref());
        Some(refine(device, (&side_a, &side_b), maps, extra, constraints, Refinement::None, silent).await?.a_to_b)
    } else {
        None
    };
    Ok(BestMaps { refined, raw, home, by_network, contradicted, longer })
}

/// Scales the smaller of two pieces so that the match by features alone keeps lengths, and returns the factor by which lengths of A grow: the shares that the network gives each piece by itself are only rough.
async fn to_scale<D: Device>(
    device: &D,
    [side_a, side_b]: &mut [Matchable; 2],
    maps: &MapPair,
    extra: Option<&[D::Tensor; 2]>,
    constraints: Constraints<'_>,
) -> Result<f64, Interrupted> {
    let (as_is, silent) = (Refinement::None, &mut Progress::silent());
    let found = refine(device, (side_a, side_b), maps.clone(), extra, constraints, as_is, silent).await?;
    let longer = relative_scale([side_a, side_b], [&found.a_to_b, &found.b_to_a]).unwrap_or(1.0);
    if side_a.share <= side_b.share {
        side_a.points *= longer;
    } else {
        side_b.points /= longer;
    }
    Ok(longer)
}

/// The maps of the network that is most at home with a pair, of those that looked at both shapes.
async fn learned_start<'a, D: Device>(
    model: &Model<D>,
    pair: &Pair<'a>,
    options: &MatchOptions,
) -> Result<Option<(Home<'a>, Start<D::Tensor>)>, Interrupted> {
    let Pair { shapes: [a, b], sides: [side_a, side_b], constraints, .. } = *pair;
    let known = pair.known.as_ref().map(|(on_a, on_b)| (on_a.view(), on_b.view()));
    let mut best: Option<(Home, Start<D::Tensor>)> = None;
    for trained in model.networks() {
        let (Some(of_a), Some(of_b)) = (a.embedding_of(trained), b.embedding_of(trained)) else { continue };
        let soft = masks(options.parts, of_a, of_b, constraints.parts);
        let learned = learned_maps(model.device(), trained, [(side_a, of_a), (side_b, of_b)], &soft, known).await?;
        let home = Home { embeddings: [of_a, of_b], scores: learned.out_of_distribution };
        if best.as_ref().is_some_and(|(other, _)| other.scores.is_more_at_home_than(&home.scores)) {
            continue;
        }
        let sides = [(side_a, of_a), (side_b, of_b)].map(|(side, embedding)| {
            let cues = LearnedCues::new(embedding, trained.prior(embedding));
            Matchable { learned: Some(cues), ..side.clone() }
        });
        best = Some((home, Start { sides, maps: learned.maps, extra: Some(learned.extra) }));
    }
    Ok(best)
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
