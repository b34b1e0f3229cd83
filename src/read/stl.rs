//! STL, text or binary: loose triangles, three points each, in the order of the file.
//!
//! An own reader rather than stl_io: that one takes whatever begins with “solid ” for text, rounds the coordinates of text to f32, and
//! its errors carry neither a place nor the numbers of triangles promised and found.

use super::draft::Draft;
use super::error::{Place, ReadError, quoted};
use super::polygons::Polygons;
use super::text::{Lines, vertex};
use crate::shape::{Repair, counted};

const STL: &str = "STL";

/// Bytes of a binary header: 80 of comment, then the count of triangles.
const HEADER: usize = 84;
/// Bytes of a binary triangle: a normal, three points, two bytes of attributes.
const TRIANGLE: usize = 50;

/// Reads positions; normals, attributes and names are passed over. Corners that lie in one place stay separate points here.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    if is_text(bytes) { read_text(bytes) } else { read_binary(bytes) }
}

/// Whether the bytes announce an STL: by a length that fits the count of a binary one, or by the word a text one begins with.
pub(super) fn announced_by(bytes: &[u8]) -> bool {
    fits_its_count(bytes) || begins_with_solid(bytes)
}

/// Binary files may begin with “solid” too. They are told from text by their length, and where that is wrong by the zero bytes of
/// their count, which is below 2²⁴.
fn is_text(bytes: &[u8]) -> bool {
    begins_with_solid(bytes) && !fits_its_count(bytes) && !bytes[..bytes.len().min(HEADER)].contains(&0)
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let word = bytes.trim_ascii_start();
    word.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid")) && word.get(5).is_none_or(u8::is_ascii_whitespace)
}

/// The count of a binary header.
fn count(bytes: &[u8]) -> Option<usize> {
    bytes.get(80..HEADER)?.first_chunk().map(|word| u32::from_le_bytes(*word) as usize)
}

fn fits_its_count(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| count > 0 && (bytes.len() - HEADER) as u64 == count as u64 * TRIANGLE as u64)
}

fn read_binary(bytes: &[u8]) -> Result<Draft, ReadError> {
    let truncated = |what: &str, promised: usize, found: usize| ReadError::Truncated {
        format: STL,
        what: what.to_owned(),
        promised: promised as u64,
        found: found as u64,
        at: Place::Byte(bytes.len()),
    };
    let count = count(bytes).ok_or_else(|| truncated("header bytes", HEADER, bytes.len()))?;
    let (triangles, rest) = bytes[HEADER..].as_chunks::<TRIANGLE>();
    if triangles.len() < count {
        return Err(truncated("triangles", count, triangles.len()));
    }
    let left = ((triangles.len() - count) * TRIANGLE) + rest.len();
    let mut draft = Draft::default();
    draft.points.reserve_exact(3 * count);
    for triangle in &triangles[..count] {
        let numbers: [f64; 9] = std::array::from_fn(|k| {
            let at = 12 + 4 * k; // behind the normal
            f64::from(f32::from_le_bytes([triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]]))
        });
        draft.points.extend_from_slice(numbers.as_chunks::<3>().0);
    }
    if count == 0 {
        return Err(ReadError::MissingElement { format: STL, what: "triangle: its count is 0".to_owned() });
    }
    draft.faces = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    draft.repairs.extend(Repair::counted("trailing-data", left, || {
        format!("{} after the last triangle this STL announces not read", counted(left, "byte", "bytes"))
    }));
    Ok(draft)
}

/// `solid`, `facet normal`, `outer loop`, `vertex`, `endloop`, `endfacet`, `endsolid`, a line each and in any case. Several solids are
/// joined.
fn read_text(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut lines = Lines::without_comments(bytes);
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut polygons = Polygons::new(STL, 0);
    let mut corners: Vec<i64> = Vec::new();
    let mut open = true;
    while let Some(line) = lines.next() {
        let mut words = line.words();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        let between = match keyword.as_slice() {
            b"vertex" => {
                corners.push(points.len() as i64);
                let last = lines.at_end();
                points.push(vertex(STL, line, words).map_err(|e| match e {
                    ReadError::ShortLine { .. } if last => unfinished(&polygons, lines.number()),
                    e => e,
                })?);
                continue;
            }
            b"endloop" => {
                polygons.push(&corners, Place::Line(line.number));
                corners.clear();
                continue;
            }
            b"solid" | b"facet" => {
                open = true;
                true
            }
            b"endsolid" => {
                open = false;
                true
            }
            b"outer" | b"endfacet" => true,
            _ => false,
        };
        if !between && lines.at_end() {
            return Err(unfinished(&polygons, line.number));
        }
        if !between || !corners.is_empty() {
            let text = quoted(line.bytes.trim_ascii());
            let problem = match between {
                true => format!("“{text}” stands where vertex or endloop must"),
                false => format!("“{text}” is not a line a text STL can have"),
            };
            return Err(ReadError::Malformed { format: STL, problem, at: Place::Line(line.number) });
        }
    }
    if open {
        return Err(unfinished(&polygons, lines.number()));
    }
    if points.is_empty() {
        return Err(ReadError::MissingElement { format: STL, what: "facet with vertices".to_owned() });
    }
    let (faces, repairs) = polygons.finish(points.len())?;
    Ok(Draft { points, faces, labels: None, repairs })
}

/// A text STL has no counts; that it is whole shows in its last word.
fn unfinished(polygons: &Polygons, line: usize) -> ReadError {
    let what = counted(polygons.seen(), "facet", "facets");
    ReadError::Unfinished {
        format: STL,
        what,
        missing: "endsolid",
        found: polygons.seen() as u64,
        at: Place::Line(line),
    }
}
