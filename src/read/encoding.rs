//! Text in UTF-16, as spreadsheets and shells of Windows write it, becomes UTF-8.

use std::borrow::Cow;

/// Characters at the beginning that must all look like UTF-16 where no byte order mark says so.
const BEGINNING: usize = 64;

/// The bytes as they are, without a byte order mark, or what they say in UTF-16 of either byte order. Without a mark that is known by a zero
/// in every second byte of the beginning, where text in other encodings has none.
pub(super) fn in_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    match bytes {
        [0xEF, 0xBB, 0xBF, text @ ..] => Cow::Borrowed(text),
        [0xFF, 0xFE, text @ ..] => Cow::Owned(from_utf16(text, u16::from_le_bytes)),
        [0xFE, 0xFF, text @ ..] => Cow::Owned(from_utf16(text, u16::from_be_bytes)),
        _ if has_zeros(bytes, |[low, high]| (low, high)) => Cow::Owned(from_utf16(bytes, u16::from_le_bytes)),
        _ if has_zeros(bytes, |[high, low]| (low, high)) => Cow::Owned(from_utf16(bytes, u16::from_be_bytes)),
        _ => Cow::Borrowed(bytes),
    }
}

/// Whether the beginning is made of characters of ASCII, two bytes each.
fn has_zeros(bytes: &[u8], halves: impl Fn([u8; 2]) -> (u8, u8)) -> bool {
    let (units, _) = bytes.as_chunks::<2>();
    let is_character = |&unit: &[u8; 2]| {
        let (low, high) = halves(unit);
        high == 0 && (low.is_ascii_graphic() || low.is_ascii_whitespace())
    };
    units.len() >= 4 && units.iter().take(BEGINNING).all(is_character)
}

fn from_utf16(bytes: &[u8], unit: impl Fn([u8; 2]) -> u16) -> Vec<u8> {
    let (units, _) = bytes.as_chunks::<2>();
    // Tables and meshes are ASCII but for names.
    let mut text = Vec::with_capacity(units.len());
    for character in char::decode_utf16(units.iter().map(|&pair| unit(pair))) {
        let character = character.unwrap_or(char::REPLACEMENT_CHARACTER);
        text.extend_from_slice(character.encode_utf8(&mut [0; 4]).as_bytes());
    }
    text
}

/// A name as a person reads it: what is no UTF-8 is taken for Latin-1.
pub(super) fn name(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        // Cut within a character.
        Err(e) if e.error_len().is_none() => String::from_utf8_lossy(&bytes[..e.valid_up_to()]).into_owned(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}
