//! Decoder of EXT_meshopt_compression (bitstreams of the extension's appendix, and version 1 of attributes, which KHR_meshopt_compression
//! adds).
//!
//! An own decoder: meshopt-rs 0.1.2 (2022) is the only one in Rust alone, wants the size of a vertex when it is compiled, and panics on bytes
//! that are wrong; the other crates bring a C++ library along.

/// How the bytes of a view are compressed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Mode {
    /// Items of any kind.
    Attributes,
    /// Corners of triangles.
    Triangles,
    /// Any indices.
    Indices,
}

/// Most bytes of an attribute.
const WIDEST: usize = 256;
/// Items that are compressed together.
const GROUP: usize = 16;

/// `count` items of `stride` bytes; `None` where the data is no such thing.
pub(super) fn decode(data: &[u8], mode: Mode, count: usize, stride: usize) -> Option<Vec<u8>> {
    match mode {
        Mode::Attributes => attributes(data, count, stride),
        Mode::Triangles => triangles(data, Indices::of(count, stride)?),
        Mode::Indices => indices(data, Indices::of(count, stride)?),
    }
}

/// The filter EXPONENTIAL: an exponent and a mantissa of 24 bits become a float.
pub(super) fn unfold_exponents(data: &mut [u8]) {
    for word in data.as_chunks_mut::<4>().0 {
        let value = i32::from_le_bytes(*word);
        let (exponent, mantissa) = (value >> 24, (value << 8) >> 8);
        *word = ((f64::from(mantissa) * f64::from(exponent).exp2()) as f32).to_le_bytes();
    }
}

/// Reads from the beginning of bytes.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|b| b[0])
    }

    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }

    /// A whole number, seven bits a byte.
    fn number(&mut self) -> Option<u32> {
        let mut value = 0;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7F).checked_shl(shift).unwrap_or(0);
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }
}

/// A difference whose sign is its lowest bit.
fn signed(value: u32) -> u32 {
    (value >> 1) ^ 0_u32.wrapping_sub(value & 1)
}

fn attributes(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    if stride == 0 || stride > WIDEST || !stride.is_multiple_of(4) {
        return None;
    }
    let version = match *data.first()? {
        0xA0 => 0,
        0xA1 => 1,
        _ => return None,
    };
    // The first item, and in version 1 how each four bytes differ from item to item; the end is filled up.
    let tail = if version == 0 { stride } else { stride + stride / 4 };
    let padded = tail.max(if version == 0 { 32 } else { 24 });
    let body = data.get(1..data.len().checked_sub(padded)?)?;
    let tail = &data[data.len() - tail..];
    let mut last = tail[..stride].to_vec();
    let channels = &tail[stride..];

    let block = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut source = Bytes(body);
    let mut items = Vec::with_capacity(count * stride);
    let mut deltas = vec![0; block * stride];
    while items.len() < count * stride {
        let length = (count - items.len() / stride).min(block);
        let control = if version == 0 { &[][..] } else { source.take(stride / 4)? };
        for k in 0..stride {
            let column = &mut deltas[k * block..(k + 1) * block];
            column.fill(0);
            match control.get(k / 4).map(|byte| byte >> (2 * (k % 4)) & 3) {
                None => column_of(&mut source, column, length, [0, 2, 4, 8])?,
                Some(0) => column_of(&mut source, column, length, [0, 1, 2, 4])?,
                Some(1) => column_of(&mut source, column, length, [1, 2, 4, 8])?,
                Some(2) => {}
                Some(_) => column[..length].copy_from_slice(source.take(length)?),
            }
        }
        for item in 0..length {
            for k in (0..stride).step_by(4) {
                let delta = [0, 1, 2, 3].map(|byte| deltas[(k + byte) * block + item]);
                let word = last[k..k + 4].first_chunk_mut::<4>()?;
                *word = next(*word, delta, channels.get(k / 4).copied().unwrap_or(0))?;
            }
            items.extend_from_slice(&last);
        }
    }
    source.0.is_empty().then_some(items)
}

/// One byte of each of `length` items: two bits a group say how many bits its values have, and the largest value of those bits says that a
/// byte follows instead.
fn column_of(source: &mut Bytes, column: &mut [u8], length: usize, widths: [usize; 4]) -> Option<()> {
    let groups = length.div_ceil(GROUP);
    let header = source.take(groups.div_ceil(4))?;
    for (g, group) in column.chunks_mut(GROUP).take(groups).enumerate() {
        match widths[usize::from(header[g / 4] >> (2 * (g % 4)) & 3)] {
            0 => {}
            8 => group.copy_from_slice(source.take(GROUP)?),
            width => {
                let packed = source.take(GROUP * width / 8)?;
                let most = (1_u8 << width) - 1;
                for (i, value) in group.iter_mut().enumerate() {
                    let (byte, place) = (packed[i * width / 8], i * width % 8);
                    // Single bits stand in the other order.
                    let bits = byte >> (if width == 1 { place } else { 8 - width - place }) & most;
                    *value = if bits == most { source.byte()? } else { bits };
                }
            }
        }
    }
    Some(())
}

/// Four bytes of an item from those of the item before: differences of bytes or of halves, or a rotated exclusive or.
fn next(last: [u8; 4], delta: [u8; 4], channel: u8) -> Option<[u8; 4]> {
    match channel & 3 {
        0 => Some(std::array::from_fn(|k| last[k].wrapping_add(signed(u32::from(delta[k])) as u8))),
        1 => {
            let half = |bytes: [u8; 4], k: usize| u16::from_le_bytes([bytes[k], bytes[k + 1]]);
            let sum = |k: usize| half(last, k).wrapping_add(signed(u32::from(half(delta, k))) as u16).to_le_bytes();
            let ([a, b], [c, d]) = (sum(0), sum(2));
            Some([a, b, c, d])
        }
        2 => {
            let turned = u32::from_le_bytes(delta).rotate_right(u32::from(channel >> 4));
            Some((u32::from_le_bytes(last) ^ turned).to_le_bytes())
        }
        _ => None,
    }
}

/// The last values, newest first.
struct Recent<T, const N: usize> {
    values: [T; N],
    at: usize,
}

impl<T: Copy + Default, const N: usize> Recent<T, N> {
    fn new() -> Self {
        Self { values: [T::default(); N], at: 0 }
    }

    fn push(&mut self, value: T) {
        self.values[self.at] = value;
        self.at = (self.at + 1) % N;
    }

    fn get(&self, back: u8) -> T {
        self.values[(self.at + N - 1 - usize::from(back)) % N]
    }
}

/// Indices as the bytes they come out as.
struct Indices {
    count: usize,
    stride: usize,
    bytes: Vec<u8>,
}

impl Indices {
    /// Room for `count` of them.
    fn of(count: usize, stride: usize) -> Option<Self> {
        [2, 4].contains(&stride).then(|| Self { count, stride, bytes: Vec::with_capacity(count * stride) })
    }

    fn push(&mut self, index: u32) {
        self.bytes.extend_from_slice(&index.to_le_bytes()[..self.stride]);
    }
}

/// Corners: a code a triangle says which edge of a recent one it shares and which point it adds.
fn triangles(data: &[u8], mut corners: Indices) -> Option<Vec<u8>> {
    let count = corners.count;
    if *data.first()? != 0xE1 || !count.is_multiple_of(3) {
        return None;
    }
    let body = data.get(1..data.len().checked_sub(16)?)?;
    let table = &data[data.len() - 16..];
    let (codes, rest) = body.split_at_checked(count / 3)?;
    let mut source = Bytes(rest);
    let mut edges = Recent::<(u32, u32), 16>::new();
    let mut points = Recent::<u32, 16>::new();
    let (mut fresh, mut last) = (0_u32, 0_u32);
    let take_fresh = |fresh: &mut u32| {
        let value = *fresh;
        *fresh = fresh.wrapping_add(1);
        value
    };
    for &code in codes {
        let (high, low) = (code >> 4, code & 15);
        let triangle = if high < 15 {
            let (a, b) = edges.get(high);
            let c = match low {
                0 => take_fresh(&mut fresh),
                1..13 => points.get(low),
                13 => last.wrapping_sub(1),
                14 => last.wrapping_add(1),
                _ => last.wrapping_add(signed(source.number()?)),
            };
            if low == 0 || low >= 13 {
                points.push(c);
            }
            if low >= 13 {
                last = c;
            }
            edges.push((c, b));
            edges.push((a, c));
            [a, b, c]
        } else {
            let pair = if low < 14 { table[usize::from(low)] } else { source.byte()? };
            if low >= 14 && pair == 0 {
                fresh = 0;
            }
            let mut corner = |kind: u8, free: bool| -> Option<(u32, bool)> {
                Some(match kind {
                    0 => (take_fresh(&mut fresh), true),
                    15 if free => {
                        last = last.wrapping_add(signed(source.number()?));
                        (last, true)
                    }
                    kind => (points.get(kind - 1), false),
                })
            };
            let free = low >= 14;
            let a = corner(if low == 15 { 15 } else { 0 }, free)?;
            let b = corner(pair >> 4, free)?;
            let c = corner(pair & 15, free)?;
            [a, b, c].into_iter().filter(|(_, new)| *new).for_each(|(point, _)| points.push(point));
            let [a, b, c] = [a.0, b.0, c.0];
            edges.push((b, a));
            edges.push((c, b));
            edges.push((a, c));
            [a, b, c]
        };
        triangle.into_iter().for_each(|corner| corners.push(corner));
    }
    Some(corners.bytes)
}

/// Indices as differences from one of two before.
fn indices(data: &[u8], mut indices: Indices) -> Option<Vec<u8>> {
    if *data.first()? != 0xD1 || indices.count > data.len() {
        return None;
    }
    let mut source = Bytes(&data[1..]);
    let mut last = [0_u32; 2];
    for _ in 0..indices.count {
        let value = source.number()?;
        let which = &mut last[(value & 1) as usize];
        *which = which.wrapping_add(signed(value >> 1));
        indices.push(*which);
    }
    Some(indices.bytes)
}
