//! What the readers read, what they repair and say, and what they refuse and why. Inputs are built here, small.

#![cfg(not(target_arch = "wasm32"))]

#[path = "readers/body_on_joints.rs"]
mod body_on_joints;
#[path = "readers/compressed_torus.rs"]
mod compressed_torus;
#[path = "readers/contract.rs"]
mod contract;
#[path = "readers/encodings.rs"]
mod encodings;
#[path = "readers/foreign.rs"]
mod foreign;
#[path = "readers/gltf.rs"]
mod gltf;
#[path = "readers/hostile.rs"]
mod hostile;
#[path = "readers/meshopt.rs"]
mod meshopt;
#[path = "readers/obj.rs"]
mod obj;
#[path = "readers/off.rs"]
mod off;
#[path = "readers/ply.rs"]
mod ply;
#[path = "readers/pose.rs"]
mod pose;
#[path = "readers/sample.rs"]
mod sample;
#[path = "readers/shape.rs"]
mod shape;
#[path = "readers/sniffing.rs"]
mod sniffing;
#[path = "readers/stl.rs"]
mod stl;
#[path = "readers/table.rs"]
mod table;
