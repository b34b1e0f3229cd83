//! Readers on any bytes: a shape or an error with a code and a sentence, soon and without much memory.

use std::time::{Duration, Instant};

use geose_fmap::{Format, Pose, ReadOptions, read_with};

use super::memory::peak_of;

/// What reading so many bytes may hold at one time. What a glTF draws several times may be read that often, as long as it stays small.
fn allowed(bytes: usize, format: Option<Format>) -> usize {
    let any = if matches!(format, None | Some(Format::Glb | Format::Gltf)) { 32 << 20 } else { 0 };
    (1 << 20) + (64 * bytes).max(any)
}

/// A second for every 100 kB, and for less.
fn patience(bytes: usize) -> Duration {
    Duration::from_secs(1).mul_f64((bytes as f64 / 1e5).max(1.0))
}

/// Reads, and insists on all that is promised of any file.
pub fn survives(bytes: &[u8], options: &ReadOptions) {
    let size = bytes.len() + options.companions.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
    let timed = || {
        let start = Instant::now();
        let (result, peak) = peak_of(|| read_with(bytes, options));
        (start.elapsed(), result, peak)
    };
    let (mut took, result, peak) = timed();
    // A machine that does other work may let a reader wait; one that hangs hangs each time.
    for _ in 0..2 {
        if took >= patience(size) {
            took = timed().0;
        }
    }
    assert!(took < patience(size), "{took:?} for {size} bytes");
    assert!(peak <= allowed(size, options.format), "{peak} bytes held for {size} bytes");
    match result {
        Ok(shape) => {
            let points = shape.points().len();
            assert!(shape.points().iter().flatten().all(|c| c.is_finite()));
            assert!(shape.faces().iter().flatten().all(|&i| (i as usize) < points));
            assert!(shape.repairs().iter().all(|r| r.count > 0 && r.message.contains(' ')));
        }
        Err(error) => {
            let sentence = error.to_string();
            assert!(sentence.contains(' ') && sentence.len() > 10 && sentence.len() < 1000, "{sentence:?}");
            assert!(!error.code().is_empty() && error.details().is_object());
        }
    }
}

/// As a file of this format. Half of the bodies with a skeleton are read at rest.
pub fn of_format(format: Format, bytes: &[u8]) {
    let pose = if bytes.len().is_multiple_of(2) { Pose::Saved } else { Pose::Rest };
    let options = ReadOptions { format: Some(format), pose, ..ReadOptions::default() };
    if format != Format::Gltf {
        survives(bytes, &options);
        return;
    }
    // JSON holds no zero byte: what follows the first is the file beside it.
    let (document, beside) = match bytes.iter().position(|&b| b == 0) {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None => (bytes, &[][..]),
    };
    survives(document, &ReadOptions { companions: &[("data.bin", beside)], ..options });
}

/// Names that a file of no known format may have; the first stands for none.
pub const NAMES: [&str; 16] = [
    "", "a.off", "a.ply", "a.obj", "a.stl", "a.glb", "a.gltf", "a.xyz", "a.pts", "a.csv", "a.tsv", "a.asc", "a.spz",
    "a.splat", "a.zip", "a",
];

/// As a file whose format is to be found: the first byte chooses its name.
pub fn of_any_format(bytes: &[u8]) {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let name = NAMES[usize::from(*choice) % NAMES.len()];
    survives(bytes, &ReadOptions { name: (!name.is_empty()).then_some(name), ..ReadOptions::default() });
}
