//! The surface around each point of a cloud, a quadric by robust moving least squares, and with it which neighbours lie on the same sheet where limbs touch.

use super::frames::tangent_frame;
use crate::graph::Neighbours;
use crate::vector::{dot, minus, norm};

/// Neighbours that the first guess of the tangent plane is fitted to.
const PLANE: usize = 8;
/// Neighbours whose mean distance is the unit of length around a point.
const UNIT: usize = 6;
/// Width of the window of the fit, in that unit.
const WINDOW: f64 = 1.5;
/// Rounds of reweighting.
const ROUNDS: usize = 8;
/// Residual, relative to distance, at which a neighbour loses three quarters of its say; doubled in the first half of the rounds.
const TOLERANCE: f64 = 0.35;
/// Pull of the five coefficients (slopes, curvatures) towards the plane.
const RIDGE: [f64; 5] = [0.02, 0.02, 0.05, 0.05, 0.05];
/// How fast the weight of an edge fades with the squared residuals of its two ends.
const FADE: f64 = 8.0;
/// What is left of an edge between sheets, so that nothing falls apart.
const FLOOR: f64 = 0.02;

/// How far an edge between points i and j counts, from 1 down to 0, by what is known beside where the points lie.
pub type EdgeFilter<'f> = &'f dyn Fn(u32, u32) -> f64;

/// The surface around a point: a quadric through it, over a tangent plane.
#[derive(Debug)]
struct Quadric {
    point: [f64; 3],
    tangents: [[f64; 3]; 2],
    normal: [f64; 3],
    unit: f64,
    coefficients: [f64; 5],
}

/// Surfaces through every point, each fitted to the neighbours that agree with it.
#[derive(Debug)]
pub struct Quadrics {
    quadrics: Vec<Quadric>,
}

impl Quadrics {
    /// Fits one to each of `points` (n).
    ///
    /// The quadric passes through its own point and is fitted by iteratively reweighted least squares (Cauchy-like weights), so of two sheets that
    /// lie half a spacing apart it follows its own. Normals by principal components mix them, and tests on angles between normals also
    /// punish what is merely curved: fingers, noses, feet.
    pub fn fit(points: &[[f64; 3]], neighbours: &Neighbours) -> Self {
        Self { quadrics: (0..points.len()).map(|i| Quadric::fit(points, neighbours, i)).collect() }
    }

    /// With what else is known of edges: where `filter` is 0 two points lie on different sheets, wherever they are.
    pub fn with_filter<'a>(&'a self, filter: Option<EdgeFilter<'a>>) -> Sheets<'a> {
        Sheets { quadrics: self, filter }
    }

    /// Unit normals (n, 3), of either sign.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        self.quadrics.iter().map(Quadric::unit_normal).collect()
    }
}

/// Which edges lie within a sheet of surface, by the surfaces through their ends and by what else is known.
#[derive(Clone, Copy)]
pub struct Sheets<'a> {
    quadrics: &'a Quadrics,
    filter: Option<EdgeFilter<'a>>,
}

impl Sheets<'_> {
    /// From 1 for an edge within a sheet down to a floor for one between sheets.
    pub fn factor(&self, i: u32, j: u32) -> f64 {
        FLOOR + (1.0 - FLOOR) * self.agreement(i, j)
    }

    /// From 1 where each of two points lies on the sheet of the other down to nothing.
    pub fn agreement(&self, i: u32, j: u32) -> f64 {
        let quadric = |i: u32| &self.quadrics.quadrics[i as usize];
        let squared = |from: u32, to: u32| {
            let offset = minus(quadric(to).point, quadric(from).point);
            quadric(from).squared_residual(offset).min(2.0)
        };
        let kept = self.filter.map_or(1.0, |filter| filter(i, j));
        kept * (-FADE * (squared(i, j) + squared(j, i))).exp()
    }
}

/// Slopes and curvatures at (x, y): what the coefficients multiply.
fn terms(x: f64, y: f64) -> [f64; 5] {
    [x, y, x * x, x * y, y * y]
}

impl Quadric {
    fn fit(points: &[[f64; 3]], neighbours: &Neighbours, i: usize) -> Self {
        let of = neighbours.of(i);
        let near = of.iter().take(PLANE).map(|&j| points[j as usize]);
        let frame = tangent_frame(points[i], near);
        let nearest = &neighbours.distances(i)[..UNIT.min(of.len())];
        let unit = nearest.iter().sum::<f64>() / nearest.len().max(1) as f64;
        let (tangents, normal) = (frame.tangents, frame.normal);
        let mut quadric = Self { point: points[i], tangents, normal, unit, coefficients: [0.0; 5] };
        if unit <= 0.0 {
            return quadric;
        }
        let rows: Vec<([f64; 5], f64, f64)> = of
            .iter()
            .map(|&j| {
                let [x, y, z] = quadric.local(minus(points[j as usize], points[i]));
                (terms(x, y), z, (x * x + y * y + z * z).sqrt())
            })
            .collect();
        let window = |distance: f64| (-0.5 * (distance / WINDOW).powi(2)).exp();
        for round in 0..=ROUNDS {
            let tolerance = if round > ROUNDS / 2 + 1 { TOLERANCE } else { 2.0 * TOLERANCE };
            let weight = |terms: &[f64; 5], z: f64, distance: f64| {
                if round == 0 {
                    return window(distance);
                }
                let residual = z - product(terms, &quadric.coefficients);
                let agreement = 1.0 + (residual / (tolerance * distance.max(0.5))).powi(2);
                window(distance) / (agreement * agreement)
            };
            let mut normal: [[f64; 5]; 5] =
                std::array::from_fn(|p| std::array::from_fn(|q| if p == q { RIDGE[p] } else { 0.0 }));
            let mut right = [0.0; 5];
            for (terms, z, distance) in &rows {
                let w = weight(terms, *z, *distance);
                for p in 0..5 {
                    right[p] += w * terms[p] * z;
                    for q in 0..=p {
                        normal[p][q] += w * terms[p] * terms[q];
                    }
                }
            }
            quadric.coefficients = solved(normal, right);
        }
        quadric
    }

    /// Unit normal of the sheet at its point. Its sign means nothing: z ≥ 0, so that it does not hang on the order of points.
    fn unit_normal(&self) -> [f64; 3] {
        let Self { tangents: [u, v], normal, coefficients: [along_u, along_v, ..], .. } = self;
        let tilted: [f64; 3] = std::array::from_fn(|c| normal[c] - along_u * u[c] - along_v * v[c]);
        let length = norm(tilted).copysign(tilted[2]);
        tilted.map(|x| x / length)
    }

    /// Along the tangents and the normal, in units of the spacing.
    fn local(&self, offset: [f64; 3]) -> [f64; 3] {
        [self.tangents[0], self.tangents[1], self.normal].map(|axis| dot(axis, offset) / self.unit)
    }

    /// Square of how far a point lies off the sheet, relative to its distance.
    fn squared_residual(&self, offset: [f64; 3]) -> f64 {
        let squared_length = dot(offset, offset);
        if self.unit <= 0.0 || squared_length <= 0.0 {
            return 0.0;
        }
        let [x, y, z] = self.local(offset);
        let residual = z - product(&terms(x, y), &self.coefficients);
        residual * residual * self.unit * self.unit / squared_length
    }
}

fn product(terms: &[f64; 5], coefficients: &[f64; 5]) -> f64 {
    terms.iter().zip(coefficients).map(|(t, c)| t * c).sum()
}

/// Solves a positive definite system, of which the lower triangle is given, by Cholesky factors. Five unknowns, ten thousands of times: a library's
/// matrices would spend their time on memory.
fn solved(mut a: [[f64; 5]; 5], mut x: [f64; 5]) -> [f64; 5] {
    for j in 0..5 {
        for k in 0..j {
            for i in j..5 {
                a[i][j] -= a[i][k] * a[j][k];
            }
        }
        // The ridge keeps pivots positive.
        let root = a[j][j].sqrt();
        (j..5).for_each(|i| a[i][j] /= root);
    }
    for i in 0..5 {
        (0..i).for_each(|k| x[i] -= a[i][k] * x[k]);
        x[i] /= a[i][i];
    }
    for i in (0..5).rev() {
        (i + 1..5).for_each(|k| x[i] -= a[k][i] * x[k]);
        x[i] /= a[i][i];
    }
    x
}
