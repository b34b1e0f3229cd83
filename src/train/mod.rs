//! What trains and illustrates the product; native only, never in the wasm module.

pub mod bodies;
