//! Binary glTF 2.0 and glTF JSON with its buffers inside.
//!
//! The `gltf` crate knows the document and iterates over accessors, but it trusts lengths: a short GLB header, a stride below the
//! item, or an offset near the end of the address space make it panic. So the container, the document's geometry and every range
//! are checked here before it reads.

mod accessor;
mod budget;
mod buffers;
mod compressed;
mod container;
mod document;
mod meshopt;
mod placement;
mod pose;

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use gltf::mesh::{Mode, Primitive};
use gltf::{Accessor, Node, Semantic};

use super::draft::Draft;
use super::error::{Place, ReadError};
use super::options::ReadOptions;
use crate::shape::Repair;
use budget::Budget;
use buffers::{Buffers, Sources};
use container::{Chunks, GLTF};
use placement::{Placed, Placement};
use pose::Skeletons;

/// Reads the POSITION and indices of every mesh in every scene, in the order of a walk through the nodes, each where it stands: placed by its
/// node, or moved by joints, for which the node of the mesh does not count. Points that a file splits at seams stay split.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Draft, ReadError> {
    let Chunks { json, blob, unpadded } = container::split(bytes)?;
    let size = bytes.len() + options.companions.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
    let mut budget = Budget::of(size);
    let document::Geometry { document, compression, compressed, mut repairs } =
        document::parse(json, options.pose, &mut budget)?;
    repairs.extend(Repair::counted("chunk-not-padded", usize::from(unpadded), || {
        "the JSON of this GLB does not end at a multiple of four bytes, as the format asks; read all the same"
            .to_owned()
    }));
    let placed = placement::placed_meshes(&document)?;
    let (points, faces) = drawn(&placed, &mut budget)?;
    let sources = Sources { blob, companions: options.companions, compression: compression.as_deref() };
    let buffers = Buffers::of(&document, sources, &compressed);
    let (points, faces) = (Vec::with_capacity(points), Vec::with_capacity(faces));
    let mut scene = Scene {
        skeletons: Skeletons::of(&document, &buffers),
        buffers: &buffers,
        budget,
        draft: Draft { points, faces, repairs, labels: None },
    };
    for placed in &placed {
        scene.append(placed)?;
    }
    if scene.draft.points.is_empty() {
        return Err(ReadError::MissingElement {
            format: GLTF,
            what: "mesh with points in any of its scenes".to_owned(),
        });
    }
    Ok(scene.draft)
}

/// How many points and faces of meshes will be read, if all that is held for them is within the budget.
fn drawn(placed: &[Placed], budget: &mut Budget) -> Result<(usize, usize), ReadError> {
    let (mut points, mut faces) = (0, 0);
    for placed in placed {
        let mut known = BTreeSet::new();
        for primitive in placed.mesh.primitives() {
            let Some(positions) = primitive.get(&Semantic::Positions) else { continue };
            let count = positions.count();
            let added = if known.insert(sources(&primitive, &positions)) { count } else { 0 };
            let corners = primitive.indices().map_or(count, |accessor| accessor.count());
            let added = (added, triangles_of(primitive.mode(), corners));
            // One more for the time that a primitive without points takes.
            budget.draw(added.0.saturating_add(1), added.1)?;
            (points, faces) = (points + added.0, faces + added.1);
        }
    }
    Ok((points, faces))
}

/// What is read so far, and of what.
struct Scene<'a> {
    buffers: &'a Buffers<'a>,
    skeletons: Skeletons,
    budget: Budget,
    draft: Draft,
}

/// Points of a primitive in the draft.
struct Added {
    base: usize,
    mirrored: bool,
}

impl Scene<'_> {
    /// The points and triangles of one placed mesh. Primitives that share their points (one surface, several materials) add them once.
    fn append(&mut self, placed: &Placed) -> Result<(), ReadError> {
        let mut added: BTreeMap<Vec<Option<usize>>, Added> = BTreeMap::new();
        for primitive in placed.mesh.primitives() {
            let Some(positions) = primitive.get(&Semantic::Positions) else { continue };
            let count = positions.count();
            let &mut Added { base, mirrored } = match added.entry(sources(&primitive, &positions)) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let base = self.draft.points.len();
                    let mirrored = self.add_points(placed, &primitive, positions)?;
                    new.insert(Added { base, mirrored })
                }
            };
            let at = || Place::Object(format!("meshes[{}].primitives[{}]", placed.mesh.index(), primitive.index()));
            for mut face in triangles(&primitive, count, self.buffers, &at)? {
                if let Some(&index) = face.iter().find(|&&i| i as usize >= count) {
                    let index = i64::from(index);
                    let face = self.draft.faces.len();
                    return Err(ReadError::FaceIndex { format: GLTF, face, index, points: count, first: 0, at: at() });
                }
                if mirrored {
                    face.swap(1, 2);
                }
                self.draft.faces.push(face.map(|i| base as u32 + i));
            }
        }
        Ok(())
    }

    /// Adds the points of a primitive where they stand, and says whether its triangles turn inside out there.
    fn add_points(&mut self, placed: &Placed, primitive: &Primitive, positions: Accessor) -> Result<bool, ReadError> {
        let base = self.draft.points.len();
        self.draft.points.extend(accessor::positions(positions, self.buffers)?);
        let points = &mut self.draft.points[base..];
        let node = placed.node.as_ref();
        let weights = node.and_then(Node::weights).or_else(|| placed.mesh.weights()).unwrap_or_default();
        pose::morph(points, primitive, weights, self.buffers, &mut self.budget)?;
        if let Some(mirrored) = self.skeletons.move_points(points, node, primitive, self.buffers)? {
            return Ok(mirrored);
        }
        // What hangs on a skin stands where the skin was bound, whatever its node says.
        let bound = node.is_some_and(|node| node.skin().is_some());
        let placement = if bound { Placement::IDENTITY } else { placed.placement };
        points.iter_mut().for_each(|point| *point = placement.apply(*point));
        Ok(placement.mirrors())
    }
}

/// The accessors that the points of a primitive come from.
fn sources(primitive: &Primitive, positions: &Accessor) -> Vec<Option<usize>> {
    let attributes = primitive.attributes().filter(|(semantic, _)| *semantic != Semantic::Positions);
    let mut moving: Vec<usize> = attributes.map(|(_, accessor)| accessor.index()).collect();
    moving.sort_unstable();
    let targets = primitive.morph_targets().map(|target| target.positions().map(|accessor| accessor.index()));
    std::iter::once(Some(positions.index())).chain(moving.into_iter().map(Some)).chain(targets).collect()
}

/// Triangles that so many corners make; none of points and lines.
fn triangles_of(mode: Mode, corners: usize) -> usize {
    match mode {
        Mode::Triangles => corners / 3,
        Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
        _ => 0,
    }
}

/// The triangles of a primitive, in indices of its own points; none for points and lines.
fn triangles<'a>(
    primitive: &Primitive<'a>,
    points: usize,
    buffers: &'a Buffers,
    at: &dyn Fn() -> Place,
) -> Result<impl Iterator<Item = [u32; 3]> + use<'a>, ReadError> {
    let mode = primitive.mode();
    let corners = match primitive.indices() {
        _ if triangles_of(mode, 3) == 0 => Box::new(std::iter::empty()),
        Some(accessor) => accessor::indices(accessor, buffers)?,
        None => Box::new(0..points as u32),
    };
    if mode == Mode::Triangles {
        let count = primitive.indices().map_or(points, |accessor| accessor.count());
        if !count.is_multiple_of(3) {
            let problem = format!("{count} corners do not make whole triangles");
            return Err(ReadError::Malformed { format: GLTF, problem, at: at() });
        }
    }
    let (mut first, mut before) = (0, [0; 2]);
    Ok(corners.enumerate().filter_map(move |(i, corner)| {
        let [a, b] = before;
        before = [b, corner];
        if i == 0 {
            first = corner;
        }
        match mode {
            _ if i < 2 => None,
            Mode::Triangles => (i % 3 == 2).then_some([a, b, corner]),
            Mode::TriangleStrip if i % 2 == 1 => Some([a, corner, b]),
            Mode::TriangleStrip => Some([a, b, corner]),
            _ => Some([b, corner, first]),
        }
    }))
}
