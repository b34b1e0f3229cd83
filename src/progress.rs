//! Named stages and the callback that hears of them.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use web_time::Instant;

/// The steps a user can wait for, in the order of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
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

    /// A listener for options.
    pub fn listener(callback: impl Fn(Stage, f64) -> bool + Send + Sync + 'static) -> Listener {
        Listener(Some(Arc::new(callback)))
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

/// A callback that travels in options: hears of every stage with its finished fraction, and stops the call by returning `false`.
#[derive(Clone, Default)]
pub struct Listener(Option<Arc<Callback>>);

type Callback = dyn Fn(Stage, f64) -> bool + Send + Sync;

impl Listener {
    /// Told through this.
    pub(crate) fn progress(&self) -> Progress<'_> {
        match &self.0 {
            Some(callback) => Progress::new(|stage, fraction| callback(stage, fraction)),
            None => Progress::silent(),
        }
    }
}

impl fmt::Debug for Listener {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Listener" } else { "no listener" })
    }
}

impl PartialEq for Listener {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(one), Some(another)) => Arc::ptr_eq(one, another),
            (one, another) => one.is_none() && another.is_none(),
        }
    }
}

/// The listener asked for a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped on request during {stage:?}")]
pub struct Cancelled {
    /// Where it stopped.
    pub stage: Stage,
}
