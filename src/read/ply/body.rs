//! The values of a PLY, one at a time: from lines of text or from bytes of either order. Every value becomes an f64, which
//! holds all kinds exactly, but whole numbers beyond 2⁵³.

use half::f16;

use super::header::{Element, Kind, Order, PLY, Scalar};
use crate::read::error::{Place, ReadError, quoted};
use crate::read::text::{Line, Lines, number};

/// What follows the header.
pub(super) enum Body<'a> {
    Text { lines: Lines<'a>, line: Line<'a>, rest: &'a [u8], taken: u64 },
    Binary { bytes: &'a [u8], at: usize, big: bool },
}

/// Why a value could not be had.
pub(super) enum Fault {
    /// The file, or the line, is over.
    Over,
    /// Something else stands where a number must.
    NotANumber { text: String, expected: &'static str },
}

impl<'a> Body<'a> {
    /// The body of `bytes` from `start` on; `lines` has just read the header.
    pub fn new(bytes: &'a [u8], start: usize, order: Order, lines: Lines<'a>) -> Self {
        match order {
            Order::Text => Body::Text { line: Line { number: lines.number(), bytes: b"" }, lines, rest: b"", taken: 0 },
            _ => Body::Binary { bytes, at: start, big: order == Order::Big },
        }
    }

    /// Records of `element` that the remaining bytes can hold, at most its count: what may be allocated.
    pub fn room_for(&self, element: &Element) -> usize {
        let (left, record) = match self {
            // The shortest value is a digit and what separates it from the next.
            Body::Text { lines, .. } => (lines.rest().len() + 1, 2 * element.properties.len()),
            Body::Binary { bytes, at, .. } => (bytes.len() - at, element.properties.iter().map(shortest).sum()),
        };
        usize::try_from(element.count).unwrap_or(usize::MAX).min(left / record.max(1))
    }

    /// Goes to the next record.
    pub fn begin(&mut self) -> Result<Place, Fault> {
        match self {
            Body::Text { lines, line, rest, taken } => {
                *line = lines.next().ok_or(Fault::Over)?;
                *rest = line.bytes;
                *taken = 0;
                Ok(Place::Line(line.number))
            }
            Body::Binary { at, .. } => Ok(Place::Byte(*at)),
        }
    }

    /// One value.
    pub fn scalar(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        match self {
            Body::Text { .. } => {
                let word = self.word()?;
                let value = number(word).or_else(|| if scalar == Scalar::Bool { truth(word) } else { None });
                value.ok_or_else(|| Fault::NotANumber { text: quoted(word), expected: "a number" })
            }
            Body::Binary { bytes, at, big } => {
                let size = scalar.bytes();
                let raw = bytes.get(*at..).and_then(|b| b.get(..size)).ok_or(Fault::Over)?;
                *at += size;
                let mut word = [0; 8];
                word[..size].copy_from_slice(raw);
                if *big {
                    word[..size].reverse();
                }
                Ok(decode(word, scalar))
            }
        }
    }

    /// The length of a list.
    pub fn count(&mut self, scalar: Scalar) -> Result<u64, Fault> {
        let value = self.scalar(scalar)?;
        if value < 0.0 || value.fract() != 0.0 || value > f64::from(u32::MAX) {
            return Err(Fault::NotANumber { text: value.to_string(), expected: "a count" });
        }
        Ok(value as u64)
    }

    /// `length` whole numbers, into `items`.
    pub fn list(&mut self, scalar: Scalar, length: u64, items: &mut Vec<i64>) -> Result<(), Fault> {
        items.clear();
        for _ in 0..length {
            let value = self.scalar(scalar)?;
            if value.fract() != 0.0 || value.abs() > 2.0_f64.powi(53) {
                return Err(Fault::NotANumber { text: value.to_string(), expected: "a whole number" });
            }
            items.push(value as i64);
        }
        Ok(())
    }

    /// Passes over `length` values.
    pub fn skip(&mut self, scalar: Scalar, length: u64) -> Result<(), Fault> {
        match self {
            Body::Text { .. } => (0..length).try_for_each(|_| self.word().map(|_| ())),
            Body::Binary { bytes, at, .. } => {
                let size = length * scalar.bytes() as u64; // at most 2³² · 8
                let left = (bytes.len() - *at) as u64;
                if size > left {
                    return Err(Fault::Over);
                }
                *at += size as usize;
                Ok(())
            }
        }
    }

    /// Bytes that no element accounts for; blank lines do not count.
    pub fn left(&self) -> usize {
        match self {
            Body::Text { lines, .. } => lines.rest().trim_ascii().len(),
            Body::Binary { bytes, at, .. } => bytes[*at..].trim_ascii().len(),
        }
    }

    /// The fault as an error, in record `found` of `element`.
    pub fn error(&self, fault: Fault, element: &Element, found: u64) -> ReadError {
        let at = match self {
            Body::Text { lines, .. } => Place::Line(lines.number()),
            Body::Binary { bytes, at, .. } => Place::Byte(if matches!(fault, Fault::Over) { bytes.len() } else { *at }),
        };
        match (fault, self) {
            (Fault::NotANumber { text, expected }, _) => ReadError::BadNumber { format: PLY, text, expected, at },
            (Fault::Over, Body::Text { lines, taken, .. }) if !lines.rest().is_empty() => {
                let what = format!("a record of the element “{}”", quoted(element.name.as_bytes()));
                ReadError::ShortLine { format: PLY, what, needed: taken + 1, found: *taken, at }
            }
            (Fault::Over, _) => {
                let what = match element.name.as_str() {
                    "vertex" => "vertices".to_owned(),
                    "face" => "faces".to_owned(),
                    name => format!("records of the element “{}”", quoted(name.as_bytes())),
                };
                ReadError::Truncated { format: PLY, what, promised: element.count, found, at }
            }
        }
    }

    /// The next word of a text line.
    fn word(&mut self) -> Result<&'a [u8], Fault> {
        let Body::Text { rest, taken, .. } = self else { return Err(Fault::Over) };
        let line = rest.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        if end == 0 {
            return Err(Fault::Over);
        }
        let (word, after) = line.split_at(end);
        *rest = after;
        *taken += 1;
        Ok(word)
    }
}

/// Bytes of a property's shortest binary form: a list may be empty.
fn shortest(property: &super::header::Property) -> usize {
    match property.kind {
        Kind::Scalar(scalar) => scalar.bytes(),
        Kind::List { count, .. } => count.bytes(),
    }
}

fn truth(word: &[u8]) -> Option<f64> {
    [("false", 0.0), ("true", 1.0)]
        .into_iter()
        .find(|(name, _)| word.eq_ignore_ascii_case(name.as_bytes()))
        .map(|(_, v)| v)
}

/// A value whose bytes stand first in `word`, least significant first.
fn decode(word: [u8; 8], scalar: Scalar) -> f64 {
    let [a, b, c, d, ..] = word;
    match scalar {
        Scalar::Bool => f64::from(a),
        Scalar::I8 => f64::from(a as i8),
        Scalar::U8 => f64::from(a),
        Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
        Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
        Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        Scalar::I64 => i64::from_le_bytes(word) as f64,
        Scalar::U64 => u64::from_le_bytes(word) as f64,
        Scalar::F16 => f16::from_le_bytes([a, b]).to_f64(),
        Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Scalar::F64 => f64::from_le_bytes(word),
    }
}
