//! STL, text or binary: loose triangles, three points each, in the order of the file.
//!
//! An own reader rather than stl_io: that one takes whatever begins with “solid ” for text, rounds the coordinates of text to f32, and
//! its errors carry neither a place nor the numbers of triangles promised and found.

mod binary;
mod text;

use super::draft::Draft;
use super::error::ReadError;

/// Bytes from the beginning of a file in which a binary one has a zero byte: if not in its header or count, then in the attributes of its
/// first triangles.
const BEGINNING: usize = 1024;

/// Reads positions; normals, attributes and names are passed over. Corners that lie in one place stay separate points here.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    if is_text(bytes) { text::read(bytes) } else { binary::read(bytes) }
}

/// Whether the bytes announce an STL: by a length that fits the count of a binary one, or by the word a text one begins with.
pub(super) fn announced_by(bytes: &[u8]) -> bool {
    binary::fits_its_count(bytes) || begins_with_solid(bytes)
}

/// Whether the bytes look like a binary STL whose count was never filled in.
pub(super) fn looks_like_one(bytes: &[u8]) -> bool {
    binary::is_uncounted(bytes)
}

/// Binary files may begin with “solid” too. They are told from text by their length, and where that is wrong by their zero bytes.
fn is_text(bytes: &[u8]) -> bool {
    let binary = || {
        binary::fits_its_count(bytes) || binary::is_uncounted(bytes) || bytes[..bytes.len().min(BEGINNING)].contains(&0)
    };
    begins_with_solid(bytes) && !binary()
}

/// `solid`, or `solidNAME` where a facet follows.
fn begins_with_solid(bytes: &[u8]) -> bool {
    let word = bytes.trim_ascii_start();
    let facet = || {
        let begin = word[..word.len().min(BEGINNING)].to_ascii_lowercase();
        begin.windows(5).any(|w| w == b"facet")
    };
    word.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"))
        && (word.get(5).is_none_or(u8::is_ascii_whitespace) || facet())
}
