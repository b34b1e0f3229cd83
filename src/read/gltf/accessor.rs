//! Numbers out of accessors, after every range they span has been checked.

use gltf::accessor::{DataType, Dimensions, Item, Iter};
use gltf::{Accessor, Buffer, buffer};

use super::buffers::Buffers;
use super::container::GLTF;
use crate::read::error::{Place, ReadError};

/// Items of an accessor, one after the other.
pub(super) type Items<'a, T> = Box<dyn Iterator<Item = T> + 'a>;

/// The points of a POSITION accessor: floats, or integers as KHR_mesh_quantization allows them.
pub(super) fn positions<'a>(accessor: Accessor<'a>, buffers: &'a Buffers) -> Result<Items<'a, [f64; 3]>, ReadError> {
    if accessor.dimensions() != Dimensions::Vec3 {
        return Err(malformed(&accessor, "points need the type VEC3"));
    }
    let largest = largest(&accessor);
    let value = move |c: f64| largest.map_or(c, |largest| (c / largest).max(-1.0));
    Ok(match accessor.data_type() {
        DataType::F32 => Box::new(items::<[f32; 3]>(accessor, buffers)?.map(|p| p.map(f64::from))),
        DataType::I8 => Box::new(items::<[i8; 3]>(accessor, buffers)?.map(move |p| p.map(|c| value(c.into())))),
        DataType::U8 => Box::new(items::<[u8; 3]>(accessor, buffers)?.map(move |p| p.map(|c| value(c.into())))),
        DataType::I16 => Box::new(items::<[i16; 3]>(accessor, buffers)?.map(move |p| p.map(|c| value(c.into())))),
        DataType::U16 => Box::new(items::<[u16; 3]>(accessor, buffers)?.map(move |p| p.map(|c| value(c.into())))),
        DataType::U32 => return Err(malformed(&accessor, "points cannot be stored as 32-bit integers")),
    })
}

/// The corners an index accessor lists.
pub(super) fn indices<'a>(accessor: Accessor<'a>, buffers: &'a Buffers) -> Result<Items<'a, u32>, ReadError> {
    if accessor.dimensions() != Dimensions::Scalar {
        return Err(malformed(&accessor, "indices need the type SCALAR"));
    }
    Ok(match accessor.data_type() {
        DataType::U8 => Box::new(items::<u8>(accessor, buffers)?.map(u32::from)),
        DataType::U16 => Box::new(items::<u16>(accessor, buffers)?.map(u32::from)),
        DataType::U32 => Box::new(items::<u32>(accessor, buffers)?),
        _ => return Err(malformed(&accessor, "indices must be unsigned integers")),
    })
}

/// The joints that JOINTS_n names for each point.
pub(super) fn joints<'a>(accessor: Accessor<'a>, buffers: &'a Buffers) -> Result<Items<'a, [u16; 4]>, ReadError> {
    if accessor.dimensions() != Dimensions::Vec4 {
        return Err(malformed(&accessor, "joints need the type VEC4"));
    }
    Ok(match accessor.data_type() {
        DataType::U8 => Box::new(items::<[u8; 4]>(accessor, buffers)?.map(|j| j.map(u16::from))),
        DataType::U16 => Box::new(items::<[u16; 4]>(accessor, buffers)?),
        _ => return Err(malformed(&accessor, "joints must be unsigned integers of 8 or 16 bits")),
    })
}

/// The weights that WEIGHTS_n gives these joints.
pub(super) fn weights<'a>(accessor: Accessor<'a>, buffers: &'a Buffers) -> Result<Items<'a, [f64; 4]>, ReadError> {
    if accessor.dimensions() != Dimensions::Vec4 {
        return Err(malformed(&accessor, "weights need the type VEC4"));
    }
    let largest = largest(&accessor).unwrap_or(1.0);
    Ok(match accessor.data_type() {
        DataType::F32 => Box::new(items::<[f32; 4]>(accessor, buffers)?.map(|w| w.map(f64::from))),
        DataType::U8 => Box::new(items::<[u8; 4]>(accessor, buffers)?.map(move |w| w.map(|c| f64::from(c) / largest))),
        DataType::U16 => {
            Box::new(items::<[u16; 4]>(accessor, buffers)?.map(move |w| w.map(|c| f64::from(c) / largest)))
        }
        _ => return Err(malformed(&accessor, "weights must be floats or unsigned integers of 8 or 16 bits")),
    })
}

/// Matrices, by columns.
pub(super) fn matrices<'a>(
    accessor: Accessor<'a>,
    buffers: &'a Buffers,
) -> Result<impl Iterator<Item = [[f32; 4]; 4]> + use<'a>, ReadError> {
    if accessor.dimensions() != Dimensions::Mat4 || accessor.data_type() != DataType::F32 {
        return Err(malformed(&accessor, "inverse bind matrices need the type MAT4 of floats"));
    }
    items(accessor, buffers)
}

/// What the largest integer stands for 1 with, where integers are normalised.
fn largest(accessor: &Accessor) -> Option<f64> {
    match (accessor.normalized(), accessor.data_type()) {
        (true, DataType::I8) => Some(127.0),
        (true, DataType::U8) => Some(255.0),
        (true, DataType::I16) => Some(32767.0),
        (true, DataType::U16) => Some(65535.0),
        _ => None,
    }
}

/// The accessor's items, once it is certain that the crate's iterator stays inside the buffers.
fn items<'a, T: Item>(
    accessor: Accessor<'a>,
    buffers: &'a Buffers,
) -> Result<impl Iterator<Item = T> + use<'a, T>, ReadError> {
    let count = accessor.count();
    let size = size_of::<T>();
    if count > 0 {
        if let Some(view) = accessor.view() {
            check(&accessor, &view, accessor.offset(), size, count, buffers)?;
        }
        if let Some(sparse) = accessor.sparse() {
            if sparse.count() == 0 || sparse.count() > count {
                return Err(malformed(&accessor, "it replaces none or more than all of its items"));
            }
            let (indices, values) = (sparse.indices(), sparse.values());
            check(&accessor, &indices.view(), indices.offset(), indices.index_type().size(), sparse.count(), buffers)?;
            check(&accessor, &values.view(), values.offset(), size, sparse.count(), buffers)?;
        }
    }
    let data = |buffer: Buffer<'a>| buffers.get(&buffer).ok();
    let iter = match count {
        0 => None,
        _ => Some(Iter::new(accessor.clone(), data).ok_or_else(|| malformed(&accessor, "it has no data"))?),
    };
    Ok(iter.into_iter().flatten().take(count))
}

/// `count` items of `size` bytes from `offset` on lie inside the view, and the view inside its buffer.
fn check(
    accessor: &Accessor,
    view: &buffer::View,
    offset: usize,
    size: usize,
    count: usize,
    buffers: &Buffers,
) -> Result<(), ReadError> {
    let data = buffers.get(&view.buffer())?;
    if view.offset().checked_add(view.length()).is_none_or(|end| end > data.len()) {
        let problem = format!("it reaches beyond the {} bytes of buffer {}", data.len(), view.buffer().index());
        let at = Place::Object(format!("bufferViews[{}]", view.index()));
        return Err(ReadError::Malformed { format: GLTF, problem, at });
    }
    let stride = view.stride().unwrap_or(size);
    if stride < size {
        return Err(malformed(accessor, "its items overlap: the byte stride is smaller than an item"));
    }
    let room =
        view.length().checked_sub(offset).and_then(|left| left.checked_sub(size)).map_or(0, |left| left / stride + 1);
    if count > room {
        let (promised, found) = (count as u64, room as u64);
        let what = format!("items in accessor {}", accessor.index());
        let at = Place::Object(format!("bufferViews[{}]", view.index()));
        return Err(ReadError::Truncated { format: GLTF, what, promised, found, at });
    }
    Ok(())
}

pub(super) fn malformed(accessor: &Accessor, problem: &str) -> ReadError {
    let at = Place::Object(format!("accessors[{}]", accessor.index()));
    ReadError::Malformed { format: GLTF, problem: problem.to_owned(), at }
}
