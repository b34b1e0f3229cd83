//! Faces of any number of corners, cut into triangles as they come.

use super::error::{Place, ReadError};
use crate::shape::{Repair, counted};

/// Collects the triangles of a file's polygons. Corners may name points that come later in the file, so what looks worst is
/// remembered with its place and judged at the end.
pub(super) struct Polygons {
    format: &'static str,
    /// What the format calls its first point.
    first: u8,
    triangles: Vec<[u32; 3]>,
    polygons: usize,
    cut: usize,
    short: usize,
    /// The largest index so far; one that can never be right (negative, beyond u32) stays.
    worst: Option<(i64, usize, Place)>,
}

impl Polygons {
    /// For `format`, whose first point is called `first`.
    pub fn new(format: &'static str, first: u8) -> Self {
        Self { format, first, triangles: Vec::new(), polygons: 0, cut: 0, short: 0, worst: None }
    }

    /// Makes room for `triangles`, a number already bounded by the bytes at hand.
    pub fn reserve(&mut self, triangles: usize) {
        self.triangles.reserve(triangles);
    }

    /// Polygons seen so far, which is the 0-based number of the next one.
    pub fn seen(&self) -> usize {
        self.polygons
    }

    /// One polygon of 0-based `corners`, cut as a fan around its first corner. Fewer than three corners are counted and left out.
    pub fn push(&mut self, corners: &[i64], at: Place) {
        let face = self.polygons;
        self.polygons += 1;
        let impossible = |index: i64| u32::try_from(index).is_err();
        for &index in corners {
            let worse = match self.worst {
                None => true,
                Some((worst, ..)) => !impossible(worst) && (impossible(index) || index > worst),
            };
            if worse {
                self.worst = Some((index, face, at.clone()));
            }
        }
        let &[hub, ref rim @ ..] = corners else {
            self.short += 1;
            return;
        };
        match rim.len() {
            0 | 1 => self.short += 1,
            2 => {}
            _ => self.cut += 1,
        }
        // An index that does not fit is in `worst`, and no triangle leaves `finish` then.
        self.triangles.extend(rim.windows(2).map(|side| [hub as u32, side[0] as u32, side[1] as u32]));
    }

    /// The triangles and what was done to get them, once the number of points is known.
    pub fn finish(self, points: usize) -> Result<(Vec<[u32; 3]>, Vec<Repair>), ReadError> {
        let Self { format, first, .. } = self;
        if let Some((index, face, at)) = self.worst.filter(|(i, ..)| usize::try_from(*i).map_or(true, |i| i >= points))
        {
            let index = index.saturating_add(i64::from(first));
            return Err(ReadError::FaceIndex { format, face, index, points, first, at });
        }
        let cut = Repair::counted("polygons-triangulated", self.cut, || {
            format!("{} with more than three corners cut into triangles", counted(self.cut, "face", "faces"))
        });
        let short = Repair::counted("short-faces", self.short, || {
            format!("{} with fewer than three corners left out", counted(self.short, "face", "faces"))
        });
        Ok((self.triangles, cut.into_iter().chain(short).collect()))
    }
}
