//! Which point of one deformable 3D scan is which point of the other.
//!
//! The path from bytes to a map, one module per step:
//!
//! ```text
//! bytes ─read─▶ Shape ─graph─▶ GeodesicGraph ─operators─▶ Operators ─spectrum─▶ SpectralBasis
//!    ─features─▶ PointFeatures ─(pair) fmap─▶ FunctionalMap ─refine─▶ Correspondence
//! ```

#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
mod device;
mod error;
mod features;
mod fmap;
mod graph;
mod operators;
mod options;
mod pipeline;
mod prepared;
mod progress;
mod read;
mod shape;
mod spectrum;
#[cfg(feature = "train")]
pub mod train;
#[cfg(target_arch = "wasm32")]
mod wasm;

pub use device::{Cpu, Device};
pub use error::Error;
pub use features::{PointFeatures, wave_kernel_signature};
pub use fmap::{Correspondence, EdgeDistances, FunctionalMap, Matchable, Refinement, UNMATCHED, mean_error};
pub use graph::{EdgeGraph, GeodesicGraph, Neighbours, RefineParams, RefineReport, nearest_neighbours, refine};
pub use operators::{GaussianParams, Laplacian, LaplacianKind, OperatorError, laplacian};
pub use options::{Axis, FaceUse, MatchOptions, OptionError, Parts, PrepareOptions};
pub use pipeline::{Match, match_shapes, prepare};
pub use prepared::{BlockError, Info, PreparedShape, ShapeKind};
pub use progress::{Cancelled, Progress, Stage};
pub use read::{Format, ReadError, read};
pub use shape::{Repair, Shape, ShapeError};
pub use spectrum::{SpectralBasis, SpectrumError, SpectrumReport, spectrum};
