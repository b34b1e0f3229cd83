//! A Laplacian with every parameter of the paper's Sec. 3.2.

use std::ops::RangeInclusive;

use super::cloud::{density_normalised_weights, gaussian_weights, literal_weights};
use super::neighbourhood::{NEIGHBOURS, Neighbourhood};
use super::quadrics::EdgeFilter;
use super::{Laplacian, LaplacianKind, OperatorError, cotangent_laplacian};
use crate::graph::RefineParams;
use crate::progress::{Progress, Stage};
use crate::shape::Shape;

/// Neighbours that can be asked for. Fewer than 3 span no surface; more than 200 are no neighbourhood, and their memory is that of 200 per point.
const K: RangeInclusive<usize> = 3..=200;
/// τ that can be asked for: no way on a graph is shorter than the straight line, and above 1000 nothing is ever left out.
const TAU: RangeInclusive<f64> = 1.0..=1000.0;
/// T that can be asked for. A graph no longer changes after a few rounds.
const ITERATIONS: RangeInclusive<usize> = 0..=100;
/// σ that can be asked for, in units of the scan: its square stays a number.
const SIGMA: RangeInclusive<f64> = 1e-30..=1e30;

/// What the mass of a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mass {
    /// The area that it stands for, in unit².
    Area,
    /// 1, as in the paper's Lφ = λφ; 0 for what is in no face of a mesh.
    Unit,
}

/// A way to build Laplacians. What is not set is as the paper has it: k₀ = 5, k = 20, τ = 3, T = 3, σ the mean distance to the k neighbours over the cloud.
///
/// | kind | has |
/// | --- | --- |
/// | `geodesic` | k₀, k, τ, T, edge filter |
/// | `geodesic-literal` | k₀, k, τ, T, σ |
/// | `euclidean` | k |
/// | `gaussian` | k, σ |
/// | `cotangent` | none of them |
///
/// The mass of any kind can be chosen. An option that a kind does not have is refused by name, so that nobody believes to have changed what did not change.
///
/// ```
/// use geose_fmap::operators::LaplacianBuilder;
/// use geose_fmap::{LaplacianKind, Progress, Shape};
///
/// let points = (0..400)
///     .map(|i| {
///         let (z, turn) = (1.0 - (2 * i + 1) as f64 / 400.0, i as f64 * 2.399963);
///         [(1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z]
///     })
///     .collect();
/// let sphere = Shape::new(points, Vec::new(), None)?;
/// let pruned = LaplacianBuilder::new(LaplacianKind::GeodesicLiteral).neighbours(12).ratio(1.2);
/// assert_eq!(pruned.build(&sphere, &mut Progress::silent())?.len(), 400);
/// let refused = LaplacianBuilder::new(LaplacianKind::Gaussian).ratio(1.2).build(&sphere, &mut Progress::silent());
/// assert_eq!(refused.unwrap_err().code(), "invalid-option");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct LaplacianBuilder<'f> {
    kind: LaplacianKind,
    initial_neighbours: Option<usize>,
    neighbours: Option<usize>,
    ratio: Option<f64>,
    iterations: Option<usize>,
    sigma: Option<f64>,
    mass: Option<Mass>,
    filter: Option<EdgeFilter<'f>>,
}

impl<'f> LaplacianBuilder<'f> {
    /// Of this kind, all else as in the paper.
    pub fn new(kind: LaplacianKind) -> Self {
        Self {
            kind,
            initial_neighbours: None,
            neighbours: None,
            ratio: None,
            iterations: None,
            sigma: None,
            mass: None,
            filter: None,
        }
    }

    /// k₀, from 1 to k: neighbours in the graph that geodesics start from.
    pub fn initial_neighbours(self, k_0: impl Into<Option<usize>>) -> Self {
        Self { initial_neighbours: k_0.into(), ..self }
    }

    /// k, from 3 to 200: candidate neighbours.
    pub fn neighbours(self, k: impl Into<Option<usize>>) -> Self {
        Self { neighbours: k.into(), ..self }
    }

    /// τ, from 1 to 1000: a candidate is kept while geodesic / Euclidean distance is below.
    pub fn ratio(self, tau: impl Into<Option<f64>>) -> Self {
        Self { ratio: tau.into(), ..self }
    }

    /// T, from 0 (the graph of the first k₀ neighbours) to 100: rounds in which candidates are considered.
    pub fn iterations(self, rounds: impl Into<Option<usize>>) -> Self {
        Self { iterations: rounds.into(), ..self }
    }

    /// σ in units of the scan, from 1e-30 to 1e30.
    pub fn sigma(self, sigma: impl Into<Option<f64>>) -> Self {
        Self { sigma: sigma.into(), ..self }
    }

    /// What the mass of a point is; by default its area, and 1 for `geodesic-literal` and `gaussian`.
    pub fn mass(self, mass: impl Into<Option<Mass>>) -> Self {
        Self { mass: mass.into(), ..self }
    }

    /// What is known of edges beside where points lie: how far each counts, from 1 down to 0.
    pub fn edge_filter(self, filter: impl Into<Option<EdgeFilter<'f>>>) -> Self {
        Self { filter: filter.into(), ..self }
    }

    /// Refuses options that the kind does not have, and values out of range.
    pub fn check(&self) -> Result<(), OperatorError> {
        use LaplacianKind::{Cotangent, Euclidean, Gaussian, Geodesic, GeodesicLiteral};
        let refines = matches!(self.kind, Geodesic | GeodesicLiteral);
        let given: [(&'static str, bool, bool); 6] = [
            ("k0", self.initial_neighbours.is_some(), refines),
            ("k", self.neighbours.is_some(), self.kind != Cotangent),
            ("tau", self.ratio.is_some(), refines),
            ("iterations", self.iterations.is_some(), refines),
            ("sigma", self.sigma.is_some(), matches!(self.kind, GeodesicLiteral | Gaussian)),
            ("edgeFilter", self.filter.is_some(), self.kind == Geodesic),
        ];
        if let Some(&(option, ..)) = given.iter().find(|(_, given, has)| *given && !has) {
            let why = match (self.kind, option) {
                (Cotangent, _) => "it is built on the triangles",
                (Euclidean, "sigma") | (Geodesic, "sigma") => "its scale is that of each neighbourhood",
                (_, "edgeFilter") => "its edges do not fade",
                _ => "it keeps all neighbours",
            };
            return Err(invalid(option, format!("the {} Laplacian has no {option}: {why}", self.kind)));
        }
        let k = self.neighbours.unwrap_or(NEIGHBOURS);
        within("k", self.neighbours, &K)?;
        // The paper's five are more than three neighbours, and are then all of them.
        within("k0", self.initial_neighbours, &(1..=k))?;
        within("tau", self.ratio, &TAU)?;
        within("iterations", self.iterations, &ITERATIONS)?;
        within("sigma", self.sigma, &SIGMA)
    }

    /// The Laplacian of a shape. Cotangents are those of its faces; every other kind is of its points alone.
    pub fn build(&self, shape: &Shape, progress: &mut Progress) -> Result<Laplacian, OperatorError> {
        self.check()?;
        if self.kind != LaplacianKind::Cotangent {
            let neighbourhood = Neighbourhood::with(shape.points(), self.k(), self.refinement());
            return self.build_around(&neighbourhood, progress);
        }
        progress.at(Stage::Laplacian, 0.0)?;
        if shape.faces().is_empty() {
            return Err(OperatorError::NeedsFaces);
        }
        let laplacian = cotangent_laplacian(shape.points(), &shape.welded_faces());
        Ok(match self.mass {
            Some(Mass::Unit) => {
                let mass = laplacian.mass.iter().map(|&m| if m > 0.0 { 1.0 } else { 0.0 }).collect();
                Laplacian { mass, ..laplacian }
            }
            _ => laplacian,
        })
    }

    /// The Laplacian of a cloud of which the neighbourhood is known, with its k, k₀, τ and T; others than these are refused, and so are cotangents.
    pub fn build_around(
        &self,
        neighbourhood: &Neighbourhood,
        progress: &mut Progress,
    ) -> Result<Laplacian, OperatorError> {
        self.check()?;
        self.check_agreement(neighbourhood)?;
        progress.at(Stage::Graph, 0.0)?;
        let neighbours = neighbourhood.neighbours();
        progress.at(Stage::Graph, 0.5)?;
        let refined = || &neighbourhood.refined_graph().edges;
        let graph = match self.kind {
            LaplacianKind::Cotangent => return Err(OperatorError::NeedsFaces),
            LaplacianKind::Geodesic | LaplacianKind::GeodesicLiteral => refined(),
            LaplacianKind::Euclidean | LaplacianKind::Gaussian => neighbourhood.plain_graph(),
        };
        progress.at(Stage::Laplacian, 0.0)?;
        let sigma = || self.sigma.unwrap_or_else(|| neighbours.mean_distance());
        let weights = match self.kind {
            LaplacianKind::GeodesicLiteral => literal_weights(graph, sigma()),
            LaplacianKind::Gaussian => gaussian_weights(graph, sigma()),
            LaplacianKind::Euclidean | LaplacianKind::Cotangent => {
                density_normalised_weights(neighbourhood, graph, None)
            }
            LaplacianKind::Geodesic => {
                let sheets = neighbourhood.quadrics().with_filter(self.filter);
                density_normalised_weights(neighbourhood, graph, Some(sheets))
            }
        };
        let mass = match self.mass.unwrap_or(if self.kind.has_unit_mass() { Mass::Unit } else { Mass::Area }) {
            Mass::Unit => vec![1.0; graph.len()],
            Mass::Area => neighbourhood.mass().to_vec(),
        };
        let laplacian = Laplacian::from_weights(self.kind, mass, weights);
        if self.sigma.is_some() && !laplacian.ties_every_point() {
            let usual = neighbours.mean_distance();
            let message = format!(
                "sigma is so small that some points are tied to none: the mean distance to {} neighbours is {usual:e}",
                neighbours.k()
            );
            return Err(invalid("sigma", message));
        }
        Ok(laplacian)
    }

    fn k(&self) -> usize {
        self.neighbours.unwrap_or(NEIGHBOURS)
    }

    fn refinement(&self) -> RefineParams {
        let paper = RefineParams::default();
        RefineParams {
            initial_neighbours: self.initial_neighbours.unwrap_or(paper.initial_neighbours),
            ratio: self.ratio.unwrap_or(paper.ratio),
            iterations: self.iterations.unwrap_or(paper.iterations),
        }
    }

    fn check_agreement(&self, neighbourhood: &Neighbourhood) -> Result<(), OperatorError> {
        let RefineParams { initial_neighbours, ratio, iterations } = neighbourhood.refinement();
        let others = [
            ("k", self.neighbours.is_some_and(|k| k != neighbourhood.k())),
            ("k0", self.initial_neighbours.is_some_and(|k_0| k_0 != initial_neighbours)),
            ("tau", self.ratio.is_some_and(|tau| tau != ratio)),
            ("iterations", self.iterations.is_some_and(|rounds| rounds != iterations)),
        ];
        match others.iter().find(|(_, other)| *other) {
            Some(&(option, _)) => Err(invalid(option, format!("{option} is not that of the neighbourhood"))),
            None => Ok(()),
        }
    }
}

fn invalid(option: &'static str, message: String) -> OperatorError {
    OperatorError::InvalidOption { option, message }
}

fn within<T: PartialOrd + Copy + std::fmt::Display>(
    option: &'static str,
    value: Option<T>,
    range: &RangeInclusive<T>,
) -> Result<(), OperatorError> {
    match value.filter(|value| !range.contains(value)) {
        Some(value) => {
            let (least, most) = (range.start(), range.end());
            Err(invalid(option, format!("{option} must be between {least} and {most}, and {value} was asked for")))
        }
        None => Ok(()),
    }
}
