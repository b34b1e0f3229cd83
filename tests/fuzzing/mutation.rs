//! Ways to break a file, the same on every machine.

use crate::shapes::Random;

/// Pieces that readers may stumble over.
const PIECES: [&[u8]; 16] = [
    b"4294967295",
    b"-1",
    b"9999999999999999999999",
    b"\n",
    b"\0",
    b"nan",
    b"1e400",
    b" ",
    b"{",
    b"[",
    b"list",
    b"\"",
    b"\\\n",
    b",",
    b";",
    b"#",
];

/// Some bytes, at least one, after one of the ways to break them, named.
pub fn broken(bytes: &[u8], random: &mut Random) -> (&'static str, Vec<u8>) {
    let mut broken = bytes.to_vec();
    // Half of the time near the beginning, where the counts and the structure are.
    let place = |random: &mut Random, length: usize| match random.below(2) {
        0 => random.below(length),
        _ => random.below(length.min(900)),
    };
    let at = place(random, bytes.len());
    let what = match random.below(6) {
        0 => {
            broken.truncate(at);
            "truncated"
        }
        1 => {
            for _ in 0..=random.below(8) {
                let at = place(random, broken.len());
                broken[at] = random.below(256) as u8;
            }
            "bytes changed"
        }
        2 => {
            broken[at] ^= 1 << random.below(8);
            "a bit flipped"
        }
        3 => {
            let end = (at + 1 + random.below(600)).min(bytes.len());
            let block = &bytes[at..end];
            let to = place(random, bytes.len());
            let times = 1 + random.below(20);
            broken.splice(to..to, block.repeat(times));
            "a block repeated"
        }
        4 => {
            // Most of all where there are digits already: a count becomes a larger one.
            let digit = (at..bytes.len()).find(|&i| bytes[i].is_ascii_digit()).unwrap_or(at);
            let digits: Vec<u8> = (0..=random.below(20)).map(|_| b'0' + random.below(10) as u8).collect();
            broken.splice(digit..digit, digits);
            "digits inserted"
        }
        _ => {
            let end = (at + random.below(6)).min(bytes.len());
            broken.splice(at..end, PIECES[random.below(PIECES.len())].iter().copied());
            "a piece replaced"
        }
    };
    (what, broken)
}
