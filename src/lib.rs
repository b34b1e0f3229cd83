//! Which point of one deformable 3D scan is which point of the other.
//!
//! The path from bytes to a map, one room (module) per step:
//!
//! ```text
//! bytes ─read─▶ Shape ─operators─▶ Neighbourhood ─▶ Laplacian, mass, gradient ─spectrum─▶ SpectralBasis
//!    ─network─▶ features, parts ─(pair) attention, maps─▶ FunctionalMap both ways ─registration─▶ Correspondence
//!    ─confidence, lifting─▶ every uploaded point ─uses─▶ what it is for
//! ```
//!
//! [`pipeline`] is that line as code, from a `Shape` to the match of every uploaded point; start there. The method is the functional-map framework of the paper "GeoSe-FMap:
//! Geometry–Semantic Functional Maps for Weakly Supervised Cross-Modal Deformable 3D Shape Correspondence"; where this crate departs from it, the place says so
//! and why.
//!
//! ```
//! use geose_fmap::{MatchOptions, Matcher, PrepareOptions, Shape};
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
//! let matcher = Matcher::new();
//! let options = PrepareOptions { eigenpairs: 40, ..PrepareOptions::default() };
//! let prepare = |points| matcher.prepare(Shape::new(points, Vec::new(), None)?, &options);
//! let (a, b) = (prepare(egg)?, prepare(lying)?);
//! let matched = matcher.match_shapes(&a, &b, &MatchOptions::default())?;
//! let right = matched.a_to_b.target.iter().enumerate().filter(|&(i, &j)| i == j as usize).count();
//! assert!(right > 390);
//! # Ok::<(), geose_fmap::Error>(())
//! ```
//!
//! # Words
//!
//! | word | paper | room |
//! | --- | --- | --- |
//! | k₀, k, τ, T, σ; refined graph 𝒢⁽ᵀ⁾ | Sec. 3.2, Algorithm 1 | `operators` ([`operators::LaplacianBuilder`]), `graph/refine.rs` |
//! | Laplacian L, mass M | Sec. 3.2; L̃ = D̃ − W′ is the kind `geodesic-literal`, L = D − W the kind `gaussian` | [`operators`] |
//! | quadric: the surface around a point, by moving least squares | not in the paper | `operators/quadrics.rs` |
//! | spectral basis Φ, λ | Sec. 3.2, step 4 | [`spectrum`] |
//! | heat and wave kernel signatures | – | [`descriptors`] |
//! | sampled surface: an even sampling, which samples are adjacent, normals | – | `descriptors/sampled_surface.rs` |
//! | carriers: the points that a basis has rows for; points used: those that are matched | N of Sec. 4.1 | `shape/support.rs` |
//! | coarse: a farthest-point sampling of the points used, on which refinement works | – | `shape/sample.rs`, chosen in `pipeline/scan.rs` |
//! | seam, shell, resampled surface: a body in several surfaces made one | not in the paper | `shape/weld.rs`, `shape/shells.rs`, `shape/resampled.rs` |
//! | stray, spike, placeless point; floor, furniture and other things: what is not the body | not in the paper | `shape/strays.rs`, `shape/spikes.rs`, `shape/scene.rs`; chosen in `pipeline/surface.rs`, `pipeline/scan.rs` and, with the network, `pipeline/body.rs` |
//! | reliability: how far a scan can be relied on before it is matched | – | `pipeline/reliability.rs` |
//! | features F, DiffusionNet | Sec. 3.3 | `network/diffusion_net.rs` |
//! | position encoding ψ(P) | Sec. 3.3 | `network/inputs.rs`; of maps without a network `registration/initial.rs` |
//! | moments: inner and triple products with learned centres, by which left and right differ | not in the paper | `network/moments.rs` |
//! | part-aware masked attention | Sec. 3.3 | `network/attention.rs` |
//! | category: the kind of body that weights know, its parts and thresholds | the C = 8 labels of Sec. 4.1 | `network/category.rs` |
//! | functional map C_ab: functions on A → functions on B | Sec. 3.3, C_AB | [`maps`] |
//! | point map: goes the other way than its functional map | π | `maps/point_map.rs` |
//! | ZoomOut | – | `registration/refine.rs` |
//! | out-of-distribution scores, and the verdict on them | – | `maps/learned.rs`, `pipeline/warnings.rs`; thresholds in the category |
//! | registration: each body deformed onto the other, as rigidly as possible | – | [`registration`] |
//! | chirality: whether a map turns a surface inside out | – | `registration/chirality.rs` |
//! | piece, share of a body's surface, extent √share | not in the paper | `pipeline/share.rs`; the head that says it in `network/network.rs` |
//! | overlap: the probability that a point has a partner | – | `confidence/overlap.rs` |
//! | cues, calibration: what confidence is made of | – | `confidence`; fitted by `evaluate/refit.rs` |
//! | prior of a place: how often matches are right where a point lies, by its features | – | `network/model.rs` |
//! | lifting: from the points used to every uploaded point | – | `lifting` |
//! | L_geo, L_orth, L_sem and the losses beside them | Sec. 3.4 | `train/losses.rs` (feature `train`) |
//! | average geodesic error, accuracy, part IoU | Sec. 4.2 | `evaluate`, [`uses`] |

#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
pub mod cli;
mod confidence;
pub mod descriptors;
pub mod device;
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
mod evaluate;
pub mod graph;
mod lifting;
pub mod maps;
pub mod network;
pub mod operators;
pub mod pipeline;
mod progress;
mod read;
pub mod registration;
mod shape;
pub mod spectrum;
#[cfg(feature = "train")]
pub mod train;
pub mod uses;
mod vector;
#[cfg(target_arch = "wasm32")]
pub mod wasm;
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
mod write;

pub use maps::{Correspondence, UNMATCHED};
pub use network::{Category, Weights};
pub use operators::LaplacianKind;
pub use pipeline::{
    Error, FaceUse, Info, Match, MatchOptions, Matcher, Parts, PrepareOptions, PreparedShape, Result, Warning,
};
pub use progress::{Cancelled, Listener, Progress, Stage};
pub use read::{Format, Pose, ReadError, ReadOptions, read, read_with};
pub use registration::Refinement;
pub use shape::{Axis, Repair, Shape, ShapeError};
