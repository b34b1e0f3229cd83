//! The GLB container: a header and length-prefixed chunks, of which the first is the JSON and the second the data.

use crate::read::error::{Place, ReadError};

/// The format in errors.
pub(super) const GLTF: &str = "glTF";

/// What a file holds.
pub(super) struct Chunks<'a> {
    pub json: &'a [u8],
    pub blob: Option<&'a [u8]>,
    /// Whether chunks are not filled up to whole words, as the format asks.
    pub unpadded: bool,
}

/// The word before the data of the binary chunk.
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// The JSON and the binary chunk. Anything without the magic word is taken for JSON as a whole.
pub(super) fn split(bytes: &[u8]) -> Result<Chunks<'_>, ReadError> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Chunks { json: bytes, blob: None, unpadded: false });
    }
    let header = |at: usize| word(bytes, at).ok_or_else(|| truncated("header bytes", 12, bytes.len(), bytes.len()));
    let (version, length) = (header(4)?, header(8)? as usize);
    if version != 2 {
        let feature = format!("version {version} of binary glTF");
        return Err(ReadError::Unsupported { feature, cure: "save it as glTF 2.0" });
    }
    // A length may count the filling that was left out at the end.
    if length > bytes.len().next_multiple_of(4) {
        return Err(truncated("bytes", length, bytes.len(), bytes.len()));
    }
    let file = &bytes[..length.clamp(12, bytes.len().max(12))];
    let (json, next) = chunk(file, 12)?.ok_or_else(|| truncated("JSON chunk", 1, 0, 12))?;
    if word(file, 16) != Some(u32::from_le_bytes(*b"JSON")) {
        let problem = "the first chunk is not JSON".to_owned();
        return Err(ReadError::Malformed { format: GLTF, problem, at: Place::Byte(16) });
    }
    let unpadded = !next.is_multiple_of(4) && word(bytes, next + 4) == Some(BIN);
    // The length of the file may leave out the filling too, or count it.
    let (file, next) = if unpadded { (bytes, next) } else { (file, next.next_multiple_of(4)) };
    let blob = match chunk(file, next)? {
        Some((blob, _)) if word(file, next + 4) == Some(BIN) => Some(blob),
        _ => None, // no data, or a chunk of an extension
    };
    Ok(Chunks { json, blob, unpadded })
}

/// The data of the chunk at `at` and where it ends; `None` at the end of the file. The filling at its end may be missing, but no data is:
/// what a buffer needs of it is checked there.
fn chunk(file: &[u8], at: usize) -> Result<Option<(&[u8], usize)>, ReadError> {
    if file.len().saturating_sub(at) == 0 {
        return Ok(None);
    }
    let start = at + 8;
    let left = file.len().saturating_sub(start);
    let Some(length) = word(file, at).filter(|_| start <= file.len()) else {
        return Err(truncated("bytes of a chunk header", 8, file.len() - at, at));
    };
    let length = length as usize;
    if length > left && length != left.next_multiple_of(4) {
        return Err(truncated("bytes of a chunk", length, left, at));
    }
    let end = start + length.min(left);
    Ok(Some((&file[start..end], end)))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|w| u32::from_le_bytes(*w))
}

fn truncated(what: &str, promised: usize, found: usize, at: usize) -> ReadError {
    let (promised, found) = (promised as u64, found as u64);
    ReadError::Truncated { format: GLTF, what: what.to_owned(), promised, found, at: Place::Byte(at) }
}
