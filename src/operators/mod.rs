//! Laplacians and mass, for meshes by cotangents, for clouds by Algorithm 1 of the paper; normals and gradients of both.

mod cotangent;
mod frames;
mod geodesic;
mod gradient;
mod intrinsic;
mod laplacian;
mod mass;
mod normals;
mod quadrics;

use crate::graph::{RefineParams, nearest_neighbours, refine};
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::Shape;

pub use cotangent::cotangent_laplacian;
pub use frames::Frame;
pub use geodesic::{GaussianParams, gaussian_laplacian, literal_laplacian};
pub use gradient::{Gradient, gradient};
pub use laplacian::{Laplacian, LaplacianKind};
pub use mass::cloud_mass;
pub use normals::normals;
pub use quadrics::{EdgeFilter, Quadrics};

/// Why no Laplacian could be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OperatorError {
    /// Cotangents need triangles.
    #[error("a cotangent Laplacian needs faces, and this scan is a point cloud: choose the geodesic one")]
    NeedsFaces,
    /// The listener asked for a stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl OperatorError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        match self {
            OperatorError::NeedsFaces => "needs-faces",
            OperatorError::Cancelled(_) => "cancelled",
        }
    }
}

/// Cotangents where there are faces, else the geodesic Laplacian.
pub fn default_kind(shape: &Shape) -> LaplacianKind {
    if shape.faces().is_empty() { LaplacianKind::Geodesic } else { LaplacianKind::Cotangent }
}

/// Surface area in unit²: the mass of `laplacian` where that is one, else measured or, on a cloud, estimated.
pub fn surface_area(shape: &Shape, laplacian: &Laplacian) -> f64 {
    match (laplacian.kind, shape.faces().is_empty()) {
        (LaplacianKind::GeodesicLiteral, true) => {
            let neighbours = nearest_neighbours(shape.points(), GaussianParams::default().neighbours);
            cloud_mass(shape.points(), &neighbours).iter().sum()
        }
        (LaplacianKind::GeodesicLiteral, false) => shape.surface_area(),
        _ => laplacian.area(),
    }
}

/// The Laplacian of a shape, all points counting, in the unit of its points. The faces of a mesh meet wherever their corners lie at exactly
/// one place; of the points there, the first has the mass and the entries.
pub fn laplacian(shape: &Shape, kind: LaplacianKind, progress: &mut Progress) -> Result<Laplacian, OperatorError> {
    laplacian_filtered(shape, kind, None, progress)
}

/// [`laplacian`]; in the geodesic one of a cloud edges fade that `filter` knows to join what does not belong together.
pub(crate) fn laplacian_filtered(
    shape: &Shape,
    kind: LaplacianKind,
    filter: Option<EdgeFilter>,
    progress: &mut Progress,
) -> Result<Laplacian, OperatorError> {
    if kind == LaplacianKind::Cotangent {
        progress.at(Stage::Laplacian, 0.0)?;
        if shape.faces().is_empty() {
            return Err(OperatorError::NeedsFaces);
        }
        return Ok(cotangent_laplacian(shape.points(), &shape.welded_faces()));
    }
    progress.at(Stage::Graph, 0.0)?;
    let params = GaussianParams::default();
    let neighbours = nearest_neighbours(shape.points(), params.neighbours);
    progress.at(Stage::Graph, 0.5)?;
    let graph = match kind {
        LaplacianKind::Euclidean => neighbours.graph(),
        _ => refine(&neighbours, &RefineParams::default()).edges,
    };
    progress.at(Stage::Laplacian, 0.0)?;
    Ok(match kind {
        LaplacianKind::GeodesicLiteral => literal_laplacian(&graph, neighbours.mean_distance()),
        LaplacianKind::Geodesic => {
            let quadrics = Quadrics::fit(shape.points(), &neighbours).with_filter(filter);
            gaussian_laplacian(shape.points(), &graph, &neighbours, kind, Some(&quadrics))
        }
        _ => gaussian_laplacian(shape.points(), &graph, &neighbours, kind, None),
    })
}
