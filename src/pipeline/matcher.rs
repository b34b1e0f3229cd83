//! The method as a Rust program calls it: on the CPU, without anything to wait for.

use std::sync::Arc;

use super::{MatchOptions, PrepareOptions, PreparedShape, Result, match_with, prepare_with};
use crate::device::Cpu;
use crate::network::{Category, Model, Weights};
use crate::pipeline::Match;
use crate::shape::Shape;

/// Finds which point of one scan is which point of another, on the CPU. Cheap to clone; many threads may use one.
///
/// [`Processor`](super::Processor) runs the same on a GPU where there is one, and has to be waited for.
#[derive(Clone, Debug)]
pub struct Matcher {
    model: Arc<Model>,
}

impl Default for Matcher {
    fn default() -> Self {
        Self::new()
    }
}

impl Matcher {
    /// With the weights that ship.
    pub fn new() -> Self {
        Self { model: Model::embedded().clone() }
    }

    /// With weights of one's own, one or one for each category of bodies. Of several the one most at home with a pair matches it. Fails where they do not fit the
    /// network that they say they are of, and without any.
    pub fn with_weights(weights: impl IntoIterator<Item = Weights>) -> Result<Self> {
        Ok(Self { model: Arc::new(Model::on(weights.into_iter().map(Arc::new), Cpu)?) })
    }

    /// The categories of bodies that the weights know.
    pub fn categories(&self) -> impl Iterator<Item = &Category> {
        self.model.networks().iter().map(|network| &**network.category())
    }

    /// Scan → graph → Laplacian → spectrum → features and parts: everything a match needs to know of a scan.
    pub fn prepare(&self, shape: Shape, options: &PrepareOptions) -> Result<PreparedShape> {
        let (name, mut progress) = (options.name.clone(), options.progress.progress());
        // Nothing on the CPU ever waits.
        pollster::block_on(prepare_with(&self.model, shape, name, options, &mut progress))
    }

    /// Features of both → functional maps both ways → refinement → correspondence of every uploaded point, both ways.
    pub fn match_shapes(&self, a: &PreparedShape, b: &PreparedShape, options: &MatchOptions) -> Result<Match> {
        let mut progress = options.progress.progress();
        pollster::block_on(match_with(&self.model, a, b, options, &mut progress))
    }
}
