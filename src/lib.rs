//! Which point of one deformable 3D scan is which point of the other.
//!
//! The path from bytes to a map, one module per step:
//!
//! ```text
//! bytes ─read─▶ Shape ─graph─▶ GeodesicGraph ─operators─▶ Operators ─spectrum─▶ SpectralBasis
//!    ─features─▶ PointFeatures ─(pair) fmap─▶ FunctionalMap ─refine─▶ Correspondence
//! ```

mod error;
mod progress;
pub mod read;
pub mod shape;
#[cfg(feature = "train")]
pub mod train;

pub use error::Error;
pub use progress::{Progress, Stage};
pub use shape::{Repair, Shape, ShapeError};
