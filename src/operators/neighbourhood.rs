//! What is around each point of a cloud, found once: neighbours, the refined graph, the surface through each point, its area.

use std::sync::OnceLock;

use super::mass::cloud_mass;
use super::quadrics::Quadrics;
use crate::graph::{EdgeGraph, GeodesicGraph, Neighbours, RefineParams, nearest_neighbours, refine};

/// k: the neighbours of a point that Algorithm 1 considers.
pub(super) const NEIGHBOURS: usize = 20;

/// The points of a cloud (n, 3) and what is found around them. Each of these is found when it is first asked for, and kept: Laplacian, gradient, normals, mass and
/// the surface around a sampling share them.
#[derive(Debug)]
pub struct Neighbourhood {
    points: Vec<[f64; 3]>,
    k: usize,
    refinement: RefineParams,
    neighbours: OnceLock<Neighbours>,
    plain: OnceLock<EdgeGraph>,
    refined: OnceLock<GeodesicGraph>,
    quadrics: OnceLock<Quadrics>,
    mass: OnceLock<Vec<f64>>,
}

impl Neighbourhood {
    /// With the parameters of Algorithm 1: k = 20, k₀ = 5, τ = 3, T = 3.
    pub fn of(points: &[[f64; 3]]) -> Self {
        Self::with(points, NEIGHBOURS, RefineParams::default())
    }

    /// With `k` neighbours, of which `refinement` chooses those of the graph.
    pub fn with(points: &[[f64; 3]], k: usize, refinement: RefineParams) -> Self {
        Self {
            points: points.to_vec(),
            k,
            refinement,
            neighbours: OnceLock::new(),
            plain: OnceLock::new(),
            refined: OnceLock::new(),
            quadrics: OnceLock::new(),
            mass: OnceLock::new(),
        }
    }

    /// Positions (n, 3), in the unit of the cloud.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// k, as asked for; a cloud of fewer points has fewer neighbours.
    pub fn k(&self) -> usize {
        self.k
    }

    /// k₀, τ and T.
    pub fn refinement(&self) -> RefineParams {
        self.refinement
    }

    /// The k nearest neighbours of each point.
    pub fn neighbours(&self) -> &Neighbours {
        self.neighbours.get_or_init(|| nearest_neighbours(&self.points, self.k))
    }

    /// An edge wherever one point is among the neighbours of the other.
    pub fn plain_graph(&self) -> &EdgeGraph {
        self.plain.get_or_init(|| self.neighbours().graph())
    }

    /// 𝒢^(T) of Algorithm 1.
    pub fn refined_graph(&self) -> &GeodesicGraph {
        self.refined.get_or_init(|| refine(self.neighbours(), &self.refinement))
    }

    /// Unit normals (n, 3) of the surfaces through the points, of either sign.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        self.quadrics().normals()
    }

    /// The surface through each point.
    pub(crate) fn quadrics(&self) -> &Quadrics {
        self.quadrics.get_or_init(|| Quadrics::fit(&self.points, self.neighbours()))
    }

    /// The area that each point stands for (n), in unit².
    pub fn mass(&self) -> &[f64] {
        self.mass.get_or_init(|| cloud_mass(&self.points, self.neighbours()))
    }
}
