//! Binary glTF 2.0 and glTF JSON with its buffers inside.
//!
//! The `gltf` crate knows the document and iterates over accessors, but it trusts lengths: a short GLB header, a stride below the
//! item, or an offset near the end of the address space make it panic. So the container, the document's geometry and every range
//! are checked here before it reads.

mod accessor;
mod buffers;
mod compressed;
mod container;
mod document;
mod meshopt;
mod placement;
mod pose;

use gltf::mesh::{Mode, Primitive};
use gltf::{Accessor, Node, Semantic};

use super::draft::Draft;
use super::error::{Place, ReadError};
use super::options::ReadOptions;
use crate::shape::Repair;
use buffers::{Buffers, Sources};
use container::{Chunks, GLTF};
use placement::{Placed, Placement};
use pose::Skeletons;

/// Most points and most faces read of a file of so many bytes: a few kilobytes of instances can name the same data a million times.
/// Stored once, a point takes at least three bytes and a triangle two.
fn limit(bytes: usize) -> usize {
    250_000 + bytes / 2
}

/// Most points of morph targets read for each point that may be read.
const TARGETS: usize = 8;

/// Bytes that one byte of a file may be decompressed into, beside the first [`UNFOLDED`].
const UNFOLDING: usize = 64;
const UNFOLDED: usize = 1 << 20;

/// Reads the POSITION and indices of every mesh in every scene, in the order of a walk through the nodes, each where it stands: placed by its
/// node, or moved by joints, for which the node of the mesh does not count. Points that a file splits at seams stay split.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Draft, ReadError> {
    let Chunks { json, blob, unpadded } = container::split(bytes)?;
    let size = bytes.len() + options.companions.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
    let document::Geometry { document, compression, compressed, mut repairs } =
        document::parse(json, options.pose, UNFOLDED + UNFOLDING * size)?;
    repairs.extend(Repair::counted("chunk-not-padded", usize::from(unpadded), || {
        "the JSON of this GLB does not end at a multiple of four bytes, as the format asks; read all the same"
            .to_owned()
    }));
    let unfolded: usize = compressed.iter().map(|view| view.bytes()).sum();
    let sources = Sources { blob, companions: options.companions, compression: compression.as_deref() };
    let buffers = Buffers::of(&document, sources, &compressed);
    let limit = limit(size + unfolded);
    let mut scene = Scene {
        skeletons: Skeletons::of(&document, &buffers),
        buffers,
        limit,
        targets: TARGETS * limit,
        draft: Draft { repairs, ..Draft::default() },
    };
    for placed in placement::placed_meshes(&document)? {
        scene.append(&placed)?;
    }
    if scene.draft.points.is_empty() {
        return Err(ReadError::MissingElement {
            format: GLTF,
            what: "mesh with points in any of its scenes".to_owned(),
        });
    }
    Ok(scene.draft)
}

/// What is read so far, and of what.
struct Scene<'a> {
    buffers: Buffers<'a>,
    skeletons: Skeletons,
    /// Most points, and most faces.
    limit: usize,
    /// Points of morph targets that may still be read.
    targets: usize,
    draft: Draft,
}

/// Points of a primitive in the draft.
struct Added {
    /// The accessors they come from.
    from: Vec<Option<usize>>,
    base: usize,
    mirrored: bool,
}

impl Scene<'_> {
    /// The points and triangles of one placed mesh. Primitives that share their points (one surface, several materials) add them once.
    fn append(&mut self, placed: &Placed) -> Result<(), ReadError> {
        let mut added: Vec<Added> = Vec::new();
        for primitive in placed.mesh.primitives() {
            let Some(positions) = primitive.get(&Semantic::Positions) else { continue };
            let count = positions.count();
            let from = sources(&primitive, &positions);
            let known = added.iter().position(|a| a.from == from);
            if known.is_none() {
                let base = self.draft.points.len();
                let mirrored = self.add_points(placed, &primitive, positions)?;
                added.push(Added { from, base, mirrored });
            }
            let Added { base, mirrored, .. } = added[known.unwrap_or(added.len() - 1)];
            let at = || Place::Object(format!("meshes[{}].primitives[{}]", placed.mesh.index(), primitive.index()));
            let room = (self.limit, self.limit - self.draft.faces.len());
            for mut face in triangles(&primitive, count, &self.buffers, room, at)? {
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
        let count = positions.count();
        if count > self.limit - self.draft.points.len() {
            return Err(ReadError::TooLarge { format: GLTF, what: "points", limit: self.limit });
        }
        let mut points = accessor::positions(positions, &self.buffers)?;
        let node = placed.node.as_ref();
        let weights = node.and_then(Node::weights).or_else(|| placed.mesh.weights()).unwrap_or_default();
        let room = (TARGETS * self.limit, &mut self.targets);
        pose::morph(&mut points, primitive, weights, &self.buffers, room)?;
        if let Some(maps) = self.skeletons.maps(node, primitive, count, &self.buffers)? {
            let moved = points.into_iter().zip(&maps).map(|(point, map)| map.apply(point));
            self.draft.points.extend(moved);
            let mirrored = maps.iter().filter(|map| map.mirrors()).count();
            return Ok(2 * mirrored > maps.len());
        }
        // What hangs on a skin stands where the skin was bound, whatever its node says.
        let bound = node.is_some_and(|node| node.skin().is_some());
        let placement = if bound { Placement::IDENTITY } else { placed.placement };
        self.draft.points.extend(points.into_iter().map(|p| placement.apply(p)));
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

/// The triangles of a primitive, in indices of its own points; none for points and lines. At most `room` of the `limit` of them.
fn triangles(
    primitive: &Primitive,
    points: usize,
    buffers: &Buffers,
    (limit, room): (usize, usize),
    at: impl Fn() -> Place,
) -> Result<Vec<[u32; 3]>, ReadError> {
    let mode = primitive.mode();
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(Vec::new());
    }
    let length = primitive.indices().map_or(points, |accessor| accessor.count());
    let count = if mode == Mode::Triangles { length / 3 } else { length.saturating_sub(2) };
    if count > room {
        return Err(ReadError::TooLarge { format: GLTF, what: "faces", limit });
    }
    let corners: Vec<u32> = match primitive.indices() {
        Some(accessor) => accessor::indices(accessor, buffers)?,
        None => (0..points as u32).collect(),
    };
    Ok(match mode {
        Mode::Triangles => {
            let (triangles, rest) = corners.as_chunks::<3>();
            if !rest.is_empty() {
                let problem = format!("{} corners do not make whole triangles", corners.len());
                return Err(ReadError::Malformed { format: GLTF, problem, at: at() });
            }
            triangles.to_vec()
        }
        Mode::TriangleStrip => {
            let turn = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] };
            corners.windows(3).enumerate().map(turn).collect()
        }
        _ => corners.windows(2).skip(1).map(|side| [side[0], side[1], corners[0]]).collect(),
    })
}
