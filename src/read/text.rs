//! Text files line by line: LF, CRLF or lone CR, with line numbers for people.

use super::error::{Place, ReadError, quoted};

/// The lines of a text file that hold anything.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    comments: bool,
}

/// One line, without its end.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    /// 1-based.
    pub number: usize,
    pub bytes: &'a [u8],
}

impl<'a> Lines<'a> {
    /// Every line that is not blank, from line `number` on.
    pub fn new(bytes: &'a [u8], number: usize) -> Self {
        Self { rest: bytes, number: number - 1, comments: true }
    }

    /// Lines with `#` and what follows it taken away.
    pub fn without_comments(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: 0, comments: false }
    }

    /// Bytes not yet read: what any promised count is bounded by.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Whether only blank lines are left. Not trimmed at the end: asked after every line, that would read what is left every time.
    pub fn at_end(&self) -> bool {
        self.rest.trim_ascii_start().is_empty()
    }

    /// 1-based number of the line last returned.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The next line, blank or not.
    pub fn any_line(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
        let (bytes, rest) = self.rest.split_at(end);
        let skip = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
        self.rest = &rest[skip..];
        self.number += 1;
        // C libraries of Windows write NaN as `1.#IND`.
        let begins_comment = |at: &usize| bytes[*at] == b'#' && (*at == 0 || bytes[at - 1] != b'.');
        let end = if self.comments { None } else { (0..bytes.len()).find(begins_comment) };
        let bytes = &bytes[..end.unwrap_or(bytes.len())];
        Some(Line { number: self.number, bytes })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.any_line()?;
            if line.words().next().is_some() {
                return Some(line);
            }
        }
    }
}

impl<'a> Line<'a> {
    /// What stands between white space.
    pub fn words(self) -> impl Iterator<Item = &'a [u8]> + Clone {
        self.bytes.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
    }
}

/// A decimal number. C libraries print NaN and infinity in several ways; all of them are numbers here, so that the complaint
/// names the bad point instead of a line of text.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let word = std::str::from_utf8(word).ok()?;
    word.parse().ok().or_else(|| {
        let lower = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
        let odd = ["nan(", "1.#qnan", "1.#snan", "1.#ind", "1.#inf"].iter().any(|c| lower.starts_with(c));
        odd.then_some(f64::NAN)
    })
}

/// A whole number in decimal.
pub(super) fn whole(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The three coordinates that `words` begin with; what follows them is for the caller.
pub(super) fn vertex<'a>(
    format: &'static str,
    line: Line,
    mut words: impl Iterator<Item = &'a [u8]>,
) -> Result<[f64; 3], ReadError> {
    let at = Place::Line(line.number);
    let mut point = [0.0; 3];
    for (found, coordinate) in point.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            let what = "a vertex".to_owned();
            return Err(ReadError::ShortLine { format, what, needed: 3, found: found as u64, at });
        };
        let Some(value) = number(word) else {
            return Err(ReadError::BadNumber { format, text: quoted(word), expected: "a number", at });
        };
        *coordinate = value;
    }
    Ok(point)
}
