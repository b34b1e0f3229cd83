//! Writes a set in the layout that `evaluate` reads.

use std::fmt::{Display, Write};
use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::samples::SampleError;
use super::write::write_off;
use super::{BodyModel, Template};

/// A set in the making.
pub struct Layout {
    out: PathBuf,
}

impl Layout {
    /// In `out`, made if missing.
    pub fn new(out: &Path, folders: &[&str]) -> Result<Self, SampleError> {
        for folder in ["shapes", "corres", "labels"].iter().chain(folders) {
            let path = out.join(folder);
            fs::create_dir_all(&path).map_err(|source| SampleError::Write { path, source })?;
        }
        Ok(Self { out: out.to_owned() })
    }

    /// Any file.
    pub fn save(&self, name: &str, bytes: Vec<u8>) -> Result<(), SampleError> {
        let path = self.out.join(name);
        fs::write(&path, bytes).map_err(|source| SampleError::Write { path, source })
    }

    /// A file of one row a line.
    pub fn lines(&self, name: &str, rows: &[impl Display]) -> Result<(), SampleError> {
        let mut text = String::new();
        rows.iter().for_each(|row| writeln!(text, "{row}").expect("writing to memory does not fail"));
        self.save(name, text.into_bytes())
    }

    /// A shape with its labels and truth.
    pub fn shape(
        &self,
        name: &str,
        shape: &Labelled,
        model: &BodyModel,
        template: &Template,
    ) -> Result<(), SampleError> {
        let mut off = Vec::new();
        write_off(&mut off, &shape.points, &shape.triangles).expect("writing to memory does not fail");
        self.save(&format!("shapes/{name}.off"), off)?;
        self.lines(&format!("labels/{name}.txt"), &shape.labels)?;
        // 1-based, 0 where there is none.
        let at = |v: u32| shape.seen[v as usize].map_or(0, |point| point + 1);
        let truth: Vec<u32> = template.vertices.iter().map(|&v| at(v)).collect();
        let mirrored: Vec<u32> = template.vertices.iter().map(|&v| at(model.mirror[v as usize])).collect();
        self.lines(&format!("corres/{name}.vts"), &truth)?;
        self.lines(&format!("corres/{name}.sym.vts"), &mirrored)
    }
}

/// A shape of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    /// Metres.
    pub points: Vec<DVec3>,
    /// None on a cloud.
    pub triangles: Vec<[u32; 3]>,
    /// A part each.
    pub labels: Vec<u32>,
    /// For each vertex of the skin the point that stands for it, if there is one.
    pub seen: Vec<Option<u32>>,
}
