//! Wavefront OBJ, text: `v` lines are the points, `f` lines the faces, of all objects and groups together.
//!
//! An own reader rather than tobj: tobj re-indexes points per material and object, so that point `i` is no longer the `i`-th
//! `v` line, and its errors carry neither a line nor a number.

use std::borrow::Cow;

use super::draft::Draft;
use super::error::{Place, ReadError, quoted};
use super::polygons::Polygons;
use super::text::{Line, Lines, vertex, whole};

const OBJ: &str = "OBJ";

/// Reads positions and faces; texture coordinates, normals, lines, materials and groups are passed over.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut lines = Lines::without_comments(bytes);
    let mut points = Vec::new();
    let mut polygons = Polygons::new(OBJ, 1);
    let mut corners = Vec::new();
    while let Some(start) = lines.next() {
        let joined = join(start, &mut lines);
        let line = Line { number: start.number, bytes: &joined };
        let mut words = line.words();
        match words.next() {
            Some(b"v") => points.push(vertex(OBJ, line, words)?),
            Some(b"f") => {
                corners.clear();
                for word in words {
                    corners.push(corner(word, line, points.len(), polygons.seen())?);
                }
                polygons.push(&corners, Place::Line(line.number));
            }
            _ => {}
        }
    }
    if points.is_empty() {
        return Err(ReadError::MissingElement {
            format: OBJ, what: "vertex (a line that begins with “v”)".to_owned()
        });
    }
    let (faces, repairs) = polygons.finish(points.len())?;
    Ok(Draft { points, faces, labels: None, repairs })
}

/// A line with those it goes on in: a backslash at the end continues it.
fn join<'a>(line: Line<'a>, lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let mut joined = Cow::Borrowed(line.bytes);
    while let Some(kept) = joined.trim_ascii_end().strip_suffix(b"\\") {
        let length = kept.len();
        let joined = joined.to_mut();
        joined.truncate(length);
        let Some(next) = lines.any_line() else { break };
        joined.push(b' ');
        joined.extend_from_slice(next.bytes);
    }
    joined
}

/// 0-based point of `v`, `v/vt`, `v//vn` or `v/vt/vn`, where `v` counts from 1, or back from the last point when negative.
fn corner(word: &[u8], line: Line, points: usize, face: usize) -> Result<i64, ReadError> {
    let at = Place::Line(line.number);
    let vertex = word.split(|&b| b == b'/').next().unwrap_or_default();
    let Some(index) = whole(vertex) else {
        return Err(ReadError::BadNumber { format: OBJ, text: quoted(word), expected: "a whole number", at });
    };
    let corner = if index < 0 { points as i64 + index } else { index - 1 };
    if corner < 0 {
        return Err(ReadError::FaceIndex { format: OBJ, face, index, points, first: 1, at });
    }
    Ok(corner)
}
