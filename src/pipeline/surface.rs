//! Which points of a scan carry its surface, and as what they are taken: a mesh, or a cloud.

use super::{FaceUse, PrepareOptions};
use crate::shape::{Aside, Repair, Resampled, Shape, Shells, counted, shells, without_spikes};

/// The surface of a scan.
pub(super) struct Surface {
    /// The scan as it is used: its faces welded, or without faces; with points between the uploaded ones where it was sampled anew.
    pub(super) shape: Shape,
    /// Where the points and faces of that are not the uploaded ones.
    pub(super) resampled: Option<Resampled>,
    /// Points on it: of a mesh those that belong to a face, of a cloud one at each place, because copies would take the places of neighbours.
    pub(super) points: Vec<u32>,
}

impl Surface {
    /// Without the points `aside`.
    pub(super) fn of(as_read: &Shape, aside: &Aside, options: &PrepareOptions, repairs: &mut Vec<Repair>) -> Self {
        let shape = used_as(as_read, options.faces, repairs);
        let stays = |i: &u32| aside.leaves(*i);
        if shape.faces().is_empty() {
            let is_first =
                |&i: &u32| shape.first_at_place()[i as usize] == i && shape.placeless().binary_search(&i).is_err();
            let points = (0..shape.points().len() as u32).filter(is_first).filter(stays).collect();
            return Self { shape, resampled: None, points };
        }
        let mut left = Left { shape, resampled: None };
        let mut faces = left.shape.faces().to_vec();
        faces.retain(|face| face.iter().all(stays));
        if faces.len() < left.shape.faces().len() {
            left.take(faces);
        }
        if let Some(faces) = without_spikes(&left.shape) {
            let cut = left.shape.faces().len() - faces.len();
            let message = format!(
                "{} off the surface, as spikes to points that were measured wrongly and curtains between what is in front and what is behind do; left out",
                counted(cut, "face leads", "faces lead")
            );
            repairs.push(Repair::noted("spikes-cut", cut, message));
            left.take(faces);
        }
        let Left { shape, resampled } = left;
        if options.laplacian.is_none()
            && let Some(Shells { surface, count, largest, .. }) = shells(&shape, options.points)
        {
            let message = format!(
                "the mesh is put together from {count} shells, of which the largest has {:.0} % of the area: taken as one body by how near they lie, like a cloud of points on all of them",
                100.0 * largest
            );
            repairs.push(Repair::noted("shells-joined", count, message));
            let points = surface.shape.points_in_faces();
            return Self { shape: surface.shape.clone().without_faces(), resampled: Some(surface), points };
        }
        let points = shape.points_in_faces();
        Self { shape, resampled, points }
    }
}

/// What is left of a mesh.
struct Left {
    shape: Shape,
    resampled: Option<Resampled>,
}

impl Left {
    /// These faces and no others.
    fn take(&mut self, faces: Vec<[u32; 3]>) {
        let left = Resampled::without_added(&self.shape, faces);
        self.shape = left.shape.clone();
        self.resampled = Some(left);
    }
}

/// A scan with its faces welded, or as a cloud where it was asked for or hardly a point is in a face.
pub(super) fn used_as(as_read: &Shape, faces: FaceUse, repairs: &mut Vec<Repair>) -> Shape {
    if as_read.faces().is_empty() {
        return as_read.clone();
    }
    let placed = as_read.points().len() - as_read.placeless().len();
    let in_faces = as_read.points_in_faces().len();
    match faces {
        FaceUse::Use if 2 * in_faces >= placed => as_read.welded(),
        FaceUse::Use => {
            let message = format!("only {in_faces} of {placed} points belong to a face: the scan was taken as a cloud");
            repairs.push(Repair::noted("faces-set-aside", as_read.faces().len(), message));
            as_read.clone().without_faces()
        }
        FaceUse::Ignore => as_read.clone().without_faces(),
    }
}
