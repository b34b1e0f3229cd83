//! The header of a PLY: its encoding, elements and properties.

use crate::read::encoding;
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
    /// Lines that are none of a header, taken for comments.
    pub strange: usize,
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
        Some(match name.to_ascii_lowercase().as_slice() {
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
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_slice() {
            b"bool" | b"boolean" => Self::Bool,
            b"char" | b"int8" | b"int8_t" | b"schar" => Self::I8,
            b"uchar" | b"uint8" | b"uint8_t" | b"byte" | b"ubyte" => Self::U8,
            b"short" | b"int16" | b"int16_t" => Self::I16,
            b"ushort" | b"uint16" | b"uint16_t" => Self::U16,
            b"int" | b"int32" | b"int32_t" => Self::I32,
            b"uint" | b"uint32" | b"uint32_t" => Self::U32,
            b"int64" | b"int64_t" | b"long" | b"longlong" => Self::I64,
            b"uint64" | b"uint64_t" | b"ulong" | b"ulonglong" => Self::U64,
            b"half" | b"float16" => Self::F16,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn is_whole(self) -> bool {
        !matches!(self, Self::F16 | Self::F32 | Self::F64)
    }
}

/// The header of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Header<'_>, ReadError> {
    let mut lines = Lines::new(bytes, 1);
    let magic = lines.any_line().filter(|line| line.bytes.trim_ascii_end().eq_ignore_ascii_case(b"ply"));
    if magic.is_none() {
        let begins = quoted(&bytes[..bytes.len().min(16)]);
        return Err(malformed(1, format!("the file begins with “{begins}” where ply must stand")));
    }
    // Where lines end with CR alone, an LF behind the header is its first byte of data.
    let lone_cr = bytes.iter().find(|b| b"\r\n".contains(b)) == Some(&b'\r') && !starts_with_crlf(bytes);
    let mut order = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut strange = 0;
    loop {
        let before = lines.rest();
        let Some(line) = lines.any_line() else {
            return Err(malformed(lines.number(), "the file ends before end_header; it may be cut off".to_owned()));
        };
        let words: Vec<&[u8]> = line.words().take(6).collect();
        let Some(keyword) = words.first().map(|word| word.to_ascii_lowercase()) else { continue };
        match (keyword.as_slice(), &words[1..]) {
            (b"comment" | b"obj_info", _) => {}
            (b"format", &[encoding, ..]) => order = Some(Order::named(encoding).ok_or_else(|| unknown(line))?),
            (b"element", &[name, count]) => elements.push(element(name, count, &elements, line)?),
            (b"property", rest) => {
                let Some(element) = elements.last_mut() else {
                    return Err(malformed(line.number, "a property stands before any element".to_owned()));
                };
                element.properties.push(property(rest).ok_or_else(|| unknown(line))?);
            }
            (b"end_header", _) => {
                if lone_cr && before[line.bytes.len()..].starts_with(b"\r\n") {
                    lines = Lines::new(&before[line.bytes.len() + 1..], line.number + 1);
                }
                break;
            }
            _ if is_prose(line) => strange += 1,
            _ => return Err(unknown(line)),
        }
    }
    let Some(order) = order else {
        return Err(ReadError::MissingElement { format: PLY, what: "line “format” in its header".to_owned() });
    };
    Ok(Header { order, elements, end: bytes.len() - lines.rest().len(), lines, strange })
}

fn starts_with_crlf(bytes: &[u8]) -> bool {
    bytes.iter().position(|&b| b == b'\r').is_some_and(|at| bytes.get(at + 1) == Some(&b'\n'))
}

/// Whether a line may be a comment whose first word was left out: it is text, and no word of it is one of a header.
fn is_prose(line: Line) -> bool {
    const WORDS: [&[u8]; 6] = [b"property", b"element", b"format", b"list", b"vertex", b"face"];
    let known = |word: &[u8]| Scalar::named(word).is_some() || WORDS.iter().any(|w| word.eq_ignore_ascii_case(w));
    line.bytes.iter().all(|b| !b.is_ascii_control() || *b == b'\t') && !line.words().any(known)
}

fn element(name: &[u8], count: &[u8], earlier: &[Element], line: Line) -> Result<Element, ReadError> {
    let name = match encoding::name(name) {
        name if ["vertex", "face"].iter().any(|known| name.eq_ignore_ascii_case(known)) => name.to_ascii_lowercase(),
        name => name,
    };
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
        [list, count, item, name] if list.eq_ignore_ascii_case(b"list") => {
            let (count, item) = (Scalar::named(count)?, Scalar::named(item)?);
            (name, Kind::List { count: Some(count).filter(|c| c.is_whole())?, item })
        }
        [scalar, name] => (name, Kind::Scalar(Scalar::named(scalar)?)),
        _ => return None,
    };
    Some(Property { name: encoding::name(name), kind })
}

fn unknown(line: Line) -> ReadError {
    malformed(line.number, format!("“{}” is not a line a PLY header can have", quoted(line.bytes.trim_ascii())))
}

fn malformed(line: usize, problem: String) -> ReadError {
    ReadError::Malformed { format: PLY, problem, at: Place::Line(line) }
}
