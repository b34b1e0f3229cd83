//! The parameters being trained, their optimiser and its state, in one file that training resumes from.
//!
//! AdamW (Loshchilov & Hutter 2019) is written out because a checkpoint must hold its moments, which the library's keeps to itself.

use std::collections::BTreeMap;

use candle_core::backprop::GradStore;
use candle_core::{Tensor, Var};
use ndarray::Array2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::device::{matrix, tensor};
use crate::network::{Category, ModelConfig, Source, Start, Statistics, Weights, WeightsError};

const BETA: [f32; 2] = [0.9, 0.999];
const EPSILON: f32 = 1e-8;
/// Share of a step's statistics in the running ones, from the tenth step on; before that all steps count alike.
const FOLLOWED: f32 = 0.1;

struct Parameter {
    var: Var,
    first: Array2<f32>,
    second: Array2<f32>,
}

/// Parameters by name.
pub struct Parameters {
    named: BTreeMap<String, Parameter>,
    /// Values to start from instead of random ones.
    given: BTreeMap<String, Array2<f32>>,
    rng: ChaCha8Rng,
    /// Optimiser steps taken.
    pub steps: usize,
}

impl Parameters {
    /// New ones, drawn from `rng` as a network asks for them.
    pub fn new(rng: ChaCha8Rng) -> Self {
        Self { named: BTreeMap::new(), given: BTreeMap::new(), rng, steps: 0 }
    }

    /// Those of a file, and random ones for what it lacks; with their optimiser state if the file has it.
    pub fn from_weights(weights: &Weights, rng: ChaCha8Rng) -> Self {
        let given = weights.tensors().map(|(name, matrix)| (name.to_owned(), matrix.to_owned())).collect();
        let steps = weights.about.get("steps").and_then(|steps| steps.parse().ok()).unwrap_or(0);
        Self { named: BTreeMap::new(), given, rng, steps }
    }

    /// The weights alone, or with the state of the optimiser beside them.
    pub fn weights(&self, config: &ModelConfig, category: &Category, with_state: bool) -> Weights {
        let mut tensors = BTreeMap::new();
        for (name, parameter) in &self.named {
            tensors.insert(name.clone(), matrix(parameter.var.as_tensor()));
            if with_state {
                tensors.insert(format!("{name}.first"), parameter.first.clone());
                tensors.insert(format!("{name}.second"), parameter.second.clone());
            }
        }
        let about = BTreeMap::from([("steps".to_owned(), self.steps.to_string())]);
        Weights::new(config.clone(), category.clone(), about, tensors)
    }

    /// How many numbers are learned.
    pub fn count(&self) -> usize {
        self.named.values().map(|parameter| parameter.first.len()).sum()
    }

    /// Running means and variances of batch normalisation take up what step `step` (from 0) found.
    pub fn follow(&mut self, found: &[Statistics<Tensor>], step: usize) -> candle_core::Result<()> {
        let share = FOLLOWED.max(1.0 / (step as f32 + 1.0));
        for Statistics { layer, mean, variance } in found {
            for (part, new) in [("mean", mean), ("variance", variance)] {
                let running = self.named.get_mut(&format!("{layer}.{part}")).expect("every layer has its statistics");
                let new = matrix(new);
                // What is not finite would stay.
                if new.iter().all(|v| v.is_finite()) {
                    let old = matrix(running.var.as_tensor());
                    running.var.set(&tensor((&old + share * (new - &old)).view()))?;
                }
            }
        }
        Ok(())
    }

    /// One step of AdamW on gradients of total length at most `clip`. Returns the length they had. Gradients that are not finite change nothing.
    pub fn step(&mut self, grads: &GradStore, rate: f32, decay: f32, clip: f32) -> candle_core::Result<f32> {
        let grads: Vec<Option<Array2<f32>>> =
            self.named.values().map(|parameter| grads.get(parameter.var.as_tensor()).map(matrix)).collect();
        let square: f64 = grads.iter().flatten().flatten().map(|&g| f64::from(g) * f64::from(g)).sum();
        let length = square.sqrt() as f32;
        if !length.is_finite() {
            return Ok(length);
        }
        self.steps += 1;
        let scale = (clip / length.max(1e-12)).min(1.0);
        let correction = BETA.map(|beta| 1.0 - beta.powi(self.steps.min(100_000) as i32));
        for (parameter, grad) in self.named.values_mut().zip(grads) {
            let Some(grad) = grad else { continue };
            let mut values = matrix(parameter.var.as_tensor());
            // Biases, gains and times are not pulled towards nought.
            let decay = if values.nrows() > 1 { decay } else { 0.0 };
            ndarray::Zip::from(&mut values).and(&mut parameter.first).and(&mut parameter.second).and(&grad).for_each(
                |value, first, second, &g| {
                    let g = g * scale;
                    *first += (1.0 - BETA[0]) * (g - *first);
                    *second += (1.0 - BETA[1]) * (g * g - *second);
                    let step = (*first / correction[0]) / ((*second / correction[1]).sqrt() + EPSILON);
                    *value -= rate * (step + decay * *value);
                },
            );
            parameter.var.set(&tensor(values.view()))?;
        }
        Ok(length)
    }
}

impl Source<Tensor> for Parameters {
    fn tensor(&mut self, name: &str, shape: [usize; 2], start: Start) -> Result<Tensor, WeightsError> {
        let taken =
            |given: &mut BTreeMap<String, Array2<f32>>, name: &str| -> Result<Option<Array2<f32>>, WeightsError> {
                match given.remove(name) {
                    Some(matrix) if matrix.dim() != (shape[0], shape[1]) => {
                        Err(WeightsError(format!("{name} has another shape than this network's")))
                    }
                    found => Ok(found),
                }
            };
        let values = match taken(&mut self.given, name)? {
            Some(values) => values,
            None => self.fresh(shape, start),
        };
        let zeros = || Array2::zeros((shape[0], shape[1]));
        let first = taken(&mut self.given, &format!("{name}.first"))?.unwrap_or_else(zeros);
        let second = taken(&mut self.given, &format!("{name}.second"))?.unwrap_or_else(zeros);
        let var = Var::from_tensor(&tensor(values.view())).map_err(|error| WeightsError(error.to_string()))?;
        let shared = var.as_tensor().clone();
        self.named.insert(name.to_owned(), Parameter { var, first, second });
        Ok(shared)
    }
}

impl Parameters {
    fn fresh(&mut self, [rows, cols]: [usize; 2], start: Start) -> Array2<f32> {
        let rng = &mut self.rng;
        // Box and Muller's: two uniform numbers make a normal one.
        let mut normal = || {
            let (u, v): (f32, f32) = (1.0 - rng.random::<f32>(), rng.random());
            (-2.0 * u.ln()).sqrt() * (std::f32::consts::TAU * v).cos()
        };
        Array2::from_shape_fn((rows, cols), |(_, c)| match start {
            Start::Constant(value) => value,
            Start::Normal(spread) => spread * normal(),
            Start::Logarithms(low, high) => {
                let share = c as f32 / (cols.max(2) - 1) as f32;
                low.ln() + share * (high / low).ln()
            }
        })
    }
}
