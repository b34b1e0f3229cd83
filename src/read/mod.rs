//! Bytes to a [`Shape`], whatever the format.
//!
//! Every reader bounds what it allocates by the bytes that are there, never by a count the file claims, and says where it
//! stopped. Point `i` of the shape is point `i` of the file.

mod draft;
mod encoding;
mod error;
mod foreign;
mod format;
mod gltf;
mod obj;
mod off;
mod options;
mod ply;
mod polygons;
mod stl;
mod table;
mod text;

pub use error::ReadError;
pub(crate) use error::shortened;
pub use format::Format;
pub use options::{Pose, ReadOptions};

use crate::shape::{Axis, Shape};
use draft::Draft;

/// The triangles of an OFF in the order of its file, also those that a shape leaves out: ground truth may name faces by number.
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
pub(crate) fn faces_as_written(off: &[u8]) -> Result<Vec<[u32; 3]>, ReadError> {
    Ok(off::read(off)?.faces)
}

/// Reads a scan. The format is `format` if given, else the one the bytes announce, else that of `name`'s extension, else what the bytes look like.
pub fn read(bytes: &[u8], name: Option<&str>, format: Option<Format>) -> Result<Shape, ReadError> {
    read_with(bytes, &ReadOptions { name, format, ..ReadOptions::default() })
}

/// The same, with what else a reader may be told: the pose of a body with a skeleton, and files beside this one.
pub fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<Shape, ReadError> {
    let &ReadOptions { name, format, .. } = options;
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    let bytes = &*encoding::in_utf8(bytes);
    let format = match format.or_else(|| Format::of_bytes(bytes)) {
        Some(format) => format,
        None => match foreign::known(bytes, name) {
            Some(refusal) => return Err(refusal),
            None => name
                .and_then(Format::of_name)
                .or_else(|| Format::like(bytes))
                .ok_or_else(|| foreign::like(bytes, name).unwrap_or_else(|| ReadError::unknown_format(bytes)))?,
        },
    };
    let Draft { points, faces, labels, repairs } = match format {
        Format::Off => off::read(bytes)?,
        Format::Ply => ply::read(bytes)?,
        Format::Obj => obj::read(bytes)?,
        Format::Stl => stl::read(bytes)?,
        Format::Glb | Format::Gltf => gltf::read(bytes, options)?,
        Format::Xyz => table::read(bytes, "XYZ")?,
        Format::Pts => table::read(bytes, "PTS")?,
        Format::Csv => table::read(bytes, "CSV")?,
    };
    let shape = Shape::with_repairs(points, faces, labels, repairs)?;
    // glTF 2.0, section 3.4: y is up.
    Ok(if matches!(format, Format::Glb | Format::Gltf) { shape.standing(Axis::Y) } else { shape })
}
