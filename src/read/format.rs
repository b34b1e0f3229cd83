//! Which format bytes are in: what they announce, else what their name ends with, else what they look like.

use std::str::FromStr;

use super::error::ReadError;
use super::text::{Lines, number};
use super::{stl, table};

/// File formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Object File Format, text.
    Off,
    /// Stanford polygon format, text or binary of either byte order.
    Ply,
    /// Wavefront OBJ, text.
    Obj,
    /// STL, text or binary.
    Stl,
    /// Binary glTF 2.0.
    Glb,
    /// glTF 2.0 as JSON with its buffers inside, as `data:` URIs, or in files given along with it.
    Gltf,
    /// Points as a table of text; the usual name for one without a header.
    Xyz,
    /// The same behind a count, as laser scanners write it.
    Pts,
    /// The same with a header and separators.
    Csv,
}

/// The words an OBJ line may start with.
const OBJ_WORDS: [&[u8]; 13] =
    [b"v", b"vt", b"vn", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl", b"usemap"];

/// Lines looked at before text is taken, or not taken, for an OBJ.
const OBJ_LINES: usize = 50;

impl Format {
    /// All of them, in the order they are named to people.
    pub const ALL: [Format; 9] = [
        Format::Off,
        Format::Ply,
        Format::Obj,
        Format::Stl,
        Format::Glb,
        Format::Gltf,
        Format::Xyz,
        Format::Pts,
        Format::Csv,
    ];

    /// The usual extension, which is also the name [`FromStr`] takes: `"off"`, `"ply"`, `"obj"`, …
    pub fn extension(self) -> &'static str {
        match self {
            Format::Off => "off",
            Format::Ply => "ply",
            Format::Obj => "obj",
            Format::Stl => "stl",
            Format::Glb => "glb",
            Format::Gltf => "gltf",
            Format::Xyz => "xyz",
            Format::Pts => "pts",
            Format::Csv => "csv",
        }
    }

    /// The format of a file with this name, by its extension.
    pub(super) fn of_name(name: &str) -> Option<Format> {
        let (_, extension) = name.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "fcsv" | "tsv" => Some(Format::Csv),
            "asc" | "xyzn" | "xyzrgb" => Some(Format::Xyz),
            extension => extension.parse().ok(),
        }
    }

    /// The format these bytes announce.
    pub(super) fn of_bytes(bytes: &[u8]) -> Option<Format> {
        if bytes.starts_with(b"glTF") {
            return Some(Format::Glb);
        }
        if bytes.get(..3).is_some_and(|word| word.eq_ignore_ascii_case(b"ply"))
            && bytes.get(3).is_some_and(u8::is_ascii_whitespace)
        {
            return Some(Format::Ply);
        }
        if stl::announced_by(bytes) {
            return Some(Format::Stl);
        }
        if bytes.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{') {
            return Some(Format::Gltf);
        }
        let mut lines = Lines::without_comments(bytes);
        let first = lines.next()?;
        if first.words().next().is_some_and(announces_off) {
            return Some(Format::Off);
        }
        let mut vertex = false;
        for line in std::iter::once(first).chain(lines).take(OBJ_LINES) {
            let mut words = line.words();
            let keyword = words.next()?;
            if !OBJ_WORDS.contains(&keyword) {
                return None;
            }
            vertex |= keyword == b"mtllib" || keyword == b"v" && words.next().and_then(number).is_some();
        }
        vertex.then_some(Format::Obj)
    }

    /// The format these bytes may be in although they do not say so.
    pub(super) fn like(bytes: &[u8]) -> Option<Format> {
        match stl::looks_like_one(bytes) {
            true => Some(Format::Stl),
            false => table::looks_like_one(bytes).then_some(Format::Xyz),
        }
    }
}

/// `OFF`, `COFF`, `STCNOFF`, `4nOFF`, …, and `OFF123`: some writers leave out the line break before the counts.
fn announces_off(word: &[u8]) -> bool {
    let Some(at) = word.windows(3).position(|w| w == b"OFF") else { return false };
    word[..at].iter().all(|b| b"STCN4n".contains(b)) && word[at + 3..].iter().all(u8::is_ascii_digit)
}

impl FromStr for Format {
    type Err = ReadError;

    fn from_str(name: &str) -> Result<Self, ReadError> {
        Self::ALL
            .into_iter()
            .find(|f| f.extension().eq_ignore_ascii_case(name))
            .ok_or_else(|| ReadError::UnknownFormatName { given: name.chars().take(40).collect() })
    }
}
