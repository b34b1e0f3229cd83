//! Everything that decides the outcome of a run of training.

use serde::{Deserialize, Serialize};

use super::losses::LossWeights;

/// Steps after which one body more is drawn from.
const STEPS_PER_BODY: usize = 2;

/// A part of the bodies: every `of`-th from `held` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fold {
    /// How many folds there are, from 2.
    pub of: usize,
    /// Which one this is, from 0.
    pub held: usize,
}

impl Fold {
    /// Whether body `index` is in it.
    pub fn holds(&self, index: usize) -> bool {
        index % self.of == self.held
    }
}

/// Everything that decides the outcome of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RunConfig {
    /// Name and version that the weights will carry.
    pub name: String,
    /// See `name`.
    pub version: String,
    /// Steps in all.
    pub steps: usize,
    /// Ends after so many minutes of the processor instead, with all of the program's threads, the rate falling as they pass.
    pub minutes: Option<f64>,
    /// Bodies left out, to be validated on.
    pub fold: Option<Fold>,
    /// Pairs a step.
    pub batch: usize,
    /// Learning rate at its highest.
    pub rate: f32,
    /// How it falls.
    pub schedule: Schedule,
    /// Steps over which the rate rises.
    pub warm_up: usize,
    /// Weight decay.
    pub decay: f32,
    /// Longest gradient.
    pub clip: f32,
    /// Step from which functional maps count.
    pub maps_from: usize,
    /// Bodies that the first steps draw from; one more every second step, so that training need not wait for all of them to be made.
    pub first_bodies: usize,
    /// What is minimised.
    pub losses: LossWeights,
    /// Share of scans that are seen mirrored, for networks that see no coordinates.
    pub mirrored: f64,
    /// Of parameters and pairs.
    pub seed: u64,
}

/// How the learning rate falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Schedule {
    /// To nothing, along half a cosine.
    Cosine,
    /// Halved in the middle of the run, as the paper's every 50 of 100 epochs.
    Halved,
}

impl Default for RunConfig {
    fn default() -> Self {
        Self {
            name: "bodies".to_owned(),
            version: "1".to_owned(),
            steps: 20_000,
            minutes: None,
            fold: None,
            batch: 1,
            rate: 2e-3,
            schedule: Schedule::Cosine,
            warm_up: 50,
            decay: 1e-4,
            clip: 1.0,
            maps_from: 300,
            first_bodies: 300,
            losses: LossWeights::default(),
            mirrored: 0.5,
            seed: 1,
        }
    }
}

impl RunConfig {
    /// The paper's (Sec. 4.1): Adam 1e-3 halved every 50 of 100 epochs, batches of 8 pairs, its losses as printed. In an epoch every one of `bodies` is seen once, on
    /// average. The rest of its configuration is [`ModelConfig::paper`](crate::network::ModelConfig::paper) and [`SampleConfig::paper`](super::sample_config::SampleConfig::paper).
    pub fn paper(bodies: usize) -> Self {
        let batch = 8;
        Self {
            steps: (100 * bodies).div_ceil(2 * batch),
            batch,
            rate: 1e-3,
            schedule: Schedule::Halved,
            warm_up: 0,
            decay: 0.0,
            clip: f32::MAX,
            maps_from: 0,
            first_bodies: usize::MAX,
            name: "paper".to_owned(),
            losses: LossWeights::paper(),
            mirrored: 0.0,
            ..Self::default()
        }
    }

    /// How many of `all` bodies a step draws from.
    pub(super) fn bodies_at(&self, step: usize, all: usize) -> usize {
        all.min(self.first_bodies.saturating_add(step / STEPS_PER_BODY))
    }

    /// The rate of a step, when a share `done` of the run is over.
    pub(super) fn rate_at(&self, step: usize, done: f32) -> f32 {
        let rise = if step < self.warm_up { (step + 1) as f32 / self.warm_up as f32 } else { 1.0 };
        let fall = match self.schedule {
            Schedule::Cosine => 0.5 + 0.5 * (std::f32::consts::PI * done.min(1.0)).cos(),
            Schedule::Halved if done < 0.5 => 1.0,
            Schedule::Halved => 0.5,
        };
        self.rate * rise * fall
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_epochs_see_every_body_from_the_start() {
        let at = |run: &RunConfig| [0, 10, 100_000].map(|step| run.bodies_at(step, 6000));
        assert_eq!(at(&RunConfig::paper(6000)), [6000; 3]);
        assert_eq!(at(&RunConfig::default()), [300, 305, 6000]);
    }

    #[test]
    fn the_papers_rate_is_halved_once_and_at_once() {
        let run = RunConfig::paper(800);
        let rates = [0.0, 0.49, 0.51, 0.99].map(|done| run.rate_at((done * run.steps as f32) as usize, done));
        assert_eq!(rates, [1e-3, 1e-3, 5e-4, 5e-4]);
        let ours = RunConfig::default();
        assert!(
            ours.rate_at(0, 0.0) < 0.1 * ours.rate
                && ours.rate_at(1000, 0.5) < 0.6 * ours.rate
                && ours.rate_at(19_999, 1.0) < 1e-6
        );
    }
}
