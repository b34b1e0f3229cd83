//! The pose a file stands in: morph targets at their weights, then each point moved by the joints it hangs on (linear blend skinning;
//! glTF 2.0, sections 3.7.2.2 and 3.7.3).

use gltf::mesh::Primitive;
use gltf::{Document, Node, Semantic, Skin};

use super::accessor;
use super::buffers::Buffers;
use super::container::GLTF;
use super::placement::{Placement, placements};
use crate::read::error::{Place, ReadError};

/// Sets of four joints a point may hang on that are looked at.
const SETS: u32 = 8;

/// What joints do to points: for each joint of each skin, its place in the scene after the inverse of its place when the skin was bound.
pub(super) struct Skeletons(Vec<Result<Vec<Placement>, ReadError>>);

impl Skeletons {
    pub fn of(document: &Document, buffers: &Buffers) -> Self {
        if document.skins().len() == 0 {
            return Self(Vec::new());
        }
        let places = placements(document);
        Self(document.skins().map(|skin| joints(&skin, &places, buffers)).collect())
    }

    /// The maps of the points of a primitive that hangs on a skin, if it hangs on one.
    pub fn maps(
        &self,
        node: Option<&Node>,
        primitive: &Primitive,
        points: usize,
        buffers: &Buffers,
    ) -> Result<Option<Vec<Placement>>, ReadError> {
        let Some(skin) = node.and_then(Node::skin) else { return Ok(None) };
        let mut sets = Vec::new();
        for set in 0..SETS {
            let (joints, weights) = (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)));
            let (Some(joints), Some(weights)) = (joints, weights) else { break };
            for accessor in [&joints, &weights] {
                if accessor.count() != points {
                    return Err(accessor::malformed(accessor, "it has another number of items than there are points"));
                }
            }
            sets.push((accessor::joints(joints, buffers)?, accessor::weights(weights, buffers)?));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let skeleton = self.0[skin.index()].as_ref().map_err(Clone::clone)?;
        let mut maps = Vec::with_capacity(points);
        for point in 0..points {
            let hangs = || sets.iter().flat_map(|(joints, weights)| joints[point].into_iter().zip(weights[point]));
            let total: f64 = hangs().map(|(_, weight)| weight).sum();
            // Weights sum to one but for rounding; a point without any hangs on its first joint.
            let first = sets[0].0[point][0];
            let shares = hangs().filter(|(_, weight)| *weight != 0.0).map(|(joint, weight)| (joint, weight / total));
            let alone = std::iter::once((first, 1.0)).filter(|_| total == 0.0);
            let shares = shares.filter(|_| total != 0.0).chain(alone);
            let missing = shares.clone().find(|(joint, _)| usize::from(*joint) >= skeleton.len());
            if let Some((joint, _)) = missing {
                let problem = format!("point {point} hangs on joint {joint}, but the skin has {}", skeleton.len());
                let at = Place::Object(format!("skins[{}]", skin.index()));
                return Err(ReadError::Malformed { format: GLTF, problem, at });
            }
            maps.push(Placement::blend(shares.map(|(joint, share)| (share, skeleton[usize::from(joint)]))));
        }
        Ok(Some(maps))
    }
}

fn joints(skin: &Skin, places: &[Option<Placement>], buffers: &Buffers) -> Result<Vec<Placement>, ReadError> {
    let malformed = |problem: String| {
        let at = Place::Object(format!("skins[{}]", skin.index()));
        ReadError::Malformed { format: GLTF, problem, at }
    };
    let count = skin.joints().count();
    let inverses =
        skin.inverse_bind_matrices().map(|accessor| accessor::matrices(accessor, count, buffers)).transpose()?;
    if let Some(found) = inverses.as_ref().map(Vec::len).filter(|found| *found < count) {
        return Err(malformed(format!("it has {count} joints and {found} inverse bind matrices")));
    }
    let place = |node: Node| {
        places[node.index()].ok_or_else(|| malformed(format!("its joint nodes[{}] is its own ancestor", node.index())))
    };
    skin.joints()
        .enumerate()
        .map(|(k, node)| {
            let inverse = inverses.as_ref().map_or(Placement::IDENTITY, |all| Placement::from_matrix(all[k]));
            Ok(place(node)?.after(&inverse))
        })
        .collect()
}

/// Adds the morph targets of a primitive to its points, at the weights of its node or else of its mesh. Of `limit` points of targets `room`
/// may still be read.
pub(super) fn morph(
    points: &mut [[f64; 3]],
    primitive: &Primitive,
    weights: &[f32],
    buffers: &Buffers,
    (limit, room): (usize, &mut usize),
) -> Result<(), ReadError> {
    for (target, &weight) in primitive.morph_targets().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        let Some(accessor) = target.positions() else { continue };
        if accessor.count() != points.len() {
            return Err(accessor::malformed(&accessor, "a morph target needs as many items as there are points"));
        }
        *room = room.checked_sub(points.len()).ok_or(ReadError::TooLarge {
            format: GLTF,
            what: "points of morph targets",
            limit,
        })?;
        for (point, by) in points.iter_mut().zip(accessor::positions(accessor, buffers)?) {
            point.iter_mut().zip(by).for_each(|(c, d)| *c += f64::from(weight) * d);
        }
    }
    Ok(())
}
