//! From two prepared shapes to the correspondence of every uploaded point.

use std::collections::BTreeMap;

use ndarray::Array2;
use serde::{Deserialize, Serialize};

use super::given::{labels_used, landmark_rows, landmarks, parts_in_common, shared_labels, side_by_side};
use super::hypotheses::{BestMaps, Pair, best_maps};
use super::thinned::MATCHED;
use super::warnings::{Warning, contradicted, labelled_otherwise, of_map, of_shapes, verdict, without_network};
use super::{DeviceKind, Error, GpuUse, MatchOptions, OptionError, Parts, PreparedShape, ShapeKind};
use crate::confidence::{Cues, overlap, stretch};
use crate::device::{Device, Fallback, Interrupted};
use crate::lifting::lift;
use crate::maps::{Correspondence, FunctionalMap, UNMATCHED};
use crate::network::{Model, PointEmbedding, TrainedNetwork, WeightsId};
use crate::progress::{Progress, Stage};
use crate::registration::{Constraints, Refined, sampled_at};

/// A point is left without a partner where its probability to have one is lower: nine in ten like it are alone. A higher bound would take the place of more points that have a partner, and of these
/// a low confidence tells already. Of pieces matched to pieces (12 pairs with seeds from 800201) 75 % of points alone are left so on meshes and 73 % on clouds, and 12 and 17 % of the others, most of
/// which would go astray; at 0.2 it is 82 and 81 %, and 17 and 22 %.
const ALONE: f32 = 0.1;

/// Two scans matched.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Match {
    /// For each uploaded point of A its point on B.
    pub a_to_b: Correspondence,
    /// For each uploaded point of B its point on A.
    pub b_to_a: Correspondence,
    /// For each uploaded point of A the probability that it has a partner on B, and for those of B on A: 1 where both are whole bodies or the other is a closed one, 0 of what is no part of the body.
    pub overlap: [Vec<f32>; 2],
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
    pub warnings: Vec<Warning>,
    /// How large A's body is beside B's.
    pub scale: Scale,
    /// The weights that took part; nothing when none did.
    pub weights: Option<WeightsId>,
    /// Name of the category that the pair is taken to be of; nothing where no network is at home with it.
    pub category: Option<String>,
    /// Where and why the CPU took over from the device; nothing when it did not.
    pub fallback: Option<Fallback>,
    /// The device that it ran on, or began on.
    pub device: DeviceKind,
    /// What was asked of a GPU.
    pub gpu: GpuUse,
}

/// How large A's body is beside B's, each in the unit of its file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Scale {
    /// √area of the whole body that A is, or is a piece of, over that of B's.
    pub ratio: f64,
    /// How it was found.
    pub found: ScaleSource,
}

/// How a ratio of scales was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ScaleSource {
    /// Both are whole: by their areas.
    Areas,
    /// By how much of a body the network takes each for.
    Network,
    /// By that, and then by the lengths that the match keeps.
    Match,
}

impl Scale {
    /// By what A and B are taken for, lengths of A being `longer` than they were taken for.
    fn of(a: &PreparedShape, b: &PreparedShape, longer: f64) -> Self {
        let whole = a.info.share.min(b.info.share) == 1.0;
        let found = match longer == 1.0 {
            true if whole => ScaleSource::Areas,
            true => ScaleSource::Network,
            false => ScaleSource::Match,
        };
        Self { ratio: a.info.scale / b.info.scale / longer, found }
    }
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
    let (mut matched, _) = match_with_cues(model, a, b, options, progress).await?;
    let Match { a_to_b, b_to_a, overlap, .. } = &mut matched;
    [a_to_b, b_to_a].into_iter().zip(overlap).for_each(|(found, overlap)| leave_alone(found, overlap));
    Ok(matched)
}

/// [`match_with`] before any point is left alone, and what confidence was judged by, from A to B and back, at the points used.
pub(crate) async fn match_with_cues<D: Device>(
    model: &Model<D>,
    a: &PreparedShape,
    b: &PreparedShape,
    options: &MatchOptions,
    progress: &mut Progress<'_>,
) -> Result<(Match, [Cues; 2]), Error> {
    let mut report = |_| progress.at(Stage::FunctionalMap, 0.0);
    report(0.0)?;
    check_weights(model, [a, b])?;
    let (a, b) = (&*a.thinned(MATCHED, &mut report)?, &*b.thinned(MATCHED, &mut report)?);
    let parts = match options.parts {
        Parts::Given => Some((labels_used(a, "a")?, labels_used(b, "b")?)),
        Parts::Predicted | Parts::None => None,
    };
    let labels = parts.as_ref().and_then(|_| a.sampled_shape().labels().zip(b.sampled_shape().labels()));
    let parts = parts.as_ref().map(|(of_a, of_b)| (&of_a[..], &of_b[..]));
    if let Some((of_a, of_b)) = labels
        && shared_labels(of_a, of_b).is_empty()
    {
        return Err(OptionError::no_shared_labels(of_a[0], of_b[0]).into());
    }
    let known_rows = landmark_rows(a, b, &options.landmarks)?;
    let mut sides = [a, b].map(PreparedShape::matchable);
    for ((scan, shape), side) in [("A", a), ("B", b)].into_iter().zip(&sides) {
        if !side.is_finite() || !shape.embeddings.iter().all(PointEmbedding::is_finite) {
            return Err(Error::NotFinite { what: format!("scan {scan} as it was prepared") });
        }
    }
    if !known_rows.is_empty() {
        let [side_a, side_b] = sides;
        let rows = |side: usize| known_rows.iter().map(move |pair| pair[side]);
        sides = [sampled_at(side_a, rows(0)), sampled_at(side_b, rows(1))];
    }
    let [side_a, side_b] = &sides;
    let known = [landmarks(&sides, &known_rows), parts.map(|(of_a, of_b)| parts_in_common(side_a, of_a, side_b, of_b))];
    let known = side_by_side(known.into_iter().flatten());
    let constraints = Constraints { parts, landmarks: &known_rows };
    let pair = Pair { shapes: [a, b], sides: &sides, known, constraints };

    let (best, fallback) = match best_maps(model, &pair, options, progress).await {
        Err(interrupted @ (Interrupted::Failed(_) | Interrupted::NotFinite(_))) => {
            (best_maps(&model.on_cpu(), &pair, options, progress).await, interrupted.fallback())
        }
        best => (best, None),
    };
    let BestMaps { refined, raw, home, by_network, contradicted: by_landmarks, longer } = match best {
        Ok(best) => best,
        Err(Interrupted::Cancelled(stop)) => return Err(stop.into()),
        Err(Interrupted::NotFinite(stage)) => {
            return Err(Error::NotFinite { what: format!("what stage {} came to", stage.name()) });
        }
        Err(Interrupted::Failed(_)) => unreachable!("the CPU does not fail"),
    };
    let Refined { mut a_to_b, mut b_to_a, maps, cues, .. } = refined;
    let pieces = sides.iter().any(|side| side.share < 1.0);
    // A whole body has a partner for every point; but what looks whole may lack some of a piece, where it has borders or is a cloud, which does not tell.
    let overlaps = [(&cues[0], b), (&cues[1], a)].map(|(cues, other)| {
        let (whole, cloud) = (other.info.share == 1.0, other.info.kind == ShapeKind::Cloud);
        match !whole || pieces && (other.info.borders || cloud) {
            true => overlap(cues, whole && cloud),
            false => vec![1.0; cues.table.nrows()],
        }
    });
    // A match is right only where there is a partner; on what looks whole there nearly always is.
    let reliability = (a.info.reliability * b.info.reliability) as f32;
    for (found, overlap, other) in [(&mut a_to_b, &overlaps[0], b), (&mut b_to_a, &overlaps[1], a)] {
        let is_there = |overlap: f32| if other.info.share < 1.0 { overlap } else { 1.0 };
        let both = found.confidence.iter_mut().zip(overlap);
        both.for_each(|(confidence, &overlap)| *confidence *= reliability * is_there(overlap));
    }
    let untrained = home.is_none().then(without_network);
    let mut warnings: Vec<Warning> = untrained.into_iter().chain(of_shapes(a, b)).collect();
    warnings.extend(home.as_ref().and_then(|home| verdict(home, !by_network, by_landmarks, pieces)));
    let predicted = home.as_ref().filter(|home| !home.scores.is_of_others()).map(|home| home.embeddings);
    warnings
        .extend(parts.zip(predicted).and_then(|((of_a, of_b), predicted)| labelled_otherwise([of_a, of_b], predicted)));
    let mut to_scale = side_a.clone();
    to_scale.points *= longer;
    let has_partner = |row: usize| overlaps[0][row] >= ALONE;
    let with_partner: Vec<f32> =
        (0..side_a.len()).filter(|&row| has_partner(row)).map(|row| a_to_b.confidence[row]).collect();
    warnings.extend(of_map(stretch(&to_scale, side_b, &a_to_b, has_partner), &with_partner));
    progress.at(Stage::Correspondence, 0.9)?;
    let lifted = |found: &Correspondence, from: &PreparedShape, to: &PreparedShape, labels| {
        from.between_uploaded(lift(found, from.sampled(), to.sampled(), labels), to)
    };
    let (mut a_to_b, mut b_to_a) =
        (lifted(&a_to_b, a, b, labels), lifted(&b_to_a, b, a, labels.map(|(of_a, of_b)| (of_b, of_a))));
    let mut overlap = [(&a_to_b, a, &overlaps[0]), (&b_to_a, b, &overlaps[1])].map(|(found, from, overlap)| {
        let at_point = |(i, &target)| if target == UNMATCHED { 0.0 } else { overlap[from.support.row_of(i)] };
        found.target.iter().enumerate().map(at_point).collect::<Vec<f32>>()
    });
    warnings.extend(contradicted(&options.landmarks, [a, b], [&a_to_b, &b_to_a], predicted));
    for &[i, j] in &options.landmarks {
        a_to_b.set(i, j);
        b_to_a.set(j, i);
        (overlap[0][i as usize], overlap[1][j as usize]) = (1.0, 1.0);
    }
    progress.at(Stage::Correspondence, 1.0)?;

    let matched = Match {
        a_to_b,
        b_to_a,
        overlap,
        raw: raw.map(|raw| lifted(&raw, a, b, labels)),
        c_ab: FunctionalMap { matrix: in_uploaded_units(maps.c_ab, a, b) },
        c_ba: FunctionalMap { matrix: in_uploaded_units(maps.c_ba, b, a) },
        seconds: progress.take_seconds(),
        points_used: [side_a.len(), side_b.len()],
        warnings,
        scale: Scale::of(a, b, longer),
        weights: home.as_ref().filter(|_| by_network).map(|home| home.embeddings[0].weights.clone()),
        category: predicted.map(|[of_a, _]| of_a.category.name.clone()),
        fallback,
        device: DeviceKind::Cpu,
        gpu: GpuUse::default(),
    };
    Ok((matched, cues))
}

/// Points that probably have no partner are left without.
fn leave_alone(found: &mut Correspondence, overlap: &[f32]) {
    for ((target, confidence), overlap) in found.target.iter_mut().zip(&mut found.confidence).zip(overlap) {
        if *overlap < ALONE {
            (*target, *confidence) = (UNMATCHED, 0.0);
        }
    }
}

/// Refuses a scan of which none of the networks at hand made its embedding, and two that have none of these in common.
fn check_weights<D: Device>(model: &Model<D>, pair: [&PreparedShape; 2]) -> Result<(), OptionError> {
    let networks = model.networks();
    let loaded: Vec<&WeightsId> = networks.iter().map(|network| network.id()).collect();
    let known = |shape: &PreparedShape, network: &TrainedNetwork<D::Tensor>| {
        shape.embeddings.is_empty() || shape.embedding_of(network).is_some()
    };
    for (scan, before, shape) in [("A", None, pair[0]), ("B", Some(pair[0]), pair[1])] {
        if !networks.iter().any(|network| known(shape, network) && before.is_none_or(|before| known(before, network))) {
            let prepared: Vec<&WeightsId> = shape.embeddings.iter().map(|embedding| &embedding.weights).collect();
            return Err(OptionError::other_weights(scan, &prepared, &loaded));
        }
    }
    Ok(())
}

/// C of bases whose masses sum to 1 as C of the bases that users hold.
fn in_uploaded_units(map: Array2<f64>, from: &PreparedShape, to: &PreparedShape) -> Array2<f64> {
    map * (to.basis.mass.sum() / from.basis.mass.sum()).sqrt()
}
