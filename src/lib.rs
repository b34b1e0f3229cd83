//! Which point of one deformable 3D scan is which point of the other.
//!
//! The path from bytes to a map, one module per step:
//!
//! ```text
//! bytes ─read─▶ Shape ─graph─▶ EdgeGraph ─operators─▶ Laplacian ─spectrum─▶ SpectralBasis
//!    ─features─▶ PointEmbedding ─(pair) attention, fmap─▶ FunctionalMap both ways ─refine─▶ Correspondence
//! ```
//!
//! `pipeline.rs` is that line as code; start there. The method is the functional-map framework of the paper "GeoSe-FMap:
//! Geometry–Semantic Functional Maps for Weakly Supervised Cross-Modal Deformable 3D Shape Correspondence"; where this crate departs from
//! it, the place says so and why.
//!
//! ```
//! use geose_fmap::{MatchOptions, PrepareOptions, Progress, Shape, match_shapes, prepare};
//!
//! // A bumpy, asymmetric egg, and the same egg lying on its side.
//! let egg: Vec<[f64; 3]> = (0..400)
//!     .map(|i| {
//!         let (z, turn) = (1.0 - (2 * i + 1) as f64 / 400.0, i as f64 * 2.399963);
//!         let r = (1.0 - z * z).sqrt() * (1.0 + 0.2 * z + 0.15 * turn.sin());
//!         [r * turn.cos(), 0.8 * r * turn.sin(), 1.6 * z]
//!     })
//!     .collect();
//! let lying = egg.iter().map(|p| [p[2], p[0], p[1]]).collect();
//!
//! let options = PrepareOptions { eigenpairs: 40, ..PrepareOptions::default() };
//! let mut ready = |points| prepare(Shape::new(points, Vec::new(), None)?, None, &options, &mut Progress::silent());
//! let (a, b) = (ready(egg)?, ready(lying)?);
//! let matched = match_shapes(&a, &b, &MatchOptions::default(), &mut Progress::silent())?;
//! let right = matched.a_to_b.target.iter().enumerate().filter(|&(i, &j)| i == j as usize).count();
//! assert!(right > 390);
//! # Ok::<(), geose_fmap::Error>(())
//! ```

#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
mod confidence;
mod descriptors;
mod device;
#[cfg(not(target_arch = "wasm32"))]
mod evaluate;
mod graph;
mod lifting;
mod maps;
mod network;
pub mod operators;
mod pipeline;
mod progress;
mod read;
mod registration;
mod shape;
pub mod spectrum;
#[cfg(feature = "train")]
pub mod train;
mod uses;
mod vector;
#[cfg(target_arch = "wasm32")]
pub mod wasm;
#[cfg(not(target_arch = "wasm32"))]
mod write;

pub use descriptors::{PointFeatures, wave_kernel_signature};
#[cfg(feature = "gpu")]
pub use device::{Agreement, Gpu, GpuCounters, GpuIndices, GpuInfo, GpuOptions, GpuTensor, PoolSize};
pub use device::{Cpu, Device, Fallback, Mask};
pub use graph::{EdgeGraph, GeodesicGraph, Neighbours, RefineParams, RefineReport, nearest_neighbours, refine};
pub use maps::{Correspondence, FunctionalMap, LearnedCues, Matchable, UNMATCHED};
pub use network::{
    Category, Embedding, Encoding, InputConfig, Model, ModelConfig, Network, Norm, Part, PointEmbedding, Position,
    ShapeInputs, Solver, Source, Start, Statistics, Thresholds, TrainedNetwork, Weights, WeightsError, WeightsId,
};
pub use operators::{
    EdgeFilter, Frame, Gradient, Laplacian, LaplacianBuilder, LaplacianKind, Mass, Neighbourhood, OperatorError,
    gradient, laplacian, normals,
};
pub use pipeline::{
    BlockError, DeviceChoice, DeviceError, DeviceInfo, DeviceKind, Error, FaceUse, GpuUse, Info, Match, MatchOptions,
    Matcher, OptionError, Parts, PrepareOptions, PreparedShape, Processor, Result, ShapeKind, Warning, match_shapes,
    match_with, prepare, prepare_with,
};
pub use progress::{Cancelled, Listener, Progress, Stage};
pub use read::{Format, ReadError, read};
pub use registration::Refinement;
pub use shape::{Axis, Repair, Shape, ShapeError};
pub use spectrum::{SpectralBasis, SpectrumError, SpectrumReport, spectrum};
pub use uses::{EdgeDistances, PartScores, mean_error, part_scores, point_errors};
