//! The pose a file stands in: morph targets at their weights, then each point moved by the joints it hangs on (linear blend skinning;
//! glTF 2.0, sections 3.7.2.2 and 3.7.3).

use gltf::mesh::Primitive;
use gltf::{Document, Node, Semantic, Skin};

use super::accessor;
use super::budget::Budget;
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

    /// Moves the points of a primitive that hangs on a skin, and says whether they turn inside out; nothing where it hangs on none.
    pub fn move_points(
        &self,
        points: &mut [[f64; 3]],
        node: Option<&Node>,
        primitive: &Primitive,
        buffers: &Buffers,
    ) -> Result<Option<bool>, ReadError> {
        let Some(skin) = node.and_then(Node::skin) else { return Ok(None) };
        let mut sets = Vec::new();
        for set in 0..SETS {
            let (joints, weights) = (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)));
            let (Some(joints), Some(weights)) = (joints, weights) else { break };
            for accessor in [&joints, &weights] {
                if accessor.count() != points.len() {
                    return Err(accessor::malformed(accessor, "it has another number of items than there are points"));
                }
            }
            sets.push(accessor::joints(joints, buffers)?.zip(accessor::weights(weights, buffers)?));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let skeleton = self.0[skin.index()].as_ref().map_err(Clone::clone)?;
        let (mut hangs, mut mirrored) = (Vec::new(), 0);
        for (point, place) in points.iter_mut().enumerate() {
            hangs.clear();
            hangs.extend(sets.iter_mut().filter_map(Iterator::next).flat_map(|(j, w)| j.into_iter().zip(w)));
            let mut total: f64 = hangs.iter().map(|(_, weight)| weight).sum();
            // Weights sum to one but for rounding; a point without any hangs on its first joint.
            if total == 0.0 {
                hangs.truncate(1);
                hangs.iter_mut().for_each(|(_, weight)| *weight = 1.0);
                total = 1.0;
            }
            hangs.retain(|(_, weight)| *weight != 0.0);
            if let Some((joint, _)) = hangs.iter().find(|(joint, _)| usize::from(*joint) >= skeleton.len()) {
                let problem = format!("point {point} hangs on joint {joint}, but the skin has {}", skeleton.len());
                let at = Place::Object(format!("skins[{}]", skin.index()));
                return Err(ReadError::Malformed { format: GLTF, problem, at });
            }
            let shares = hangs.iter().map(|&(joint, weight)| (weight / total, skeleton[usize::from(joint)]));
            let map = Placement::blend(shares);
            *place = map.apply(*place);
            mirrored += usize::from(map.mirrors());
        }
        Ok(Some(2 * mirrored > points.len()))
    }
}

fn joints(skin: &Skin, places: &[Option<Placement>], buffers: &Buffers) -> Result<Vec<Placement>, ReadError> {
    let malformed = |problem: String| {
        let at = Place::Object(format!("skins[{}]", skin.index()));
        ReadError::Malformed { format: GLTF, problem, at }
    };
    let count = skin.joints().count();
    let found = skin.inverse_bind_matrices().map(|accessor| accessor.count());
    if let Some(found) = found.filter(|found| *found < count) {
        return Err(malformed(format!("it has {count} joints and {found} inverse bind matrices")));
    }
    let mut inverses =
        skin.inverse_bind_matrices().map(|accessor| accessor::matrices(accessor, buffers)).transpose()?;
    let place = |node: Node| {
        places[node.index()].ok_or_else(|| malformed(format!("its joint nodes[{}] is its own ancestor", node.index())))
    };
    let mut joints = Vec::with_capacity(count);
    for node in skin.joints() {
        let inverse = inverses.as_mut().and_then(Iterator::next).map_or(Placement::IDENTITY, Placement::from_matrix);
        joints.push(place(node)?.after(&inverse));
    }
    Ok(joints)
}

/// Adds the morph targets of a primitive to its points, at the weights of its node or else of its mesh.
pub(super) fn morph(
    points: &mut [[f64; 3]],
    primitive: &Primitive,
    weights: &[f32],
    buffers: &Buffers,
    budget: &mut Budget,
) -> Result<(), ReadError> {
    for (target, &weight) in primitive.morph_targets().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        let Some(accessor) = target.positions() else { continue };
        if accessor.count() != points.len() {
            return Err(accessor::malformed(&accessor, "a morph target needs as many items as there are points"));
        }
        budget.target(points.len())?;
        for (point, by) in points.iter_mut().zip(accessor::positions(accessor, buffers)?) {
            point.iter_mut().zip(by).for_each(|(c, d)| *c += f64::from(weight) * d);
        }
    }
    Ok(())
}
