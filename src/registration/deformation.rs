//! Non-rigid registration of each body of a pair to the other, by the match at hand.

use ndarray::Array2;

use super::alignment::{Rotation, best_rotation, turned};
use super::as_rigid_as_possible::{Deformation, DeformationGraph};
use crate::maps::{Matchable, smoothed, smoothed_where};
use crate::vector::{Vector, minus, norm, plus, squared_distance};

/// Eigenfunctions that the first guess of a deformation is smoothed by.
const SMOOTH: usize = 60;
/// Distance at which going there and back again costs e^−½ of a target's weight, in √area: about a hand's width on a person.
const CYCLE_SCALE: f64 = 0.05;
/// Weight of a target that nothing confirms: just enough to say something where nothing else does.
const LEAST_WEIGHT: f64 = 0.02;
/// The same where one of the bodies is a piece, so that points may have no target at all.
const LEAST_WEIGHT_OF_PIECES: f64 = 0.001;
/// There, how much an eigenfunction costs in the first guess, by its eigenvalue, beside one sample.
const SMOOTHNESS: f64 = 0.1;

/// One body of the pair.
struct Body<'m> {
    shape: &'m Matchable,
    graph: DeformationGraph,
    deformed: Option<Deformation>,
}

/// A and B, each deformed onto the other.
pub(super) struct Registration<'m> {
    bodies: [Body<'m>; 2],
    /// Whether the signs of normals can be compared.
    oriented: bool,
    /// Whether both are whole, so that every point has a target.
    whole: bool,
    /// Points of a sampling that stiffness is meant for.
    full: f64,
}

/// What is compared of one body, at some of its points (rows).
pub(super) struct Columns {
    /// Positions at rest (rows, 3).
    pub(super) rest: Array2<f32>,
    /// Positions (rows, 3) on the other body.
    pub(super) registered: Array2<f32>,
    /// Normals at rest: (rows, 3), or (rows, 6) where signs mean nothing.
    pub(super) normals: Array2<f32>,
    /// Normals as they turn on the way to the other body.
    pub(super) turned: Array2<f32>,
}

impl<'m> Registration<'m> {
    pub(super) fn new(a: &'m Matchable, b: &'m Matchable, full: usize) -> Self {
        let bodies = [a, b].map(|shape| {
            let rest = shape.coarse.iter().map(|&row| place(shape, row as usize)).collect();
            Body { shape, graph: DeformationGraph::new(rest, &shape.surface.adjacent), deformed: None }
        });
        let (oriented, whole) = (a.surface.oriented && b.surface.oriented, a.share.min(b.share) == 1.0);
        Self { bodies, oriented, whole, full: full as f64 }
    }

    /// Registers both to each other by a match of their samplings: rows of B for those of A, and the other way round. `stiffness` is meant for a sampling of
    /// `full` points; fewer hold each other over longer distances.
    pub(super) fn follow(&mut self, to_b: &[u32], to_a: &[u32], stiffness: f64) {
        let (whole, [a, b]) = (self.whole, &mut self.bodies);
        let (rest_a, rest_b) = (a.graph.rest().to_vec(), b.graph.rest().to_vec());
        let stiffness = |body: &Body| stiffness * body.graph.len() as f64 / self.full;
        let (stiff_a, stiff_b) = (stiffness(a), stiffness(b));
        a.follow(&rest_b, to_b, to_a, stiff_a, whole);
        b.follow(&rest_a, to_a, to_b, stiff_b, whole);
    }

    /// At the samplings.
    pub(super) fn coarse(&self) -> [Columns; 2] {
        [0, 1].map(|side| {
            let Body { shape, graph, deformed } = &self.bodies[side];
            let deformed = deformed.as_ref().expect("registered before it is looked at");
            let rows = shape.coarse.iter().zip(deformed.positions.iter().zip(deformed.rotations()));
            let normals = |row: u32| shape.surface.normals[row as usize];
            let registered = rows.map(|(&row, (&x, r))| (x, turned(&r, normals(row)))).collect::<Vec<_>>();
            self.columns(graph.rest(), shape.coarse.iter().map(|&row| normals(row)), &registered)
        })
    }

    /// At all points used.
    pub(super) fn everywhere(&self) -> [Columns; 2] {
        [0, 1].map(|side| {
            let body = &self.bodies[side];
            let rest: Vec<Vector> = (0..body.shape.len()).map(|row| place(body.shape, row)).collect();
            self.columns(&rest, body.shape.surface.normals.iter().copied(), &body.spread(&rest))
        })
    }

    fn columns(
        &self,
        rest: &[Vector],
        normals: impl Iterator<Item = Vector>,
        registered: &[(Vector, Vector)],
    ) -> Columns {
        Columns {
            rest: table(rest.iter().copied()),
            registered: table(registered.iter().map(|&(x, _)| x)),
            normals: self.normal_columns(normals),
            turned: self.normal_columns(registered.iter().map(|&(_, n)| n)),
        }
    }

    /// Normals, or n nᵀ without them: |n nᵀ − m mᵀ|² = 2 − 2 (n·m)².
    fn normal_columns(&self, normals: impl Iterator<Item = Vector>) -> Array2<f32> {
        if self.oriented {
            return table(normals);
        }
        let root = 2.0_f64.sqrt();
        table(normals.map(|[x, y, z]| [x * x, y * y, z * z, root * x * y, root * x * z, root * y * z]))
    }
}

impl Body<'_> {
    fn follow(&mut self, other: &[Vector], there: &[u32], back: &[u32], stiffness: f64, whole: bool) {
        let rest = self.graph.rest();
        let least = if whole { LEAST_WEIGHT } else { LEAST_WEIGHT_OF_PIECES };
        let targets: Vec<Vector> = there.iter().map(|&j| other[j as usize]).collect();
        let weights: Vec<f64> = there
            .iter()
            .zip(rest)
            .map(|(&j, &x)| {
                let squared = squared_distance(rest[back[j as usize] as usize], x);
                (-squared / (2.0 * CYCLE_SCALE * CYCLE_SCALE)).exp() + least
            })
            .collect();
        let confirmed = || weights.iter().map(|weight| weight - least).collect::<Vec<_>>();
        let start = self.deformed.take().unwrap_or_else(|| self.guess(&targets, (!whole).then(confirmed)));
        // Without memory for the factorisation the body stays where it was, or where the smooth targets are.
        self.deformed = Some(self.graph.deform(&targets, &weights, stiffness, start));
    }

    /// Targets as smooth as the first eigenfunctions are, those with weights only as far as a target is confirmed, and the turn of the body as a whole.
    fn guess(&self, targets: &[Vector], weights: Option<Vec<f64>>) -> Deformation {
        let k = SMOOTH.min(self.shape.basis.k());
        let (phi, targets) = (self.shape.phi_at(&self.shape.coarse, k), wide(targets));
        let smooth = match weights {
            None => smoothed(phi.view(), targets.view()),
            Some(weights) => {
                let cost = |j: usize| SMOOTHNESS * self.shape.basis.eigenvalues[j];
                smoothed_where(phi.view(), targets.view(), &weights, cost)
            }
        };
        let (whole, _) = best_rotation(wide(self.graph.rest()).view(), smooth.view());
        let positions = smooth.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
        self.graph.start_at(positions, &whole)
    }

    /// Where every point used goes, and its normal: by the rigid motions of the samples around it, nearer ones counting more, so that samples go exactly
    /// where they were put.
    fn spread(&self, rest: &[Vector]) -> Vec<(Vector, Vector)> {
        let deformed = self.deformed.as_ref().expect("registered before it is looked at");
        let rotations = deformed.rotations();
        let samples = self.graph.rest();
        let moved = |at: usize, x: Vector, n: Vector| -> (Vector, Vector) {
            let r: &Rotation = &rotations[at];
            (plus(deformed.positions[at], turned(r, minus(x, samples[at]))), turned(r, n))
        };
        let surface = &self.shape.surface;
        rest.iter()
            .zip(surface.normals.iter().zip(&surface.cell))
            .map(|(&x, (&n, &cell))| {
                let (mut position, mut normal, mut total) = ([0.0; 3], [0.0; 3], 0.0);
                for &near in std::iter::once(&cell).chain(self.graph.neighbours(cell as usize)) {
                    let squared = squared_distance(x, samples[near as usize]);
                    let weight = 1.0 / (squared * squared).max(1e-18);
                    let (y, m) = moved(near as usize, x, n);
                    (0..3).for_each(|c| position[c] += weight * y[c]);
                    (0..3).for_each(|c| normal[c] += weight * m[c]);
                    total += weight;
                }
                let length = norm(normal).max(f64::MIN_POSITIVE);
                (position.map(|c| c / total), normal.map(|c| c / length))
            })
            .collect()
    }
}

fn place(shape: &Matchable, row: usize) -> Vector {
    std::array::from_fn(|c| shape.points[(row, c)])
}

fn table<const C: usize>(rows: impl Iterator<Item = [f64; C]>) -> Array2<f32> {
    let values: Vec<f32> = rows.flat_map(|row| row.map(|v| v as f32)).collect();
    Array2::from_shape_vec((values.len() / C, C), values).expect("whole rows")
}

fn wide(rows: &[Vector]) -> Array2<f64> {
    Array2::from_shape_fn((rows.len(), 3), |(i, c)| rows[i][c])
}
