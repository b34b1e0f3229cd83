//! A line of a table taken apart into fields.

use crate::read::text::{Line, number};

/// What stands between two fields.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Separator {
    /// Spaces and tabs, any number of them.
    Blank,
    /// One such byte, and any blanks around it.
    Byte(u8),
    /// Any of them, for headings.
    Any,
}

impl Separator {
    /// A comma separates only where no blank stands between numbers: in `1,5 2,5` it marks decimals.
    pub fn of(line: Line) -> Self {
        let between_numbers = |field: &[u8]| {
            let mut words = field.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
            let is_number = |word: &[u8]| number(word).is_some() || word.contains(&b',');
            words.clone().count() > 1 && words.all(is_number)
        };
        let separates = |byte: u8| !Self::Byte(byte).fields(line).any(between_numbers);
        let outside = |byte: u8| Self::Byte(byte).fields(line).count() - 1;
        if outside(b';') > 0 {
            Self::Byte(b';')
        } else if outside(b'|') > 1 {
            Self::Byte(b'|')
        } else if outside(b'\t') > 1 && separates(b'\t') {
            Self::Byte(b'\t')
        } else if outside(b',') > 0 && separates(b',') {
            Self::Byte(b',')
        } else {
            Self::Blank
        }
    }

    /// The fields of a line, without blanks and quotation marks around them. Within quotation marks nothing separates.
    pub fn fields<'a>(self, line: Line<'a>) -> Fields<'a> {
        Fields { rest: Some(line.bytes), separator: self }
    }

    fn is(self, byte: u8) -> bool {
        match self {
            Self::Blank => byte.is_ascii_whitespace(),
            Self::Byte(separator) => byte == separator,
            Self::Any => byte.is_ascii_whitespace() || matches!(byte, b',' | b';'),
        }
    }
}

/// See [`Separator::fields`].
#[derive(Clone)]
pub(super) struct Fields<'a> {
    rest: Option<&'a [u8]>,
    separator: Separator,
}

impl<'a> Iterator for Fields<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let single = matches!(self.separator, Separator::Byte(_));
        let is_separator = |b: &u8| self.separator.is(*b);
        let passed_over = |b: &u8| if single { b.is_ascii_whitespace() && !is_separator(b) } else { is_separator(b) };
        let rest = self.rest.take()?;
        let rest = &rest[rest.iter().position(|b| !passed_over(b)).unwrap_or(rest.len())..];
        if rest.is_empty() && !single {
            return None;
        }
        if let Some((field, after)) = rest.strip_prefix(b"\"").and_then(|quoted| closed(quoted, is_separator)) {
            self.rest = after;
            return Some(field.trim_ascii());
        }
        let end = rest.iter().position(is_separator);
        self.rest = end.map(|end| &rest[end + 1..]);
        Some(rest[..end.unwrap_or(rest.len())].trim_ascii())
    }
}

/// What stands before the quotation mark that ends a field, and what follows the separator behind it.
fn closed(quoted: &[u8], is_separator: impl Fn(&u8) -> bool) -> Option<(&[u8], Option<&[u8]>)> {
    let end = quoted.iter().position(|&b| b == b'"')?;
    let after = &quoted[end + 1..];
    let blanks = after.iter().position(|b| is_separator(b) || !b.is_ascii_whitespace()).unwrap_or(after.len());
    match after.get(blanks) {
        None => Some((&quoted[..end], None)),
        Some(b) if is_separator(b) => Some((&quoted[..end], Some(&after[blanks + 1..]))),
        Some(_) => None,
    }
}
