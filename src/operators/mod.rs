//! Laplacians and mass, for meshes by cotangents, for clouds by Algorithm 1 of the paper; normals and gradients of both.

mod builder;
mod cloud;
mod cotangent;
mod error;
mod frames;
mod gradient;
mod intrinsic;
mod laplacian;
mod mass;
mod neighbourhood;
mod normals;
mod quadrics;

use crate::progress::Progress;
use crate::shape::Shape;

pub use builder::{LaplacianBuilder, Mass};
pub use cotangent::cotangent_laplacian;
pub use error::OperatorError;
pub use frames::Frame;
pub use gradient::{Gradient, gradient};
pub use laplacian::{Laplacian, LaplacianKind};
pub use neighbourhood::Neighbourhood;
pub use normals::normals;
pub use quadrics::EdgeFilter;

pub(crate) use gradient::gradient_around;

/// Cotangents where there are faces, else the geodesic Laplacian.
pub fn default_kind(shape: &Shape) -> LaplacianKind {
    if shape.faces().is_empty() { LaplacianKind::Geodesic } else { LaplacianKind::Cotangent }
}

/// Surface area in unit²: the mass of `laplacian` where that is one, else measured or, on a cloud, estimated from the `neighbourhood` of its points.
pub fn surface_area(shape: &Shape, laplacian: &Laplacian, neighbourhood: &Neighbourhood) -> f64 {
    match (laplacian.kind.has_unit_mass(), shape.faces().is_empty()) {
        (true, true) => neighbourhood.mass().iter().sum(),
        (true, false) => shape.surface_area(),
        _ => laplacian.area(),
    }
}

/// The Laplacian of a shape, all points counting, in the unit of its points, with the parameters of the paper. The faces of a mesh meet wherever
/// their corners lie at exactly one place; of the points there, the first has the mass and the entries.
pub fn laplacian(shape: &Shape, kind: LaplacianKind, progress: &mut Progress) -> Result<Laplacian, OperatorError> {
    LaplacianBuilder::new(kind).build(shape, progress)
}
