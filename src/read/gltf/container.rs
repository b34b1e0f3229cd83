//! The GLB container: a header and length-prefixed chunks, of which the first is the JSON and the second the data.

use crate::read::error::{Place, ReadError};

/// The format in errors.
pub(super) const GLTF: &str = "glTF";

/// The JSON and the binary chunk. Anything without the magic word is taken for JSON as a whole.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let header = |at: usize| word(bytes, at).ok_or_else(|| truncated("header bytes", 12, bytes.len(), bytes.len()));
    let (version, length) = (header(4)?, header(8)? as usize);
    if version != 2 {
        let feature = format!("version {version} of binary glTF");
        return Err(ReadError::Unsupported { feature, cure: "save it as glTF 2.0" });
    }
    if length > bytes.len() {
        return Err(truncated("bytes", length, bytes.len(), bytes.len()));
    }
    let file = &bytes[..length.max(12)];
    let (json, next) = chunk(file, 12)?.ok_or_else(|| truncated("JSON chunk", 1, 0, 12))?;
    if word(file, 16) != Some(u32::from_le_bytes(*b"JSON")) {
        let problem = "the first chunk is not JSON".to_owned();
        return Err(ReadError::Malformed { format: GLTF, problem, at: Place::Byte(16) });
    }
    let blob = match chunk(file, next)? {
        Some((blob, _)) if word(file, next + 4) == Some(u32::from_le_bytes(*b"BIN\0")) => Some(blob),
        _ => None, // no data, or a chunk of an extension
    };
    Ok((json, blob))
}

/// The data of the chunk at `at` and where the next one starts; `None` at the end of the file.
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
    if length > left {
        return Err(truncated("bytes of a chunk", length, left, at));
    }
    Ok(Some((&file[start..start + length], (start + length).next_multiple_of(4))))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|w| u32::from_le_bytes(*w))
}

fn truncated(what: &str, promised: usize, found: usize, at: usize) -> ReadError {
    let (promised, found) = (promised as u64, found as u64);
    ReadError::Truncated { format: GLTF, what: what.to_owned(), promised, found, at: Place::Byte(at) }
}
