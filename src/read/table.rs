//! Point clouds as tables of text (XYZ, PTS, CSV): a point per line, x, y and z in the first three columns or in those a header names.
//!
//! An own reader rather than the csv crate: most of these files are separated by blanks, and what stands before the first point
//! (counts, titles, comments) is told from it by looking at the words, which that crate leaves to its caller.

use super::draft::Draft;
use super::error::{Place, ReadError, quoted};
use super::text::{Line, Lines, number, whole};
use crate::shape::{Repair, counted};

/// Column names that a message repeats at most.
const NAMED: usize = 8;

/// Reads coordinates; further columns (colours, normals, intensities) are passed over and said so. `format` is the format's name
/// for people.
pub(super) fn read(bytes: &[u8], format: &'static str) -> Result<Draft, ReadError> {
    let mut lines = Lines::new(bytes, 1);
    let mut points = Vec::new();
    let mut repairs = Vec::new();
    let mut before = Preamble::default();
    let mut columns: Option<Columns> = None;
    while let Some(line) = lines.next() {
        let Some(line) = before.without_comment(line) else { continue };
        // A count stands before the points, and in a PTS of several scans before the points of each.
        let complete = before.promised.unwrap_or(0) == points.len() as u64;
        if let Some(count) = line_count(line).filter(|_| complete) {
            before.promised = Some(before.promised.unwrap_or(0).saturating_add(count));
            continue;
        }
        let columns = match &columns {
            Some(columns) => columns,
            None if before.title.is_none() && is_words(line) => {
                before.title = Some(line);
                continue;
            }
            None => columns.insert(Columns::of(line, &before, format, &mut repairs)?),
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
        let Some(line) = before.without_comment(line) else { continue };
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

/// What stands before the first point.
#[derive(Default)]
struct Preamble<'a> {
    /// Points announced so far.
    promised: Option<u64>,
    /// The last comment: it may name the columns.
    comment: Option<Line<'a>>,
    /// A line of words without a number: it names the columns, or is a title.
    title: Option<Line<'a>>,
}

impl<'a> Preamble<'a> {
    /// The line up to a `#`; `None` where nothing is left, or where it begins with `#`, `//` or `%`.
    fn without_comment(&mut self, line: Line<'a>) -> Option<Line<'a>> {
        let text = line.bytes.trim_ascii();
        if let Some(comment) = ["#", "//", "%"].iter().find_map(|mark| text.strip_prefix(mark.as_bytes())) {
            self.comment = Some(Line { bytes: comment, ..line });
            return None;
        }
        let end = text.iter().position(|&b| b == b'#').unwrap_or(text.len());
        Some(Line { bytes: &text[..end], ..line })
    }
}

/// What stands between two fields.
#[derive(Clone, Copy, PartialEq)]
enum Separator {
    /// Spaces and tabs, any number of them.
    Blank,
    /// One such byte, and any blanks around it.
    Byte(u8),
    /// Any of them, for headers.
    Any,
}

impl Separator {
    /// A comma separates only where no blank does: in `1,5 2,5` it marks decimals, which is refused further on.
    fn of(line: Line) -> Self {
        let blank_inside = |field: &[u8]| field.trim_ascii().iter().any(u8::is_ascii_whitespace);
        if line.bytes.contains(&b';') {
            Self::Byte(b';')
        } else if line.bytes.contains(&b',') && !line.bytes.split(|&b| b == b',').any(blank_inside) {
            Self::Byte(b',')
        } else {
            Self::Blank
        }
    }

    /// The fields of a line, without blanks and quotation marks around them.
    fn fields<'a>(self, line: Line<'a>) -> impl Iterator<Item = &'a [u8]> + Clone + use<'a> {
        let between = move |b: &u8| match self {
            Self::Blank => b.is_ascii_whitespace(),
            Self::Byte(byte) => *b == byte,
            Self::Any => b.is_ascii_whitespace() || matches!(b, b',' | b';'),
        };
        let kept = move |field: &&[u8]| !field.is_empty() || matches!(self, Self::Byte(_));
        line.bytes.split(between).filter(kept).map(|field| {
            let field = field.trim_ascii();
            field.strip_prefix(b"\"").and_then(|f| f.strip_suffix(b"\"")).unwrap_or(field)
        })
    }
}

/// Where the coordinates stand in a line.
struct Columns {
    separator: Separator,
    /// Columns of every line.
    count: usize,
    /// Those of x, y and z.
    axes: [usize; 3],
}

impl Columns {
    /// The columns of the first point, with the names that a header gives them.
    fn of(first: Line, before: &Preamble, format: &'static str, repairs: &mut Vec<Repair>) -> Result<Self, ReadError> {
        let separator = Separator::of(first);
        let count = separator.fields(first).count();
        let named =
            |line: Line| [separator, Separator::Any].into_iter().find_map(|s| axes_named(s, line).map(|a| (s, a)));
        let header = before.title.and_then(|title| Some((title, named(title)?)));
        // A comment may mention x, y and z in passing, so it must name every column.
        let comment =
            || before.comment.and_then(|c| Some((c, named(c)?)).filter(|(c, (s, _))| s.fields(*c).count() == count));
        let header = header.or_else(comment);
        let axes = header.map_or([0, 1, 2], |(_, (_, axes))| axes);
        if let Some((line, (by, _))) =
            header.filter(|(line, (by, _))| by.fields(*line).count() != count && axes != [0, 1, 2])
        {
            let problem = format!("the header names {} columns, the first point has {count}", by.fields(line).count());
            return Err(ReadError::Malformed { format, problem, at: Place::Line(line.number) });
        }
        let ignored = before.title.filter(|_| header.is_none());
        repairs.extend(ignored.map(|title| {
            let text = quoted(title.bytes);
            let message = format!(
                "line {} (“{text}”) names no x, y and z, so the first three columns are taken for them",
                title.number
            );
            Repair::noted("header-ignored", 1, message)
        }));
        let more = count.saturating_sub(3);
        repairs.extend(Repair::counted("columns-ignored", more, || {
            let others = header.map(|(line, (by, _))| {
                let others =
                    by.fields(line).enumerate().filter(|(k, _)| !axes.contains(k)).map(|(_, name)| quoted(name));
                format!(": {}", others.take(NAMED).collect::<Vec<_>>().join(", "))
            });
            let columns = counted(more, "column", "columns");
            format!("{columns} beside x, y and z not read{}", others.unwrap_or_default())
        }));
        Ok(Self { separator, count, axes })
    }

    fn point(&self, line: Line, format: &'static str) -> Result<[f64; 3], ReadError> {
        let at = Place::Line(line.number);
        let fields = self.separator.fields(line);
        let found = fields.clone().count();
        if found > self.count {
            let problem = format!("the line has {found} columns, and the first point has {}", self.count);
            return Err(ReadError::Malformed { format, problem, at });
        }
        let needed = self.count.max(3);
        if found < needed {
            let what = "a point".to_owned();
            return Err(ReadError::ShortLine { format, what, needed: needed as u64, found: found as u64, at });
        }
        let mut point = [0.0; 3];
        for (column, field) in fields.enumerate() {
            if let Some(axis) = self.axes.iter().position(|&axis| axis == column) {
                let bad = || ReadError::BadNumber { format, text: quoted(field), expected: "a number", at: at.clone() };
                point[axis] = number(field).ok_or_else(bad)?;
            }
        }
        Ok(point)
    }
}

/// The columns called x, y and z, in any case.
fn axes_named(separator: Separator, line: Line) -> Option<[usize; 3]> {
    let column = |name: &[u8]| separator.fields(line).position(|field| field.eq_ignore_ascii_case(name));
    Some([column(b"x")?, column(b"y")?, column(b"z")?])
}

/// The number of points, where a line holds one whole number and nothing else.
fn line_count(line: Line) -> Option<u64> {
    let mut words = line.words();
    let count = whole(words.next()?)?.try_into().ok()?;
    words.next().is_none().then_some(count)
}

/// Whether there is not a single number.
fn is_words(line: Line) -> bool {
    Separator::Any.fields(line).all(|field| number(field).is_none())
}
