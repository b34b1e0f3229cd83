//! What stands before the first point of a table: counts, comments, titles and headings.

use super::cell;
use super::separator::Separator;
use crate::read::text::{Line, number, whole};

/// Comments and titles kept: the headings are among the last.
const KEPT: usize = 50;

#[derive(Default)]
pub(super) struct Preamble<'a> {
    /// Points announced so far.
    pub promised: Option<u64>,
    /// Comments: one of them may name the columns.
    pub comments: Vec<Line<'a>>,
    /// Lines of words without a number: headings, or a title.
    pub titles: Vec<Line<'a>>,
}

impl<'a> Preamble<'a> {
    /// The line up to a comment; `None` where nothing is left. Comments are kept while there is no point.
    pub fn without_comment(&mut self, line: Line<'a>, points: usize) -> Option<Line<'a>> {
        let (text, comment) = split_comment(line);
        if text.is_some() {
            return text;
        }
        if points == 0 && self.comments.len() < KEPT {
            self.comments.extend(comment);
        }
        None
    }

    /// Takes a line of words in which there is room for one.
    pub fn takes_title(&mut self, line: Line<'a>) -> bool {
        let takes = self.titles.len() < KEPT && is_words(line);
        if takes {
            self.titles.push(line);
        }
        takes
    }
}

/// What a line says, if anything, and the comment in it. A comment begins with `#` behind a blank, or with `#`, `//` or `%` as the whole line.
pub(super) fn split_comment(line: Line) -> (Option<Line>, Option<Line>) {
    let text = line.bytes;
    let start = text.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(text.len());
    let begun = &text[start..];
    let mark = ["#", "//", "%"].iter().find(|mark| begun.starts_with(mark.as_bytes()));
    if let Some(mark) = mark.filter(|_| !cell::begins_missing(begun)) {
        return (None, Some(Line { bytes: &begun[mark.len()..], ..line }));
    }
    let begins = |at: usize| {
        text[at] == b'#' && text[..at].last().is_some_and(u8::is_ascii_whitespace) && !cell::begins_missing(&text[at..])
    };
    let end = (0..text.len()).find(|&at| begins(at)).unwrap_or(text.len());
    (Some(Line { bytes: &text[..end], ..line }), None)
}

/// The number of points, where a line holds one whole number and nothing else.
pub(super) fn line_count(line: Line) -> Option<u64> {
    let mut words = line.words();
    let count = whole(words.next()?)?.try_into().ok()?;
    words.next().is_none().then_some(count)
}

/// Whether there is not a single number, and something else.
pub(super) fn is_words(line: Line) -> bool {
    let mut fields = Separator::Any.fields(line);
    fields.clone().all(|field| number(field).is_none() && cell::around_comma(field).is_none())
        && fields.any(|field| !cell::is_missing(field))
}
