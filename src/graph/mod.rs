//! Neighbourhoods on a point cloud: k nearest neighbours, bounded geodesics, and the refined graph of Algorithm 1.

mod cells;
mod components;
mod curve;
mod dijkstra;
mod edges;
mod neighbours;
mod refine;

pub use cells::nearest_sources;
pub(crate) use components::Forest;
pub use components::components;
pub use dijkstra::BoundedDijkstra;
pub use edges::EdgeGraph;
pub use neighbours::{Neighbours, nearest_neighbours};
pub use refine::{GeodesicGraph, RefineParams, RefineReport, refine};
