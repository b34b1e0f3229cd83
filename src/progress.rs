//! Named stages and the callback that hears of them.

use serde::Serialize;

/// The steps a user can wait for, in the order of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Bytes to a validated shape.
    Read,
    /// Choosing the points that take part.
    Sample,
    /// Nearest neighbours and geodesic distances.
    Graph,
    /// Laplacian and mass.
    Laplacian,
    /// Eigenpairs of the Laplacian.
    Spectrum,
    /// Per-point descriptors.
    Features,
    /// The first functional maps, both directions.
    FunctionalMap,
    /// Spectral refinement of the maps.
    Refine,
    /// Point-to-point map, confidence, lifting to every uploaded point.
    Correspondence,
}

/// Hears of every stage with its finished fraction in [0, 1]; returns `false` to ask for a stop.
///
/// Natively a `false` ends the run with [`Error::Cancelled`](crate::Error); in the browser the worker
/// itself is ended instead, because a running wasm call cannot be interrupted from outside.
pub struct Progress<'a> {
    listener: Box<dyn FnMut(Stage, f64) -> bool + 'a>,
}

impl<'a> Progress<'a> {
    /// Reports to `listener`.
    pub fn new(listener: impl FnMut(Stage, f64) -> bool + 'a) -> Self {
        Self { listener: Box::new(listener) }
    }

    /// Reports to nobody and never stops.
    pub fn silent() -> Self {
        Self::new(|_, _| true)
    }

    /// Tells the listener; `Err(Cancelled)` when it wants a stop.
    pub fn at(&mut self, stage: Stage, fraction: f64) -> Result<(), Cancelled> {
        if (self.listener)(stage, fraction.clamp(0.0, 1.0)) { Ok(()) } else { Err(Cancelled { stage }) }
    }
}

/// The listener asked for a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped on request during {stage:?}")]
pub struct Cancelled {
    /// Where it stopped.
    pub stage: Stage,
}
