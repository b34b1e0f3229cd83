//! How much memory a file may take: a few kilobytes of instances can name the same data a million times, compressed zeros hardly take a byte, and so do empty
//! objects of a document.

use super::container::GLTF;
use crate::read::error::ReadError;
use crate::shape::memory;

/// Bytes that may be held at one time for each byte of a file. With two faces to a point a mesh is held in 101 bytes a point, or 132 if all its faces lay apart. In a
/// file it takes 18 to 36, and compressed by gltfpack 4 to 11 if it is a body, 2.8 if it is a flat grid of ten bits, without anything that is not read.
const PER_BYTE: usize = 64;
/// Bytes that a file of any size may take, as one may that draws a small mesh a thousand times: some 250 000 points with two faces to each.
const ANY: usize = 32 << 20;

/// Points of morph targets that are read, which takes time, for each point of a mesh that a file of its size may have.
const TARGETS: usize = 8;

/// Bytes of a point in a draft.
const POINT: usize = size_of::<[f64; 3]>();
/// And of a face.
const FACE: usize = size_of::<[u32; 3]>();

/// What a file is about to take, before it does.
pub(super) struct Budget {
    limit: usize,
    /// Bytes held while meshes are read: the document, and what is decompressed.
    beside: usize,
    points: usize,
    faces: usize,
    /// Points of morph targets read so far.
    targets: usize,
}

impl Budget {
    /// For so many bytes of a document and its data.
    pub fn of(bytes: usize) -> Self {
        Self { limit: ANY.max(bytes.saturating_mul(PER_BYTE)), beside: 0, points: 0, faces: 0, targets: 0 }
    }

    /// So many bytes will be held until all meshes are read.
    pub fn hold(&mut self, bytes: usize) -> Result<(), ReadError> {
        self.beside = self.beside.saturating_add(bytes);
        self.check()
    }

    /// So many points and faces will be read.
    pub fn draw(&mut self, points: usize, faces: usize) -> Result<(), ReadError> {
        (self.points, self.faces) = (self.points.saturating_add(points), self.faces.saturating_add(faces));
        self.check()
    }

    /// So many points of a morph target are read.
    pub fn target(&mut self, points: usize) -> Result<(), ReadError> {
        let limit = TARGETS * (self.limit / memory(1, 2));
        self.targets = self.targets.saturating_add(points);
        if self.targets > limit {
            return Err(ReadError::TooLarge { format: GLTF, what: "points of morph targets", limit });
        }
        Ok(())
    }

    fn check(&self) -> Result<(), ReadError> {
        let draft = self.points.saturating_mul(POINT).saturating_add(self.faces.saturating_mul(FACE));
        let reading = self.beside.saturating_add(draft);
        if reading.max(memory(self.points, self.faces)) > self.limit {
            return Err(ReadError::TooLarge { format: GLTF, what: "bytes in memory", limit: self.limit });
        }
        Ok(())
    }
}
