//! The bytes of buffers: the binary chunk of a GLB, data URIs, files beside the document, and what is decompressed out of these.

use std::borrow::Cow;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use gltf::{Buffer, Document, buffer};

use super::compressed::Compressed;
use super::container::GLTF;
use crate::read::error::{Place, ReadError};

/// What buffers may come from.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    /// The binary chunk.
    pub blob: Option<&'a [u8]>,
    /// Files beside the document.
    pub companions: &'a [(&'a str, &'a [u8])],
    /// A compression that the file uses, required or not: the reason if data turns out to be missing.
    pub compression: Option<&'a str>,
}

/// The data of each buffer, or why it cannot be had: that only matters once something is read from it.
pub(super) struct Buffers<'a>(Vec<Result<Cow<'a, [u8]>, ReadError>>);

impl<'a> Buffers<'a> {
    /// The buffers of `document`, of which the last are those that `views` are decompressed into, in order.
    pub fn of(document: &Document, sources: Sources<'a>, views: &[Compressed]) -> Self {
        let stored = document.buffers().len() - views.len();
        let mut buffers = Self(document.buffers().take(stored).map(|buffer| load(&buffer, sources)).collect());
        for view in views {
            let decoded = buffers.at(view.buffer).and_then(|data| view.decode(data)).map(Cow::Owned);
            buffers.0.push(decoded);
        }
        buffers
    }

    pub fn get(&self, buffer: &Buffer) -> Result<&[u8], ReadError> {
        self.at(buffer.index())
    }

    fn at(&self, index: usize) -> Result<&[u8], ReadError> {
        match self.0.get(index) {
            Some(Ok(data)) => Ok(data),
            Some(Err(error)) => Err(error.clone()),
            None => Err(ReadError::MissingElement { format: GLTF, what: format!("buffer {index}") }),
        }
    }
}

fn load<'a>(buffer: &Buffer, sources: Sources<'a>) -> Result<Cow<'a, [u8]>, ReadError> {
    let at = || Place::Object(format!("buffers[{}]", buffer.index()));
    let data = match (buffer.source(), sources.blob) {
        (buffer::Source::Uri(uri), _) => match uri.strip_prefix("data:") {
            Some(data) => Cow::Owned(decode(data).ok_or_else(|| ReadError::Malformed {
                format: GLTF,
                problem: "its data URI is not valid base64".to_owned(),
                at: at(),
            })?),
            None => Cow::Borrowed(
                companion(uri, sources.companions)
                    .ok_or_else(|| ReadError::ExternalBuffer { uri: unescaped(uri).chars().take(200).collect() })?,
            ),
        },
        (buffer::Source::Bin, Some(blob)) => Cow::Borrowed(blob),
        (buffer::Source::Bin, None) => {
            return Err(match sources.compression {
                Some(extension) => ReadError::UnsupportedExtension { extension: extension.to_owned() },
                None => ReadError::MissingElement { format: GLTF, what: format!("data for buffer {}", buffer.index()) },
            });
        }
    };
    if data.len() < buffer.length() {
        let (promised, found) = (buffer.length() as u64, data.len() as u64);
        let what = format!("bytes in buffer {}", buffer.index());
        return Err(ReadError::Truncated { format: GLTF, what, promised, found, at: at() });
    }
    Ok(data)
}

/// What follows `data:`, which must be base64.
fn decode(uri: &str) -> Option<Vec<u8>> {
    let (_, data) = uri.split_once(";base64,")?;
    BASE64_STANDARD.decode(data).ok()
}

/// The file that a URI names: by its whole path, or by its last part in any case.
fn companion<'a>(uri: &str, companions: &[(&'a str, &'a [u8])]) -> Option<&'a [u8]> {
    let path = unescaped(uri);
    let last = |path: &str| path.rsplit(['/', '\\']).next().unwrap_or_default().to_lowercase();
    let exact = companions.iter().find(|(name, _)| *name == path);
    exact.or_else(|| companions.iter().find(|(name, _)| last(name) == last(&path))).map(|(_, bytes)| *bytes)
}

/// `my%20body.bin` as `my body.bin`.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.get(..2).filter(|_| first == b'%').and_then(|d| std::str::from_utf8(d).ok());
        let byte = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        rest = if byte.is_some() { &after[2..] } else { after };
        bytes.push(byte.unwrap_or(first));
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
