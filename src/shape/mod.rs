//! A scan, validated once: points, optional triangles, optional part labels.

mod axis;
mod closed;
mod error;
mod faces;
mod orientation;
mod outliers;
mod placeless;
mod planes;
mod repair;
mod resampled;
mod sample;
mod scene;
mod shells;
mod simplify;
mod spikes;
mod spread;
mod steps;
mod strays;
mod support;
mod weld;

use std::sync::OnceLock;

use crate::vector::{cross, minus, norm};

pub use axis::Axis;
pub use error::ShapeError;
pub use repair::Repair;
pub use resampled::{Resampled, resampled};
pub use sample::{farthest_points, nearest_samples};
pub use scene::{Aside, LeftOut, Proposal, proposals};
pub use shells::{Shells, loose_pieces, shells};
#[cfg(feature = "train")]
pub use simplify::{Simplified, draw_together};
pub use simplify::{THIN_LIMIT, cells, simplify};
pub use spikes::without_spikes;
pub use steps::{COARSE_NUMBERS, coarse_steps};
pub use strays::{Strays, set_strays_aside, thin_parts};
pub use support::{MESH_LIMIT, Support, support};

pub(crate) use closed::{has_borders, is_closed};
pub(crate) use repair::counted;

use weld::{first_at_place, joined, weld, welded};

/// Fewest points a shape may have (below it no spectrum worth the name exists).
pub const MIN_POINTS: usize = 50;

/// Most points a shape may have: an edge is packed into one word as two 31-bit indices and a direction.
pub const MAX_POINTS: usize = 1 << 31;

/// Bytes that [`Shape::new`] holds at one time for so many points and faces, these included, at most: that is where faces meet nowhere, and each corner is at a border.
pub(crate) fn memory(points: usize, faces: usize) -> usize {
    let [n, m] = [points, faces].map(|count| count as f64);
    let border = n.min(3.0 * m);
    // Points, faces, and the first point at each place.
    let always = 28.0 * n + 12.0 * m;
    // In turn: pieces without area, sides of faces and what is at borders, seams there.
    let most = [13.0 * n, n + 24.0 * m + 12.0 * border, 8.0 * n + 72.0 * border].into_iter().fold(0.0, f64::max);
    (always + most) as usize
}

/// A mesh (`faces` not empty) or a point cloud. Points keep the order and the number they were uploaded
/// with: index `i` here is index `i` for the user, whatever was repaired.
#[derive(Clone, Debug)]
pub struct Shape {
    points: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    labels: Option<Vec<u32>>,
    repairs: Vec<Repair>,
    up: Option<Axis>,
    /// Points whose coordinates are no numbers, ascending. They lie where the first point lies that has a place.
    placeless: Vec<u32>,
    /// For each point the first one that is the same point of the surface, found when it is first asked for.
    first: OnceLock<Vec<u32>>,
}

impl PartialEq for Shape {
    fn eq(&self, other: &Self) -> bool {
        let all = |shape: &Self| (shape.labels.clone(), shape.repairs.clone(), shape.up, shape.placeless.clone());
        self.points == other.points && self.faces == other.faces && all(self) == all(other)
    }
}

impl Shape {
    /// Validates and, where that is safe, repairs. `faces` may be empty (a cloud); `labels`, if given, has one entry per point.
    ///
    /// Faces that name a point twice are dropped, and pieces without any area; everything else that is odd is kept. Points of no face whose coordinates are no
    /// numbers are [placeless](Shape::placeless). All is reported in [`Shape::repairs`].
    pub fn new(points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, labels: Option<Vec<u32>>) -> Result<Self, ShapeError> {
        Self::with_repairs(points, faces, labels, Vec::new())
    }

    /// The same from flat arrays: `positions` holds x y z per point, `faces` three indices per triangle.
    pub fn from_arrays(positions: &[f64], faces: &[u32], labels: Option<&[u32]>) -> Result<Self, ShapeError> {
        let (points, rest) = positions.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(ShapeError::RaggedArray { array: "positions", length: positions.len() });
        }
        let (triangles, rest) = faces.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(ShapeError::RaggedArray { array: "faces", length: faces.len() });
        }
        Self::new(points.to_vec(), triangles.to_vec(), labels.map(<[u32]>::to_vec))
    }

    /// As [`Shape::new`], after `repairs` that a reader already had to make.
    pub(crate) fn with_repairs(
        mut points: Vec<[f64; 3]>,
        mut faces: Vec<[u32; 3]>,
        labels: Option<Vec<u32>>,
        mut repairs: Vec<Repair>,
    ) -> Result<Self, ShapeError> {
        if points.len() < MIN_POINTS {
            return Err(ShapeError::TooFewPoints { found: points.len(), needed: MIN_POINTS });
        }
        if points.len() > MAX_POINTS {
            return Err(ShapeError::TooManyPoints { found: points.len(), limit: MAX_POINTS });
        }
        if let Some(labels) = labels.as_ref().filter(|l| l.len() != points.len()) {
            return Err(ShapeError::LabelCount { labels: labels.len(), points: points.len() });
        }
        faces::check_indices(&faces, points.len())?;
        let placeless = placeless::give_places(&mut points, &faces, &mut repairs)?;
        let found = points.len() - placeless.len();
        if found < MIN_POINTS {
            return Err(ShapeError::TooFewPoints { found, needed: MIN_POINTS });
        }
        repairs.extend(spread::check(&points)?);
        repairs.extend(steps::notice(&points));
        let first = first_at_place(&points);
        let soup = faces::share_no_corner(&faces, points.len());
        faces::drop_degenerate(&points, &first, &mut faces, &mut repairs);
        let copies = first.iter().enumerate().filter(|&(i, &first)| i != first as usize).count();
        let duplicates = copies - placeless.len();
        repairs.extend(Repair::counted(if soup { "corners-joined" } else { "duplicate-points" }, duplicates, || {
            if soup {
                return format!(
                    "{duplicates} of the {} corners of loose triangles lie exactly where another one is; the triangles there \
                     taken as joined, and every corner kept",
                    points.len()
                );
            }
            let met = if faces.is_empty() { "kept as they are" } else { "kept, and the faces there taken as joined" };
            format!("{} exactly where another one is; {met}", counted(duplicates, "point lies", "points lie"))
        }));
        let (first, seams) = joined(&points, &faces, first);
        repairs.extend(Repair::counted("seams-joined", seams, || {
            format!(
                "{} at open borders so close to another one that rounding must have parted them; the faces there taken as joined",
                counted(seams, "point lies", "points lie")
            )
        }));
        faces::notice_bare_points(points.len(), &faces, &placeless, &mut repairs);
        if !faces.is_empty() {
            faces::notice_topology(points.len(), welded(&faces, &first), &mut repairs);
        }
        let shape = Self { points, faces, labels, repairs, up: None, placeless, first: OnceLock::new() };
        Ok(shape)
    }

    /// Positions (n, 3) in the unit of the upload.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Triangles (m, 3); empty for a cloud.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Part label per point, as given.
    pub fn labels(&self) -> Option<&[u32]> {
        self.labels.as_deref()
    }

    /// The axis that points up by the rules of the file's format; most formats have none.
    pub fn up(&self) -> Option<Axis> {
        self.up
    }

    /// The same shape with the axis that its format says is up.
    pub(crate) fn standing(self, up: Axis) -> Self {
        Self { up: Some(up), ..self }
    }

    /// What was changed, set aside or noticed on the way in.
    pub fn repairs(&self) -> &[Repair] {
        &self.repairs
    }

    /// The given points as a shape of their own, with `faces` over them.
    pub(crate) fn at(&self, samples: &[u32], faces: Vec<[u32; 3]>) -> Self {
        Self::already_valid(samples.iter().map(|&i| self.points[i as usize]).collect(), faces, None)
    }

    /// The same points with the faces between some of them.
    pub(crate) fn with_faces_among(&self, points: &[u32]) -> Self {
        let mut among = vec![false; self.points.len()];
        points.iter().for_each(|&i| among[i as usize] = true);
        let mut shape = self.clone();
        shape.faces.retain(|face| face.iter().all(|&i| among[i as usize]));
        shape
    }

    /// Points, ascending, whose coordinates were no numbers (NaN or infinite), as in the empty rows of an organised cloud. No match names them; in
    /// [`points`](Self::points) they lie where the first point lies that has a place.
    pub fn placeless(&self) -> &[u32] {
        &self.placeless
    }

    /// The same shape, of which these points have no place.
    pub(crate) fn with_placeless(self, placeless: Vec<u32>) -> Self {
        Self { placeless, first: OnceLock::new(), ..self }
    }

    /// For each point (n) the first one that is the same point of the surface: at exactly its place, or of a mesh across a seam.
    pub(crate) fn first_at_place(&self) -> &[u32] {
        self.first.get_or_init(|| {
            let (mut first, _) = joined(&self.points, &self.faces, first_at_place(&self.points));
            // Points without a place lie where the first other one does, and are nobody's copies, nor is it theirs.
            let placeless = |i: &u32| self.placeless.binary_search(i).is_ok();
            if let Some(placed) = (0..first.len() as u32).find(|i| !placeless(i)).filter(|_| !self.placeless.is_empty())
            {
                first.iter_mut().filter(|first| placeless(first)).for_each(|first| *first = placed);
                self.placeless.iter().for_each(|&i| first[i as usize] = i);
            }
            first
        })
    }

    /// The same surface with faces that meet wherever their corners are one point, as the split vertices at the seams of textured meshes and of triangle soup are:
    /// every corner becomes the first of these. Points stay as they are.
    pub(crate) fn welded(&self) -> Self {
        Self { faces: self.welded_faces(), first: OnceLock::from(self.first_at_place().to_vec()), ..self.clone() }
    }

    /// The faces of [`Shape::welded`].
    pub(crate) fn welded_faces(&self) -> Vec<[u32; 3]> {
        weld(&self.faces, self.first_at_place())
    }

    /// From tables that came out of a valid shape.
    pub(crate) fn already_valid(points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, labels: Option<Vec<u32>>) -> Self {
        let (repairs, placeless, first) = (Vec::new(), Vec::new(), OnceLock::new());
        Self { points, faces, labels, repairs, up: None, placeless, first }
    }

    /// Turns faces until all that meet at an edge of two agree about which side is outside, as far as the surface allows; says what it did.
    pub(crate) fn wind_alike(&mut self) -> Vec<Repair> {
        let welded = self.welded_faces();
        if faces::agree(&welded) {
            return Vec::new();
        }
        let (faces, turned, contradicting) = orientation::wound_alike(&welded);
        let mut repairs = Vec::new();
        repairs.extend(Repair::counted("faces-reoriented", turned, || {
            let faces = counted(turned, "face was", "faces were");
            format!("{faces} taken as wound the other way, so that neighbours agree about the outside; in the scan they stay as they are")
        }));
        repairs.extend(Repair::counted("no-outside", contradicting, || {
            let edges = counted(contradicting, "edge", "edges");
            format!(
                "along {edges} faces cannot be made to agree about the outside: the surface has none, so the scan is \
                 registered, and its matches trusted, as those of a cloud"
            )
        }));
        self.faces = faces;
        repairs
    }

    /// Whether no two faces disagree about which side is outside.
    pub(crate) fn faces_agree(&self) -> bool {
        faces::agree(&self.faces)
    }

    /// Points that belong to a face, ascending.
    pub(crate) fn points_in_faces(&self) -> Vec<u32> {
        let used = faces::used(self.points.len(), self.faces.iter().copied());
        (0..used.len() as u32).filter(|&i| used[i as usize]).collect()
    }

    /// Sum of the triangle areas, in unit²; 0 for a cloud.
    pub fn surface_area(&self) -> f64 {
        0.5 * self.faces.iter().map(|&face| 2.0 * self.face_area(face)).sum::<f64>()
    }

    /// Area of a triangle between three points, in unit².
    pub(crate) fn face_area(&self, face: [u32; 3]) -> f64 {
        let [a, b, c] = face.map(|i| self.points[i as usize]);
        0.5 * norm(cross(minus(b, a), minus(c, a)))
    }

    /// The same points without their faces. What was said about the upload stays said.
    pub fn without_faces(mut self) -> Self {
        self.faces.clear();
        self.first = OnceLock::new();
        self
    }
}
