//! Point clouds as tables of text (XYZ, PTS, CSV): a point per line, x, y and z in the columns that headings name, or else in the first
//! three that can be coordinates.
//!
//! An own reader rather than the csv crate: most of these files are separated by blanks, and what stands before the first point
//! (counts, titles, comments) is told from it by looking at the words, which that crate leaves to its caller.

mod cell;
mod columns;
mod heading;
mod preamble;
mod separator;

use super::draft::Draft;
use super::error::{Place, ReadError, quoted};
use super::text::{Line, Lines, number, whole};
use crate::shape::{Repair, counted};
use columns::Columns;
use preamble::{Preamble, is_words, line_count};
use separator::Separator;

/// Reads coordinates; further columns (colours, normals, intensities) are passed over and said so. `format` is the format's name
/// for people.
pub(super) fn read(bytes: &[u8], format: &'static str) -> Result<Draft, ReadError> {
    let mut lines = Lines::new(bytes, 1);
    let mut points = Vec::new();
    let mut repairs = Vec::new();
    let mut before = Preamble::default();
    let mut columns: Option<Columns> = None;
    while let Some(line) = lines.next() {
        let Some(line) = before.without_comment(line, points.len()) else { continue };
        // A count stands before the points, and in a PTS of several scans before the points of each.
        let complete = before.promised.unwrap_or(0) == points.len() as u64;
        if let Some(count) = line_count(line).filter(|_| complete) {
            before.promised = Some(before.promised.unwrap_or(0).saturating_add(count));
            continue;
        }
        let columns = match &columns {
            Some(columns) => columns,
            None if before.takes_title(line) => continue,
            None if numbers_columns(line, &lines) => {
                let message =
                    format!("line {} (“{}”) numbers the columns and is no point", line.number, quoted(line.bytes));
                repairs.push(Repair::noted("header-ignored", 1, message));
                continue;
            }
            None => columns.insert(Columns::of(line, &lines, &before, format, &mut repairs)?),
        };
        let last = lines.at_end();
        points.push(columns.point(line, format).map_err(|e| match e {
            ReadError::ShortLine { at, .. } if last && !points.is_empty() => {
                let what = counted(points.len(), "point", "points");
                ReadError::Unfinished {
                    format,
                    what,
                    missing: "the rest of its last line",
                    found: points.len() as u64,
                    at,
                }
            }
            e => e,
        })?);
    }
    let (found, promised) = (points.len() as u64, before.promised.unwrap_or(0));
    if found < promised {
        let at = Place::Line(lines.number());
        return Err(ReadError::Truncated { format, what: "points".to_owned(), promised, found, at });
    }
    if points.is_empty() {
        return Err(ReadError::MissingElement { format, what: "line with the coordinates of a point".to_owned() });
    }
    let more = if before.promised.is_some() { (found - promised) as usize } else { 0 };
    repairs.extend(Repair::counted("count-wrong", more, || {
        format!("this {format} announces {promised} points and has {found}; all of them are read")
    }));
    Ok(Draft { points, repairs, ..Draft::default() })
}

/// Whether text looks like such a table: every one of its first lines that holds numbers begins with three of them.
pub(super) fn looks_like_one(bytes: &[u8]) -> bool {
    const LINES: usize = 20;
    let mut before = Preamble::default();
    let mut rows = 0;
    for line in Lines::new(bytes, 1).take(LINES) {
        let Some(line) = before.without_comment(line, rows) else { continue };
        if rows == 0 && (line_count(line).is_some() || is_words(line)) {
            continue;
        }
        if Separator::of(line).fields(line).take(3).filter_map(number).count() < 3 {
            return false;
        }
        rows += 1;
    }
    rows > 0
}

/// Whether a line numbers the columns, as a table without names is written by pandas: `,0,1,2` before rows that begin with a number, or
/// `0,1,2` before rows in which every one of the first three has decimals.
fn numbers_columns(line: Line, following: &Lines) -> bool {
    let separator = Separator::of(line);
    let fields: Vec<&[u8]> = separator.fields(line).collect();
    let (nameless, numbers) = match fields.split_first() {
        Some((&[], rest)) => (true, rest),
        _ => (false, &fields[..]),
    };
    let counts = numbers.iter().enumerate().all(|(k, field)| whole(field) == Some(k as i64));
    if numbers.len() < 3 || !counts {
        return false;
    }
    let fits = |row: Line| {
        let row: Vec<&[u8]> = separator.fields(row).collect();
        let decimals = || row.iter().take(3).all(|field| number(field).is_some() && field.contains(&b'.'));
        row.len() == fields.len() && if nameless { !row[0].is_empty() } else { decimals() }
    };
    let mut rows = following.clone().take(8).peekable();
    rows.peek().is_some() && rows.all(fits)
}
