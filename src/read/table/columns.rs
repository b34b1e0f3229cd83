//! Which columns of a table are x, y and z: those that headings name, or else those that can be told by what stands in them.

use super::cell::{Decimal, around_comma, value};
use super::heading::{self, Naming};
use super::preamble::{Preamble, line_count, split_comment};
use super::separator::Separator;
use crate::read::encoding;
use crate::read::error::{Place, ReadError, quoted};
use crate::read::text::{Line, Lines, whole};
use crate::shape::{Repair, counted};

/// Column names that a message repeats at most.
const NAMED: usize = 8;
/// Rows looked at to learn what columns hold.
const LOOKED_AT: usize = 32;
/// Columns of whose every row something is asked at most.
const ASKED: usize = 64;

/// Where the coordinates stand in a line.
pub(super) struct Columns {
    separator: Separator,
    decimal: Decimal,
    /// Columns of every line.
    count: usize,
    /// Those of x, y and z.
    axes: [usize; 3],
}

/// A line of headings.
struct Headings<'a> {
    line: Line<'a>,
    names: Vec<String>,
    naming: Naming,
}

impl Columns {
    /// The columns of the first point and of those in `lines`, which follow it.
    pub fn of(
        first: Line,
        lines: &Lines,
        before: &Preamble,
        format: &'static str,
        repairs: &mut Vec<Repair>,
    ) -> Result<Self, ReadError> {
        let separator = Separator::of(first);
        let count = separator.fields(first).count();
        let mut rows = Rows { first, lines, separator, decimal: Decimal::Point, count, numbers: Vec::new() };
        rows.decimal = rows.mark_of_decimals();
        rows.numbers = rows.columns_of_numbers();
        if let Some((line, text)) = rows.split_decimal() {
            let at = Place::Line(line.number);
            return Err(ReadError::BadNumber { format, text, expected: "a number", at });
        }
        let headings = headings(before, separator, count);
        let mut counter = None;
        let axes = match &headings {
            Some(h) if h.naming == Naming::Several => return Err(ambiguous(h, format)),
            Some(h @ Headings { naming: Naming::Axes(axes), .. }) => {
                let shifted = rows.columns_after_headings(h, *axes);
                let Some(found) = shifted else {
                    let problem = format!("the header names {} columns, the first point has {count}", h.names.len());
                    return Err(ReadError::Malformed { format, problem, at: Place::Line(h.line.number) });
                };
                if found != *axes && found[0] == axes[0] + 1 {
                    counter = Some(0);
                }
                found
            }
            _ => {
                let (axes, skipped) = rows.columns_by_content();
                counter = skipped;
                if let Some(h) = &headings {
                    rows.check_unnamed(h, axes).map_err(|()| ambiguous(h, format))?;
                }
                axes
            }
        };
        let named = headings.as_ref().filter(|h| matches!(h.naming, Naming::Axes(_)));
        let ignored = before.titles.last().filter(|_| named.is_none());
        repairs.extend(ignored.map(|title| {
            let text = quoted(title.bytes);
            let taken = match axes {
                [0, 1, 2] => "the first three columns are taken for them".to_owned(),
                [x, y, z] => format!("columns {}, {} and {} are taken for them", x + 1, y + 1, z + 1),
            };
            Repair::noted(
                "header-ignored",
                1,
                format!("line {} (“{text}”) names no x, y and z, so {taken}", title.number),
            )
        }));
        repairs.extend(counter.map(|column| {
            Repair::noted(
                "row-numbers-ignored",
                1,
                format!("column {} numbers or names the rows and is no coordinate", column + 1),
            )
        }));
        let more = count.saturating_sub(3 + usize::from(counter.is_some()));
        repairs.extend(Repair::counted("columns-ignored", more, || {
            let others = headings.as_ref().filter(|h| h.names.len() == count).map(|h| {
                let others = h
                    .names
                    .iter()
                    .enumerate()
                    .filter(|(k, _)| !axes.contains(k))
                    .map(|(_, name)| quoted(name.as_bytes()));
                format!(": {}", others.take(NAMED).collect::<Vec<_>>().join(", "))
            });
            let columns = counted(more, "column", "columns");
            format!("{columns} beside x, y and z not read{}", others.unwrap_or_default())
        }));
        Ok(Self { separator, decimal: rows.decimal, count, axes })
    }

    /// The coordinates in a line.
    pub fn point(&self, line: Line, format: &'static str) -> Result<[f64; 3], ReadError> {
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
                point[axis] = value(field, self.decimal).ok_or_else(bad)?;
            }
        }
        Ok(point)
    }
}

/// The headings before the points: a title or comment that names x, y and z, or else a title of as many words as there are columns. A
/// comment may mention x, y and z in passing, so it must name every column.
fn headings<'a>(before: &Preamble<'a>, separator: Separator, count: usize) -> Option<Headings<'a>> {
    let read = |line: Line<'a>, by: Separator| {
        let names: Vec<String> = by.fields(line).map(encoding::name).collect();
        let naming = heading::axes(&names);
        Headings { line, names, naming }
    };
    let both = |line: Line<'a>| [separator, Separator::Any].into_iter().map(move |by| read(line, by));
    let tells = |h: &Headings| h.naming != Naming::None;
    let titles = || before.titles.iter().rev().flat_map(|line| both(*line));
    let comments = before.comments.iter().rev().flat_map(|line| both(after_colon(*line)));
    titles()
        .find(|h| tells(h) && h.names.len() == count)
        .or_else(|| titles().find(tells))
        .or_else(|| comments.filter(|h| h.names.len() == count).find(tells))
        .or_else(|| {
            let listed = matches!(separator, Separator::Byte(_));
            before.titles.iter().rev().map(|line| read(*line, separator)).find(|h| listed && h.names.len() == count)
        })
}

/// What follows `columns =` or `fields:` in a comment.
fn after_colon(line: Line) -> Line {
    let at = line.bytes.iter().position(|b| b"=:".contains(b)).map_or(0, |at| at + 1);
    let word = line.bytes[..at].to_ascii_lowercase();
    let introduces =
        [&b"columns"[..], b"fields", b"format", b"header"].iter().any(|w| word.windows(w.len()).any(|part| part == *w));
    Line { bytes: &line.bytes[if introduces { at } else { 0 }..], ..line }
}

fn ambiguous(headings: &Headings, format: &'static str) -> ReadError {
    let names = headings.names.iter().take(NAMED).map(|name| quoted(name.as_bytes())).collect();
    ReadError::AmbiguousColumns { format, headings: names, at: Place::Line(headings.line.number) }
}

/// The rows of a table, to learn from.
struct Rows<'r, 'a> {
    first: Line<'a>,
    lines: &'r Lines<'a>,
    separator: Separator,
    decimal: Decimal,
    count: usize,
    /// Whether most of the first rows have a number in each column.
    numbers: Vec<bool>,
}

impl<'a> Rows<'_, 'a> {
    fn all(&self) -> impl Iterator<Item = Line<'a>> {
        let others = self.lines.clone().filter_map(|line| split_comment(line).0).filter(|l| line_count(*l).is_none());
        std::iter::once(self.first).chain(others)
    }

    /// The fields of the first rows that have as many as the very first.
    fn sample(&self) -> Vec<Vec<&'a [u8]>> {
        let rows = self.all().take(LOOKED_AT).map(|line| self.separator.fields(line).collect::<Vec<_>>());
        rows.filter(|row| row.len() == self.count).collect()
    }

    /// Commas mark decimals where they stand between digits, at least once so that they cannot mark thousands, and no point does.
    fn mark_of_decimals(&self) -> Decimal {
        let pointed = |line: Line| line.bytes.windows(2).any(|w| w[0] == b'.' && w[1].is_ascii_digit());
        if self.all().take(LOOKED_AT).any(pointed) {
            return Decimal::Point;
        }
        let rows = self.sample();
        let certain = rows.iter().flatten().filter_map(|field| around_comma(field)).any(|certain| certain);
        if certain { Decimal::Comma } else { Decimal::Point }
    }

    /// The first number that commas between fields have cut in two, if they do: no point in any row, only whole numbers, and in two columns
    /// or more some that no whole number is, such as `003416` and `-0`.
    fn split_decimal(&self) -> Option<(Line<'a>, String)> {
        let is_whole = |field: &[u8]| whole(field).is_some();
        if self.separator != Separator::Byte(b',') || self.count < 4 {
            return None;
        }
        let rows = self.sample();
        if !rows.iter().all(|row| row.iter().all(|field| is_whole(field) || value(field, Decimal::Point).is_none())) {
            return None;
        }
        let digits = |field: &[u8]| !field.is_empty() && field.iter().all(u8::is_ascii_digit);
        let cut = |field: &[u8]| digits(field) && field.len() > 1 && field[0] == b'0' || field == b"-0";
        let columns = (0..self.count).filter(|&k| rows.iter().any(|row| cut(row[k]))).count();
        if columns < 2 {
            return None;
        }
        let pair = |row: &Vec<&[u8]>| {
            let pairs = row.windows(2).find(|pair| is_whole(pair[0]) && digits(pair[1]))?;
            Some(quoted(&[pairs[0], b",", pairs[1]].concat()))
        };
        rows.first().and_then(pair).map(|text| (self.first, text))
    }

    /// Where the columns that headings name stand in the rows, if it is clear. Some programs leave out the heading of row numbers, and some
    /// headings are of more words than columns.
    fn columns_after_headings(&self, headings: &Headings, axes: [usize; 3]) -> Option<[usize; 3]> {
        let named = headings.names.len();
        let in_order = axes[0] < axes[1] && axes[1] < axes[2];
        match self.count {
            count if count == named => Some(axes),
            count if count == named + 1 && (self.numbers_rows(0) || !self.numbers[0]) => Some(axes.map(|k| k + 1)),
            count if count > named && axes == [0, 1, 2] => Some(axes),
            3 if in_order && named > 3 => Some([0, 1, 2]),
            _ => None,
        }
    }

    /// The first three of columns of numbers that stand together, without row numbers before them; and the column of these.
    fn columns_by_content(&self) -> ([usize; 3], Option<usize>) {
        let start = self.numbers.windows(3).position(|three| three.iter().all(|&n| n)).unwrap_or(0);
        let fourth = self.numbers.get(start + 3) == Some(&true);
        let fifth = self.numbers.get(start + 4) == Some(&true);
        let counter = fourth && (self.numbers_rows(start) || !fifth && self.is_constant(start));
        let from = start + usize::from(counter);
        ([from, from + 1, from + 2], counter.then_some(start))
    }

    /// Whether columns may be coordinates under headings that name none: they are all the numbers there are, and none is called otherwise.
    fn check_unnamed(&self, headings: &Headings, axes: [usize; 3]) -> Result<(), ()> {
        let mut others = (0..self.count).filter(|k| self.numbers[*k] && !axes.contains(k));
        let unclear = self.count > ASKED || others.any(|k| !self.counts(k) && !self.is_constant(k));
        let other = axes.iter().any(|&k| headings.names.get(k).is_some_and(|name| heading::is_other(name)));
        if unclear || other { Err(()) } else { Ok(()) }
    }

    fn columns_of_numbers(&self) -> Vec<bool> {
        let rows = self.sample();
        let holds = |column: usize| {
            let numbers = rows.iter().filter(|row| value(row[column], self.decimal).is_some()).count();
            2 * numbers > rows.len() && !rows.iter().all(|row| row[column].is_empty())
        };
        (0..self.count).map(holds).collect()
    }

    /// Whether a column numbers the rows: it counts them, or it has whole numbers only, in any order and with gaps, and none of the next three has. Some programs
    /// write all columns alike, with as many decimals as the coordinates have.
    fn numbers_rows(&self, column: usize) -> bool {
        let finite = |field: &[u8]| value(field, self.decimal).filter(|value| value.is_finite());
        let by_text = |field: &[u8]| finite(field).map(|_| whole(field).is_some());
        let by_value = |field: &[u8]| finite(field).map(|value| value.fract() == 0.0);
        self.counts(column) || self.alone_is_whole(column, by_text) || self.alone_is_whole(column, by_value)
    }

    /// Whether every number of a column is whole, and not every one in any of the next three; `is_whole` is nothing for what is no number.
    fn alone_is_whole(&self, column: usize, is_whole: impl Fn(&[u8]) -> Option<bool>) -> bool {
        let fields = |column| self.all().map(move |line| self.separator.fields(line).nth(column));
        let told = |field: Option<&[u8]>| field.and_then(&is_whole);
        let has_decimals = |column| fields(column).any(|field| told(field) == Some(false));
        fields(column).all(|field| told(field) == Some(true)) && (1..=3).all(|next| has_decimals(column + next))
    }

    /// Whether a column counts the rows, from 0, from 1 or from anywhere.
    fn counts(&self, column: usize) -> bool {
        let mut values = self.all().map(|line| self.separator.fields(line).nth(column).and_then(whole));
        let Some(first) = values.next().flatten() else { return false };
        let mut rows = 1;
        let counts = values.all(|value| {
            rows += 1;
            value == first.checked_add(rows - 1)
        });
        counts && rows > 2
    }

    /// Whether a column is the same in every row, as a frame's number is.
    fn is_constant(&self, column: usize) -> bool {
        let mut values = self.all().map(|line| self.separator.fields(line).nth(column));
        let first = values.next();
        values.all(|value| Some(value) == first)
    }
}
