//! Why bytes could not be read as a scan, and where.

use std::fmt;

use serde_json::{Value, json};

use super::encoding;
use crate::shape::ShapeError;

/// Where in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// 1-based line of a text file.
    Line(usize),
    /// 0-based offset in a binary file.
    Byte(usize),
    /// The object inside a glTF document: `"accessors[3]"`.
    Object(String),
}

impl Place {
    fn entry(&self) -> (&'static str, Value) {
        match self {
            Place::Line(line) => ("line", json!(line)),
            Place::Byte(byte) => ("byte", json!(byte)),
            Place::Object(path) => ("object", json!(path)),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
            Place::Object(path) => f.write_str(path),
        }
    }
}

/// Why bytes could not be read as a scan. `format` is the format's name for people: `"PLY"`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file was read, and its points, faces or labels do not make a shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// No bytes at all.
    #[error("the file is empty")]
    Empty,
    /// Neither the bytes nor the name say what this is.
    #[error(
        "this is not a scan in a known format (OBJ, PLY, OFF, STL, GLB, glTF, XYZ, PTS or CSV); it begins with “{begins}”"
    )]
    UnknownFormat {
        /// The first bytes, as text.
        begins: String,
    },
    /// A format was asked for by a name that is none.
    #[error("“{given}” is not a format; known are off, ply, obj, stl, glb, gltf, xyz, pts and csv")]
    UnknownFormatName {
        /// The name, shortened.
        given: String,
    },
    /// The file does not follow the rules of its format.
    #[error("{format}, {at}: {problem}")]
    Malformed {
        /// Format.
        format: &'static str,
        /// What is wrong.
        problem: String,
        /// Where.
        at: Place,
    },
    /// The file ends before what it promises.
    #[error("{format} promises {promised} {what}, the file ends after {found} ({at}); it may be cut off")]
    Truncated {
        /// Format.
        format: &'static str,
        /// What is counted: `"vertices"`.
        what: String,
        /// Count announced.
        promised: u64,
        /// Count that is there in full.
        found: u64,
        /// Where the file ends.
        at: Place,
    },
    /// A file without counts that ends before it is complete.
    #[error("{format}, {at}: the file ends after {what} without {missing}; it may be cut off")]
    Unfinished {
        /// Format.
        format: &'static str,
        /// What is there in full, with its noun: `"12 facets"`.
        what: String,
        /// What a whole file would end with.
        missing: &'static str,
        /// Count that is there in full.
        found: u64,
        /// Where the file ends.
        at: Place,
    },
    /// A line with fewer values than it must have.
    #[error("{format}, {at}: {what} needs {needed} values, the line has {found}")]
    ShortLine {
        /// Format.
        format: &'static str,
        /// `"a vertex"`, `"a face"`.
        what: String,
        /// Values needed.
        needed: u64,
        /// Values there.
        found: u64,
        /// Where.
        at: Place,
    },
    /// Something else where a number must be.
    #[error("{format}, {at}: “{text}” is not {expected}{}", decimal_comma(text))]
    BadNumber {
        /// Format.
        format: &'static str,
        /// What is there, shortened.
        text: String,
        /// `"a number"`, `"a whole number"`, `"a count"`.
        expected: &'static str,
        /// Where.
        at: Place,
    },
    /// A part every scan of this format has is not there.
    #[error("this {format} has no {what}")]
    MissingElement {
        /// Format.
        format: &'static str,
        /// What is missing.
        what: String,
    },
    /// A face that names a point which is not there.
    #[error("{format}, {at}: face {face} names point {index}, but the file has {points} points ({})", range(*points, *first))]
    FaceIndex {
        /// Format.
        format: &'static str,
        /// 0-based number of the face.
        face: usize,
        /// The point named, as written in the file.
        index: i64,
        /// Points in the file.
        points: usize,
        /// What the format calls its first point: 0, or 1 in OBJ.
        first: u8,
        /// Where.
        at: Place,
    },
    /// A variant of the format that is not read.
    #[error("{feature} cannot be read; {cure}")]
    Unsupported {
        /// Which.
        feature: String,
        /// What to do instead.
        cure: &'static str,
    },
    /// A file of a known kind that is no format read here.
    #[error("this is {what}, which is not read; {cure}")]
    UnsupportedFormat {
        /// Which, with its article.
        what: &'static str,
        /// What to do instead.
        cure: &'static str,
    },
    /// A table of more columns than coordinates, whose headings do not say which are which.
    #[error(
        "{format}, {at}: which columns are x, y and z is not clear from the headings {}; call those three x, y and z",
        listed(headings)
    )]
    AmbiguousColumns {
        /// Format.
        format: &'static str,
        /// The headings, shortened.
        headings: Vec<String>,
        /// Where they stand.
        at: Place,
    },
    /// A glTF extension without which the file cannot be understood.
    #[error("this glTF needs the extension {extension}, which is not supported; {}", cure_of(extension))]
    UnsupportedExtension {
        /// Its name.
        extension: String,
    },
    /// A glTF whose data lies in another file.
    #[error(
        "this glTF keeps its data in another file, “{uri}”; give that file along with it, or save it as GLB or with the data embedded"
    )]
    ExternalBuffer {
        /// That file, shortened.
        uri: String,
    },
    /// A small file that unfolds (by compression, instances or empty accessors) into more than a file of its size may.
    #[error(
        "this {format} unfolds into more than {limit} {what}, the most that a file of its size may take; save it uncompressed, and each copy of a mesh with points \
         of its own"
    )]
    TooLarge {
        /// Format.
        format: &'static str,
        /// `"bytes in memory"` or `"points of morph targets"`.
        what: &'static str,
        /// The most that is read.
        limit: usize,
    },
}

impl ReadError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Shape(error) => error.code(),
            Self::Empty => "empty-file",
            Self::UnknownFormat { .. } => "unknown-format",
            Self::UnknownFormatName { .. } => "unknown-format-name",
            Self::Malformed { .. } => "malformed-file",
            Self::Truncated { .. } | Self::Unfinished { .. } => "truncated-file",
            Self::ShortLine { .. } => "short-line",
            Self::BadNumber { .. } => "bad-number",
            Self::MissingElement { .. } => "missing-element",
            Self::FaceIndex { .. } => "face-index-out-of-range",
            Self::Unsupported { .. } => "unsupported-variant",
            Self::UnsupportedFormat { .. } => "unsupported-format",
            Self::AmbiguousColumns { .. } => "ambiguous-columns",
            Self::UnsupportedExtension { .. } => "unsupported-extension",
            Self::ExternalBuffer { .. } => "external-buffer",
            Self::TooLarge { .. } => "too-large",
        }
    }

    /// The numbers behind the sentence; a place is `line`, `byte` or `object`.
    pub fn details(&self) -> Value {
        let (mut details, at) = match self {
            Self::Shape(error) => (error.details(), None),
            Self::Empty => (json!({}), None),
            Self::UnknownFormat { begins } => (json!({ "begins": begins }), None),
            Self::UnknownFormatName { given } => (json!({ "given": given }), None),
            Self::Malformed { format, problem, at } => (json!({ "format": format, "problem": problem }), Some(at)),
            Self::Truncated { format, what, promised, found, at } => {
                (json!({ "format": format, "what": what, "promised": promised, "found": found }), Some(at))
            }
            Self::Unfinished { format, missing, found, at, .. } => {
                (json!({ "format": format, "missing": missing, "found": found }), Some(at))
            }
            Self::ShortLine { format, what, needed, found, at } => {
                (json!({ "format": format, "what": what, "needed": needed, "found": found }), Some(at))
            }
            Self::BadNumber { format, text, expected, at } => {
                (json!({ "format": format, "text": text, "expected": expected }), Some(at))
            }
            Self::MissingElement { format, what } => (json!({ "format": format, "what": what }), None),
            Self::FaceIndex { format, face, index, points, first, at } => {
                (json!({ "format": format, "face": face, "index": index, "points": points, "first": first }), Some(at))
            }
            Self::Unsupported { feature, .. } => (json!({ "feature": feature }), None),
            Self::UnsupportedFormat { what, .. } => (json!({ "what": what }), None),
            Self::AmbiguousColumns { format, headings, at } => {
                (json!({ "format": format, "headings": headings }), Some(at))
            }
            Self::UnsupportedExtension { extension } => (json!({ "extension": extension }), None),
            Self::ExternalBuffer { uri } => (json!({ "uri": uri }), None),
            Self::TooLarge { format, what, limit } => (json!({ "format": format, "what": what, "limit": limit }), None),
        };
        if let Some((key, value)) = at.map(Place::entry) {
            details[key] = value;
        }
        details
    }

    /// Quotes the beginning of bytes nobody recognised.
    pub(super) fn unknown_format(bytes: &[u8]) -> Self {
        Self::UnknownFormat { begins: quoted(&bytes[..bytes.len().min(16)]) }
    }
}

/// Bytes as a person can read them: at most 40, control characters as `·`, and what is no UTF-8 as Latin-1.
pub(super) fn quoted(bytes: &[u8]) -> String {
    let text = encoding::name(&bytes[..bytes.len().min(40)]);
    text.chars().map(|c| if c.is_control() { '·' } else { c }).collect()
}

/// The beginning and the end of a sentence that may repeat a string of any length, as those about JSON do.
pub(crate) fn shortened(text: &str) -> String {
    const SHOWN: usize = 80;
    let count = text.chars().count();
    if count <= 2 * SHOWN {
        return text.to_owned();
    }
    let (start, end): (String, String) =
        (text.chars().take(SHOWN).collect(), text.chars().skip(count - SHOWN).collect());
    format!("{start} … {end}")
}

fn decimal_comma(text: &str) -> &'static str {
    if text.contains(',') { " (decimals are written with a point)" } else { "" }
}

fn listed(headings: &[String]) -> String {
    headings.iter().map(|h| format!("“{h}”")).collect::<Vec<_>>().join(", ")
}

/// How to save a glTF without an extension.
fn cure_of(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" => {
            "save it without Draco (in Blender leave “Compression” off; “gltf-transform copy in.glb out.glb” undoes it)"
        }
        "EXT_mesh_gpu_instancing" => "save it without instancing",
        _ => "save it without compression or instancing",
    }
}

fn range(points: usize, first: u8) -> String {
    match (points + usize::from(first)).checked_sub(1) {
        Some(last) if points > 0 => format!("{first} to {last}"),
        _ => "none".to_owned(),
    }
}
