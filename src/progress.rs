//! Named stages and the callback that hears of them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use web_time::Instant;

/// The steps a user can wait for, in the order of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
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

impl Stage {
    /// The name users see: `"functional-map"`.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Read => "read",
            Stage::Sample => "sample",
            Stage::Graph => "graph",
            Stage::Laplacian => "laplacian",
            Stage::Spectrum => "spectrum",
            Stage::Features => "features",
            Stage::FunctionalMap => "functional-map",
            Stage::Refine => "refine",
            Stage::Correspondence => "correspondence",
        }
    }
}

/// Tells a listener of every stage with its finished fraction in [0, 1], and keeps the time each stage takes.
///
/// The listener returns `false` to ask for a stop. Natively that ends the run with [`Error::Cancelled`](crate::Error); in the browser
/// the worker itself is ended instead, because a running wasm call cannot hear of anything.
pub struct Progress<'a> {
    listener: Box<dyn FnMut(Stage, f64) -> bool + 'a>,
    seconds: BTreeMap<String, f64>,
    running: Option<(Stage, Instant)>,
}

impl<'a> Progress<'a> {
    /// Reports to `listener`.
    pub fn new(listener: impl FnMut(Stage, f64) -> bool + 'a) -> Self {
        Self { listener: Box::new(listener), seconds: BTreeMap::new(), running: None }
    }

    /// Reports to nobody and never stops.
    pub fn silent() -> Self {
        Self::new(|_, _| true)
    }

    /// Tells the listener; `Err(Cancelled)` when it wants a stop.
    pub fn at(&mut self, stage: Stage, fraction: f64) -> Result<(), Cancelled> {
        self.lap(Some(stage));
        if (self.listener)(stage, fraction.clamp(0.0, 1.0)) { Ok(()) } else { Err(Cancelled { stage }) }
    }

    /// Seconds spent in each stage since the clock was last asked.
    pub fn take_seconds(&mut self) -> BTreeMap<String, f64> {
        self.lap(None);
        std::mem::take(&mut self.seconds)
    }

    /// Counts time that a stage took elsewhere.
    pub fn add_seconds(&mut self, stage: Stage, seconds: f64) {
        *self.seconds.entry(stage.name().to_owned()).or_default() += seconds;
    }

    fn lap(&mut self, next: Option<Stage>) {
        let now = Instant::now();
        if let Some((stage, since)) = self.running {
            self.add_seconds(stage, (now - since).as_secs_f64());
        }
        self.running = next.map(|stage| (stage, now));
    }
}

/// The listener asked for a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped on request during {stage:?}")]
pub struct Cancelled {
    /// Where it stopped.
    pub stage: Stage,
}
