//! Which points of a scan carry its basis, which take part in matching, and how every uploaded point finds both.

use super::{Shape, cells, farthest_points, simplify};
use crate::progress::Cancelled;

/// Meshes of more vertices get the basis of a simplified mesh.
pub const MESH_LIMIT: usize = 30_000;
/// Vertices of a simplified mesh, or as many as are to take part where these are more: three times the default, so that the basis is finer than their spacing.
const SIMPLIFIED: usize = 15_000;

/// From uploaded points to the rows of the basis ("carriers", c of them), and from those to the points used (p of them).
/// `None` stands for "all, in order".
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Support {
    /// Uploaded index of each carrier (c).
    pub carriers: Option<Vec<u32>>,
    /// Carrier that stands for each uploaded point (n).
    pub carrier_of: Option<Vec<u32>>,
    /// Carrier that is each point used (p).
    pub used: Option<Vec<u32>>,
    /// Point used that stands for each carrier (c).
    pub used_of: Option<Vec<u32>>,
    /// Uploaded points that no carrier can stand for: they stay unmatched.
    pub unmatched: Option<Vec<u32>>,
}

impl Support {
    /// Uploaded index of a point used.
    pub fn uploaded(&self, row: usize) -> usize {
        let carrier = self.used.as_ref().map_or(row, |used| used[row] as usize);
        self.carriers.as_ref().map_or(carrier, |carriers| carriers[carrier] as usize)
    }

    /// The point used that stands for an uploaded point.
    pub fn row_of(&self, uploaded: usize) -> usize {
        let carrier = self.carrier_of.as_ref().map_or(uploaded, |of| of[uploaded] as usize);
        self.row_of_carrier(carrier)
    }

    /// The point used that stands for a carrier.
    pub fn row_of_carrier(&self, carrier: usize) -> usize {
        self.used_of.as_ref().map_or(carrier, |of| of[carrier] as usize)
    }

    /// Points used among `n` uploaded ones.
    pub fn points_used(&self, n: usize) -> usize {
        self.used.as_ref().or(self.carriers.as_ref()).map_or(n, Vec::len)
    }
}

/// The support of `shape` and the shape its operator is built on, point by point the carriers. `surface` are the points that count, `count`
/// how many are to be used; up to 1.5 times as many are used without sampling. On a mesh that keeps its mesh operator (`on_mesh`) the carriers are
/// its vertices, or those of a simplified mesh; else they are the points used themselves. Third, how many points a simplified mesh was too coarse for.
pub fn support(
    shape: &Shape,
    surface: Vec<u32>,
    count: usize,
    on_mesh: bool,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<(Support, Shape, usize), Cancelled> {
    // What was set aside joins nothing.
    let shape = &shape.with_faces_among(&surface);
    let whole = surface.len() <= count + count / 2;
    let (mut support, mut lost) = (Support::default(), 0);
    if !whole && !on_mesh {
        let carriers = farthest_points(shape.points(), &surface, count, report)?;
        let operator = shape.at(&carriers, Vec::new());
        support.carrier_of = Some(cells(shape, &carriers));
        support.carriers = Some(carriers);
        return Ok((support, operator, lost));
    }
    let operator = if surface.len() > MESH_LIMIT && on_mesh {
        let (simplified, too_thin) = simplify(shape, &surface, SIMPLIFIED.max(count), report)?;
        let operator = shape.at(&simplified.vertices, simplified.faces);
        (support.carriers, support.carrier_of) = (Some(simplified.vertices), Some(simplified.cell));
        lost = too_thin;
        operator
    } else if surface.len() < shape.points().len() {
        let mut row = vec![0; shape.points().len()];
        surface.iter().zip(0..).for_each(|(&i, r)| row[i as usize] = r);
        let faces = shape.faces().iter().map(|face| face.map(|i| row[i as usize])).collect();
        let operator = shape.at(&surface, faces);
        support.carrier_of = Some(cells(shape, &surface));
        support.carriers = Some(surface);
        operator
    } else {
        shape.clone()
    };
    if !whole {
        let all: Vec<u32> = (0..operator.points().len() as u32).collect();
        let used = farthest_points(operator.points(), &all, count, report)?;
        support.used_of = Some(cells(&operator, &used));
        support.used = Some(used);
    }
    Ok((support, operator, lost))
}
