//! Scans from disk, with the files that lie beside them.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use clap::Args;

use super::arguments::{Failure, Preparing, parse};
use crate::pipeline::{PreparedShape, Processor};
use crate::progress::{Progress, Stage};
use crate::read::{Pose, ReadError, ReadOptions, read_with};
use crate::shape::Shape;

/// Options on how a scan is read.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct Reading {
    /// The pose of a glTF with a skeleton or morph targets: saved, as its nodes stand, or rest, as its points are stored.
    #[arg(long, default_value = "saved", value_parser = parse::<Pose>)]
    pub pose: Pose,
}

pub(super) fn read_scan(path: &Path, reading: Reading) -> Result<Shape, Failure> {
    let failed = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let bytes = std::fs::read(path).map_err(|e| failed(&e))?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut beside: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    loop {
        let companions: Vec<(&str, &[u8])> = beside.iter().map(|(name, bytes)| (&**name, &**bytes)).collect();
        let options = ReadOptions { name: name.as_deref(), pose: reading.pose, companions: &companions, format: None };
        match read_with(&bytes, &options) {
            Err(ReadError::ExternalBuffer { uri }) if is_beside(&uri) && !beside.contains_key(&uri) => {
                let sibling = path.with_file_name(&uri);
                let found = std::fs::read(&sibling).map_err(|e| failed(&format!("{}: {e}", sibling.display())))?;
                beside.insert(uri, found);
            }
            result => return Ok(result.map_err(|e| failed(&e))?),
        }
    }
}

pub(super) fn prepare_scan(
    path: &Path,
    reading: Reading,
    preparing: &Preparing,
    on: &mut Processor,
) -> Result<PreparedShape, Failure> {
    preparing.check()?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut progress = Progress::silent();
    progress.at(Stage::Read, 0.0)?;
    let shape = read_scan(path, reading)?;
    Ok(pollster::block_on(on.prepare(shape, name, &preparing.options(), &mut progress))
        .map_err(|e| format!("{}: {e}", path.display()))?)
}

/// Whether a path leads to a file in the same folder or further in.
fn is_beside(path: &str) -> bool {
    !path.is_empty()
        && Path::new(path).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
