//! What trains and illustrates the product; native only, never in the wasm module.

pub mod atlas;
pub mod bodies;
mod category_of_labels;
pub mod device;
pub mod folds;
pub mod labelled;
pub mod losses;
pub mod parameters;
pub mod pool;
pub mod run;
mod run_config;
pub mod sample;
pub mod sample_config;
pub mod step;

pub use crate::evaluate::refit::refit;
