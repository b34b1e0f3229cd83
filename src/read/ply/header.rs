//! The header of a PLY: its encoding, elements and properties.

use crate::read::error::{Place, ReadError, quoted};
use crate::read::text::{Line, Lines};

/// The format in errors.
pub(super) const PLY: &str = "PLY";

/// What the header says.
pub(super) struct Header<'a> {
    /// How what follows is written.
    pub order: Order,
    pub elements: Vec<Element>,
    /// Where it ends, in bytes.
    pub end: usize,
    /// The lines behind it.
    pub lines: Lines<'a>,
}

/// How values are written.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Order {
    Text,
    Little,
    Big,
}

impl Order {
    pub fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"ascii" => Self::Text,
            b"binary_little_endian" => Self::Little,
            b"binary_big_endian" => Self::Big,
            _ => return None,
        })
    }
}

/// A table: `count` records of the same properties.
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// A column of that table.
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// One value per record, or a count and that many values.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// How a number is stored.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// The header of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Header<'_>, ReadError> {
    let mut lines = Lines::new(bytes, 1);
    let magic = lines.any_line().filter(|line| line.bytes.trim_ascii_end() == b"ply");
    if magic.is_none() {
        let begins = quoted(&bytes[..bytes.len().min(16)]);
        return Err(malformed(1, format!("the file begins with “{begins}” where ply must stand")));
    }
    let mut order = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let Some(line) = lines.any_line() else {
            return Err(malformed(lines.number(), "the file ends before end_header; it may be cut off".to_owned()));
        };
        let words: Vec<&[u8]> = line.words().take(6).collect();
        match words[..] {
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", encoding, ..] => order = Some(Order::named(encoding).ok_or_else(|| unknown(line))?),
            [b"element", name, count] => elements.push(element(name, count, &elements, line)?),
            [b"property", ref rest @ ..] => {
                let Some(element) = elements.last_mut() else {
                    return Err(malformed(line.number, "a property stands before any element".to_owned()));
                };
                element.properties.push(property(rest).ok_or_else(|| unknown(line))?);
            }
            [b"end_header"] => break,
            _ => return Err(unknown(line)),
        }
    }
    let Some(order) = order else {
        return Err(ReadError::MissingElement { format: PLY, what: "line “format” in its header".to_owned() });
    };
    Ok(Header { order, elements, end: bytes.len() - lines.rest().len(), lines })
}

fn element(name: &[u8], count: &[u8], earlier: &[Element], line: Line) -> Result<Element, ReadError> {
    let name = String::from_utf8_lossy(name).into_owned();
    if earlier.iter().any(|e| e.name == name) {
        return Err(malformed(line.number, format!("a second element “{}”", quoted(name.as_bytes()))));
    }
    let Some(count) = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok()) else {
        let at = Place::Line(line.number);
        return Err(ReadError::BadNumber { format: PLY, text: quoted(count), expected: "a count", at });
    };
    Ok(Element { name, count, properties: Vec::new() })
}

/// `type name` or `list type type name`; counts and corners are whole numbers.
fn property(words: &[&[u8]]) -> Option<Property> {
    let (name, kind) = match *words {
        [b"list", count, item, name] => {
            let (count, item) = (Scalar::named(count)?, Scalar::named(item)?);
            (name, Kind::List { count: Some(count).filter(|c| c.is_whole())?, item })
        }
        [scalar, name] => (name, Kind::Scalar(Scalar::named(scalar)?)),
        _ => return None,
    };
    Some(Property { name: String::from_utf8_lossy(name).into_owned(), kind })
}

fn unknown(line: Line) -> ReadError {
    malformed(line.number, format!("“{}” is not a line a PLY header can have", quoted(line.bytes.trim_ascii())))
}

fn malformed(line: usize, problem: String) -> ReadError {
    ReadError::Malformed { format: PLY, problem, at: Place::Line(line) }
}
