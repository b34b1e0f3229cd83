//! Binary STL: 80 bytes of comment, the count of triangles, and 50 bytes for each.

use crate::read::draft::Draft;
use crate::read::error::{Place, ReadError};
use crate::shape::{Repair, counted};

/// The format in errors.
pub(super) const STL: &str = "STL";

/// Bytes of the header: 80 of comment, then the count of triangles.
const HEADER: usize = 84;
/// Bytes of a triangle: a normal, three points, two bytes of attributes.
const TRIANGLE: usize = 50;

/// Counts that say nothing: 0, and −1 as programs write it who do not know the number when they begin.
const PLACEHOLDERS: [usize; 3] = [0, u32::MAX as usize, i32::MAX as usize];

/// How many times larger than the largest coordinate before it a coordinate behind the count may be: what follows there may be no triangles.
const FARTHER: f64 = 10.0;

pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let truncated = |what: &str, promised: usize, found: usize| ReadError::Truncated {
        format: STL,
        what: what.to_owned(),
        promised: promised as u64,
        found: found as u64,
        at: Place::Byte(bytes.len()),
    };
    let count = count(bytes).ok_or_else(|| truncated("header bytes", HEADER, bytes.len()))?;
    let (triangles, rest) = bytes[HEADER..].as_chunks::<TRIANGLE>();
    let there = triangles.len();
    if count == 0 && there == 0 {
        return Err(ReadError::MissingElement { format: STL, what: "triangle: its count is 0".to_owned() });
    }
    let whole = rest.is_empty();
    let uncounted = PLACEHOLDERS.contains(&count) && there > 0;
    if uncounted && !whole {
        let what = counted(there, "triangle", "triangles");
        let at = Place::Byte(bytes.len());
        return Err(ReadError::Unfinished {
            format: STL,
            what,
            missing: "the rest of the next",
            found: there as u64,
            at,
        });
    }
    if there < count && !uncounted {
        return Err(truncated("triangles", count, there));
    }
    let more = there > count && whole && (uncounted || go_on(&triangles[..count], &triangles[count..]));
    let read = if more { there } else { count.min(there) };

    let mut draft = Draft::default();
    draft.points.reserve_exact(3 * read);
    for triangle in &triangles[..read] {
        draft.points.extend_from_slice(corners(triangle).as_chunks::<3>().0);
    }
    draft.faces = (0..read as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    draft.repairs.extend(Repair::counted("count-wrong", read.abs_diff(count), || {
        let announced = if count == u32::MAX as usize { "−1".to_owned() } else { count.to_string() };
        format!("this STL announces {announced} triangles and has {read}; all of them are read")
    }));
    let left = (there - read) * TRIANGLE + rest.len();
    draft.repairs.extend(Repair::counted("trailing-data", left, || {
        format!("{} after the last triangle this STL announces not read", counted(left, "byte", "bytes"))
    }));
    Ok(draft)
}

/// Whether the length is that of the triangles announced.
pub(super) fn fits_its_count(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| count > 0 && (bytes.len() - HEADER) as u64 == count as u64 * TRIANGLE as u64)
}

/// Whether nothing but whole triangles with finite corners follows a count that says nothing.
pub(super) fn is_uncounted(bytes: &[u8]) -> bool {
    if !count(bytes).is_some_and(|count| PLACEHOLDERS.contains(&count)) {
        return false;
    }
    let (triangles, rest) = bytes[HEADER..].as_chunks::<TRIANGLE>();
    !triangles.is_empty() && rest.is_empty() && go_on(&[], triangles)
}

fn count(bytes: &[u8]) -> Option<usize> {
    bytes.get(80..HEADER)?.first_chunk().map(|word| u32::from_le_bytes(*word) as usize)
}

/// The coordinates of three points.
fn corners(triangle: &[u8; TRIANGLE]) -> [f64; 9] {
    std::array::from_fn(|k| {
        let at = 12 + 4 * k; // behind the normal
        f64::from(f32::from_le_bytes([triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]]))
    })
}

/// Whether `more` can be triangles of the same body: its coordinates are finite, and not far beyond those `before`.
fn go_on(before: &[[u8; TRIANGLE]], more: &[[u8; TRIANGLE]]) -> bool {
    let largest = before.iter().flat_map(corners).map(f64::abs).fold(0.0, f64::max);
    let limit = if before.is_empty() { f64::from(f32::MAX) } else { FARTHER * largest };
    more.iter().flat_map(corners).all(|c| c.abs() <= limit)
}
