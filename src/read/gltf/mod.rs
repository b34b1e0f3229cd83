//! Binary glTF 2.0 and glTF JSON with its buffers inside.
//!
//! The `gltf` crate knows the document and iterates over accessors, but it trusts lengths: a short GLB header, a stride below the
//! item, or an offset near the end of the address space make it panic. So the container, the document's geometry and every range
//! are checked here before it reads.

mod accessor;
mod container;
mod document;
mod placement;

use gltf::mesh::{Mode, Primitive};
use gltf::{Mesh, Semantic};

use super::draft::Draft;
use super::error::{Place, ReadError};
use accessor::Buffers;
use container::GLTF;
use placement::Placement;

/// Most points and most faces read of a file of so many bytes: a few kilobytes of instances can name the same data a million times.
/// Stored once, a point takes at least three bytes and a triangle two.
fn limit(bytes: usize) -> usize {
    250_000 + bytes / 2
}

/// Reads the POSITION and indices of every mesh in every scene, in the order of a walk through the nodes, each placed by its
/// node. Points that a file splits at seams stay split.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let (json, blob) = container::split(bytes)?;
    let document::Geometry { document, compression, repairs } = document::parse(json)?;
    let buffers = Buffers::of(&document, blob, compression);
    let mut draft = Draft { repairs, ..Draft::default() };
    let limit = limit(bytes.len());
    for (mesh, placement) in placement::placed_meshes(&document)? {
        append(&mesh, &placement, &buffers, limit, &mut draft)?;
    }
    if draft.points.is_empty() {
        return Err(ReadError::MissingElement {
            format: GLTF,
            what: "mesh with points in any of its scenes".to_owned(),
        });
    }
    Ok(draft)
}

/// The points and triangles of one placed mesh, while there are at most `limit`. Primitives that share their points (one surface, several
/// materials) add them once.
fn append(
    mesh: &Mesh,
    placement: &Placement,
    buffers: &Buffers,
    limit: usize,
    draft: &mut Draft,
) -> Result<(), ReadError> {
    let mut added: Vec<(usize, usize)> = Vec::new();
    for primitive in mesh.primitives() {
        let Some(positions) = primitive.get(&Semantic::Positions) else { continue };
        let count = positions.count();
        let known = added.iter().find(|(accessor, _)| *accessor == positions.index());
        let base = match known {
            Some(&(_, base)) => base,
            None => {
                let base = draft.points.len();
                if count > limit - base {
                    return Err(ReadError::TooLarge { format: GLTF, what: "points", limit });
                }
                let points = accessor::positions(positions.clone(), buffers)?;
                draft.points.extend(points.into_iter().map(|p| placement.apply(p)));
                added.push((positions.index(), base));
                base
            }
        };
        let at = || Place::Object(format!("meshes[{}].primitives[{}]", mesh.index(), primitive.index()));
        for mut face in triangles(&primitive, count, buffers, (limit, limit - draft.faces.len()), at)? {
            if let Some(&index) = face.iter().find(|&&i| i as usize >= count) {
                let index = i64::from(index);
                let face = draft.faces.len();
                return Err(ReadError::FaceIndex { format: GLTF, face, index, points: count, first: 0, at: at() });
            }
            if placement.mirrors() {
                face.swap(1, 2);
            }
            draft.faces.push(face.map(|i| base as u32 + i));
        }
    }
    Ok(())
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
