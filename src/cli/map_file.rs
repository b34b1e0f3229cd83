//! A map as a file: CSV, JSON, or the bodies in colours that correspond.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::arguments::{Failure, write};
use super::colour::correspondence_colours;
use crate::maps::UNMATCHED;
use crate::network::WeightsId;
use crate::pipeline::{DeviceKind, ShapeKind};
use crate::pipeline::{Match, MatchOptions, PrepareOptions, PreparedShape, Scale, Warning};
use crate::shape::Repair;
use crate::write::{Body, LinearRgb, glb, ply};

/// Says before the work that the folder of `file` is none.
pub(super) fn check_folder(file: &Path) -> Result<(), Failure> {
    match file.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
        Some(folder) => Err(format!("{} is no folder: nothing can be written there", folder.display()).into()),
        None => Ok(()),
    }
}

/// Where a map goes, and as what.
#[derive(Clone, Debug)]
pub(super) struct MapFile {
    path: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Csv,
    Json,
    Ply,
    Glb,
}

/// A match with what it was made from.
pub(super) struct Outcome<'a> {
    pub a: &'a PreparedShape,
    pub b: &'a PreparedShape,
    pub preparing: &'a PrepareOptions,
    pub options: &'a MatchOptions,
    pub matched: &'a Match,
}

impl MapFile {
    /// The kind is that of the path's extension.
    pub(super) fn parse(path: &str) -> Result<Self, String> {
        let path = PathBuf::from(path);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let kind = match extension.as_str() {
            "csv" => Kind::Csv,
            "json" => Kind::Json,
            "ply" => Kind::Ply,
            "glb" => Kind::Glb,
            _ => return Err("a map is written as .csv, .json, .ply or .glb; choose one of these extensions".to_owned()),
        };
        Ok(Self { path, kind })
    }

    /// Says before the work that there is no folder to write to, or that one of the `scans` would be written over.
    pub(super) fn check(&self, scans: &[&Path]) -> Result<(), Failure> {
        check_folder(&self.path)?;
        let second = match self.kind {
            Kind::Ply => Some("b.ply"),
            Kind::Glb => Some("b.glb"),
            Kind::Csv | Kind::Json => None,
        };
        let written = [Some(self.path.clone()), second.map(|extension| self.path.with_extension(extension))];
        for file in written.into_iter().flatten() {
            let place = file.canonicalize();
            if place.is_ok_and(|place| scans.iter().any(|scan| scan.canonicalize().is_ok_and(|scan| scan == place))) {
                return Err(format!(
                    "{} is one of the scans, and would be written over: choose another name",
                    file.display()
                )
                .into());
            }
        }
        Ok(())
    }

    /// Writes the map. Bodies are two files, of which the second has `.b` before its extension.
    pub(super) fn write(&self, outcome: &Outcome) -> Result<(), Failure> {
        match self.kind {
            Kind::Csv => write(&self.path, csv(outcome.matched)?),
            Kind::Json => write(&self.path, json(outcome)?),
            Kind::Ply => self.write_bodies(outcome, "b.ply", |body, colours| Ok(ply(&written(body), colours))),
            Kind::Glb => self.write_bodies(outcome, "b.glb", |body, colours| {
                glb(&written(body), colours).ok_or_else(|| "the scan is too large for a GLB; write PLY instead".into())
            }),
        }
    }

    fn write_bodies(
        &self,
        &Outcome { a, b, matched, .. }: &Outcome,
        extension_of_b: &str,
        file: impl Fn(&PreparedShape, &[LinearRgb]) -> Result<Vec<u8>, Failure>,
    ) -> Result<(), Failure> {
        let [on_a, on_b] = correspondence_colours(matched, b);
        write(&self.path, file(a, &on_a)?)?;
        write(&self.path.with_extension(extension_of_b), file(b, &on_b)?)
    }
}

/// A scan as it is written.
fn written(scan: &PreparedShape) -> Body<'_> {
    let info = &scan.info;
    let (name, unit) = (info.name.as_deref(), info.unit.as_deref());
    Body { shape: &scan.shape, name, unit, up: info.up_axis, scale: info.scale }
}

/// One line per point of A: `source,target,confidence`, the target left empty where there is none.
fn csv(matched: &Match) -> Result<String, Failure> {
    let mut text = String::from("source,target,confidence\n");
    for (source, (&target, confidence)) in matched.a_to_b.target.iter().zip(&matched.a_to_b.confidence).enumerate() {
        match target {
            UNMATCHED => writeln!(text, "{source},,0")?,
            target => writeln!(text, "{source},{target},{confidence}")?,
        }
    }
    Ok(text)
}

/// The fields of the page's JSON export (`www/src/exports/map-table.ts`); `target` is null where there is none.
#[derive(Serialize)]
struct Document<'a> {
    a: Scan<'a>,
    b: Scan<'a>,
    #[serde(rename = "match")]
    how: How<'a>,
    map: Vec<Line>,
}

#[derive(Serialize)]
struct Scan<'a> {
    name: Option<&'a str>,
    points: usize,
    kind: ShapeKind,
    prepared: &'a PrepareOptions,
    repairs: &'a [Repair],
}

impl<'a> Scan<'a> {
    fn of(PreparedShape { info, repairs, .. }: &'a PreparedShape, prepared: &'a PrepareOptions) -> Self {
        Self { name: info.name.as_deref(), points: info.points, kind: info.kind, prepared, repairs }
    }
}

#[derive(Serialize)]
struct How<'a> {
    #[serde(flatten)]
    options: &'a MatchOptions,
    device: DeviceKind,
    weights: Option<Named<'a>>,
    category: Option<&'a str>,
    scale: Scale,
    warnings: &'a [Warning],
}

#[derive(Serialize)]
struct Named<'a> {
    name: &'a str,
    version: &'a str,
}

impl<'a> Named<'a> {
    fn of(WeightsId { name, version, .. }: &'a WeightsId) -> Self {
        Self { name, version }
    }
}

#[derive(Serialize)]
struct Line {
    source: usize,
    target: Option<u32>,
    confidence: f32,
    overlap: f32,
}

fn json(Outcome { a, b, preparing, options, matched }: &Outcome) -> Result<Vec<u8>, Failure> {
    let pairs = matched.a_to_b.target.iter().zip(&matched.a_to_b.confidence).zip(&matched.overlap[0]);
    let line = |(source, ((&target, &confidence), &overlap)): (usize, ((&u32, &f32), &f32))| Line {
        source,
        overlap,
        target: Some(target).filter(|&target| target != UNMATCHED),
        confidence,
    };
    let document = Document {
        a: Scan::of(a, preparing),
        b: Scan::of(b, preparing),
        how: How {
            options,
            device: matched.device,
            weights: matched.weights.as_ref().map(Named::of),
            category: matched.category.as_deref(),
            scale: matched.scale,
            warnings: &matched.warnings,
        },
        map: pairs.enumerate().map(line).collect(),
    };
    Ok(serde_json::to_vec(&document)?)
}
