//! Object File Format, text: a keyword, three counts, a vertex per line, a face per line.
//!
//! An own reader, because no well-kept crate reads OFF; the format is one page of Geomview's manual.

use super::draft::Draft;
use super::error::{Place, ReadError, quoted};
use super::polygons::Polygons;
use super::text::{Line, Lines, number, whole};
use crate::shape::{Repair, counted};

const OFF: &str = "OFF";

/// Bytes of the shortest vertex line, `0 0 0`, with its end.
const SHORTEST_VERTEX: usize = 6;

/// Reads positions and faces; colours, normals and texture coordinates behind them are passed over.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut lines = Lines::without_comments(bytes);
    let [vertices, faces] = header(&mut lines)?;

    let mut points = Vec::with_capacity((lines.rest().len() / SHORTEST_VERTEX + 1).min(vertices as usize));
    let mut polygons = Polygons::new(OFF, 0);
    for found in 0..vertices {
        let line = lines.next().ok_or_else(|| truncated("vertices", vertices, found, &lines))?;
        points.push(vertex(line).map_err(|e| cut_off(e, "vertices", vertices, found, &lines))?);
    }
    let mut corners = Vec::new();
    for found in 0..faces {
        let line = lines.next().ok_or_else(|| truncated("faces", faces, found, &lines))?;
        face(line, &mut corners).map_err(|e| cut_off(e, "faces", faces, found, &lines))?;
        polygons.push(&corners, Place::Line(line.number));
    }
    let left = lines.count();

    let (faces, mut repairs) = polygons.finish(points.len())?;
    repairs.extend(Repair::counted("trailing-data", left, || {
        format!("{} after the last face this OFF announces not read", counted(left, "line", "lines"))
    }));
    Ok(Draft { points, faces, labels: None, repairs })
}

/// The keyword (optional, as in Geomview) and the counts of vertices and faces, on the same line or the next.
fn header(lines: &mut Lines) -> Result<[u64; 2], ReadError> {
    let missing =
        || ReadError::MissingElement { format: OFF, what: "line with the counts of vertices and faces".to_owned() };
    let mut line = lines.next().ok_or_else(missing)?;
    if let Some(end) = line.bytes.windows(3).position(|w| w == b"OFF").map(|at| at + 3) {
        let (keyword, rest) = line.bytes.split_at(end);
        if keyword.iter().any(|b| b"4n".contains(b)) {
            let feature = "an OFF with points of other than three coordinates".to_owned();
            return Err(ReadError::Unsupported { feature, cure: "save it as plain OFF" });
        }
        if rest.trim_ascii().starts_with(b"BINARY") {
            return Err(ReadError::Unsupported {
                feature: "binary OFF".to_owned(),
                cure: "save it as text OFF or as PLY",
            });
        }
        line = Line { bytes: rest, ..line };
        if line.words().next().is_none() {
            line = lines.next().ok_or_else(missing)?;
        }
    } else if line.words().next().and_then(number).is_none() {
        let problem = format!("the file begins with “{}” where OFF must stand", quoted(line.bytes));
        return Err(ReadError::Malformed { format: OFF, problem, at: Place::Line(line.number) });
    }
    let at = || Place::Line(line.number);
    let mut counts = [0; 2];
    let mut words = line.words();
    for (found, count) in counts.iter_mut().enumerate() {
        let short = || ReadError::ShortLine {
            format: OFF,
            what: "the line with the counts of vertices and faces".to_owned(),
            needed: 2,
            found: found as u64,
            at: at(),
        };
        let word = words.next().ok_or_else(short)?;
        *count = whole(word).and_then(|c| u64::try_from(c).ok()).ok_or_else(|| bad_number(word, "a count", line))?;
    }
    Ok(counts)
}

fn vertex(line: Line) -> Result<[f64; 3], ReadError> {
    let mut point = [0.0; 3];
    let mut words = line.words();
    for (found, coordinate) in point.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| short_line("a vertex", 3, found as u64, line))?;
        *coordinate = number(word).ok_or_else(|| bad_number(word, "a number", line))?;
    }
    Ok(point)
}

/// `n i₁ … iₙ` and perhaps a colour, which is passed over.
fn face(line: Line, corners: &mut Vec<i64>) -> Result<(), ReadError> {
    corners.clear();
    let mut words = line.words();
    let Some(word) = words.next() else { return Ok(()) };
    let count = whole(word).and_then(|c| u64::try_from(c).ok()).ok_or_else(|| bad_number(word, "a count", line))?;
    for found in 0..count {
        let word = words.next().ok_or_else(|| short_line("a face", count + 1, found + 1, line))?;
        corners.push(whole(word).ok_or_else(|| bad_number(word, "a whole number", line))?);
    }
    Ok(())
}

fn truncated(what: &str, promised: u64, found: u64, lines: &Lines) -> ReadError {
    ReadError::Truncated { format: OFF, what: what.to_owned(), promised, found, at: Place::Line(lines.number()) }
}

/// A short line at the very end of the file is the file's end, not a mistake in the line.
fn cut_off(error: ReadError, what: &str, promised: u64, found: u64, lines: &Lines) -> ReadError {
    match error {
        ReadError::ShortLine { .. } if lines.rest().is_empty() => truncated(what, promised, found, lines),
        other => other,
    }
}

fn short_line(what: &str, needed: u64, found: u64, line: Line) -> ReadError {
    ReadError::ShortLine { format: OFF, what: what.to_owned(), needed, found, at: Place::Line(line.number) }
}

fn bad_number(word: &[u8], expected: &'static str, line: Line) -> ReadError {
    ReadError::BadNumber { format: OFF, text: quoted(word), expected, at: Place::Line(line.number) }
}
