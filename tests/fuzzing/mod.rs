//! What random bytes are thrown at. A target takes any bytes and panics where something is wrong with what becomes of them. `tests/fuzz.rs` runs each over its
//! seeds and some thousand mutations of these, the programs in `fuzz/` for as long as one likes.

pub mod memory;
pub mod readers;
pub mod scans;
mod seeds;
pub mod stored;

use geose_fmap::Format;

/// One of the things that any bytes must not break.
pub struct Target {
    pub name: &'static str,
    pub run: fn(&[u8]),
    /// Bytes to start from.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All of them.
pub const TARGETS: [Target; 13] = [
    Target { name: "off", run: |bytes| readers::of_format(Format::Off, bytes), seeds: seeds::off },
    Target { name: "ply", run: |bytes| readers::of_format(Format::Ply, bytes), seeds: seeds::ply },
    Target { name: "obj", run: |bytes| readers::of_format(Format::Obj, bytes), seeds: seeds::obj },
    Target { name: "stl", run: |bytes| readers::of_format(Format::Stl, bytes), seeds: seeds::stl },
    Target { name: "glb", run: |bytes| readers::of_format(Format::Glb, bytes), seeds: seeds::glb },
    Target { name: "gltf", run: |bytes| readers::of_format(Format::Gltf, bytes), seeds: seeds::gltf },
    Target { name: "xyz", run: |bytes| readers::of_format(Format::Xyz, bytes), seeds: seeds::tables },
    Target { name: "pts", run: |bytes| readers::of_format(Format::Pts, bytes), seeds: seeds::tables },
    Target { name: "csv", run: |bytes| readers::of_format(Format::Csv, bytes), seeds: seeds::tables },
    Target { name: "any_format", run: readers::of_any_format, seeds: seeds::any_format },
    Target { name: "prepare", run: scans::survives, seeds: scans::seeds },
    Target { name: "stored_bytes", run: stored::survives, seeds: stored::seeds },
    Target { name: "stored_edits", run: stored::survives_edits, seeds: scans::seeds },
];

/// The target of this name.
pub fn target(name: &str) -> &'static Target {
    TARGETS.iter().find(|target| target.name == name).unwrap_or_else(|| panic!("no target {name}"))
}
