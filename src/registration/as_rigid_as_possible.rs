//! As-rigid-as-possible deformation (Sorkine & Alexa 2007): a body follows targets while its surroundings turn, but do not stretch.
//!
//! Rotations are smoothed over neighbours (Levi & Gotsman 2015 penalise their differences; here neighbours share covariances), which gives a
//! surface some stiffness against bending.

use std::borrow::Cow;

use sprs::CsMat;

use super::alignment::{Rotation, turned};
use crate::spectrum::Pencil;
use crate::vector::{Vector, cross, dot, minus, norm, plus};

/// Local and global steps per deformation: more change nothing, because targets move more.
const STEPS: usize = 3;
/// Most turns on the way to the nearest rotation; from that of the step before, a few are enough.
const TURNS: usize = 30;
/// A turn of less than this (radians) is none.
const STILL: f64 = 1e-9;

/// Points of a body at rest and which of them hold on to each other.
pub(super) struct DeformationGraph {
    rest: Vec<Vector>,
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    /// Graph Laplacian (s, s), ordered once for all factorisations. `None` when there was no memory for it.
    pencil: Option<Pencil<'static>>,
}

/// Where the points of a body go, and how their surroundings turn on the way.
#[derive(Clone, Debug)]
pub(super) struct Deformation {
    /// Positions (s, 3).
    pub(super) positions: Vec<Vector>,
    /// Unit quaternions (s), scalar first.
    turns: Vec<Quaternion>,
}

type Quaternion = [f64; 4];

impl DeformationGraph {
    /// `adjacent` are pairs of rows of `rest` (s, 3), each once.
    pub(super) fn new(rest: Vec<Vector>, adjacent: &[[u32; 2]]) -> Self {
        let n = rest.len();
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n];
        for &[i, j] in adjacent {
            rows[i as usize].push(j);
            rows[j as usize].push(i);
        }
        let (mut starts, mut neighbours) = (vec![0], Vec::with_capacity(2 * adjacent.len()));
        let (mut indptr, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for (i, row) in rows.iter_mut().enumerate() {
            row.sort_unstable();
            row.dedup();
            row.retain(|&j| j as usize != i);
            neighbours.extend_from_slice(row);
            starts.push(neighbours.len());
            let before = row.partition_point(|&j| (j as usize) < i);
            indices.extend(row[..before].iter().map(|&j| j as usize));
            indices.push(i);
            indices.extend(row[before..].iter().map(|&j| j as usize));
            values.extend(std::iter::repeat_n(-1.0, row.len() + 1));
            values[indptr[i] + before] = row.len() as f64;
            indptr.push(indices.len());
        }
        let laplacian = CsMat::new((n, n), indptr, indices, values);
        let pencil = Pencil::new(Cow::Owned(laplacian), Cow::Owned(vec![1.0; n]));
        Self { rest, starts, neighbours, pencil }
    }

    /// Positions at rest (s, 3).
    pub(super) fn rest(&self) -> &[Vector] {
        &self.rest
    }

    /// Points, s.
    pub(super) fn len(&self) -> usize {
        self.rest.len()
    }

    /// Rows that hold on to row `i`, ascending.
    pub(super) fn neighbours(&self, i: usize) -> &[u32] {
        &self.neighbours[self.starts[i]..self.starts[i + 1]]
    }

    /// Positions as they are, the turns still to be found from that of the whole body.
    pub(super) fn start_at(&self, positions: Vec<Vector>, whole: &Rotation) -> Deformation {
        let turns = vec![quaternion(whole); positions.len()];
        Deformation { positions, turns }
    }

    /// min Σ wᵢ|xᵢ − yᵢ|² + μ Σ |(xᵢ − xⱼ) − ½(Rᵢ + Rⱼ)(pᵢ − pⱼ)|² over the pairs that hold on to each other, from `start` on. `targets` y (s, 3),
    /// `weights` w (s) positive, `stiffness` μ. Stays at `start` if the system cannot be factored.
    pub(super) fn deform(
        &self,
        targets: &[Vector],
        weights: &[f64],
        stiffness: f64,
        start: Deformation,
    ) -> Deformation {
        let mut deformed = start;
        let pull: Vec<f64> = weights.iter().map(|w| w / stiffness).collect();
        let Some(mut factor) = self.pencil.as_ref().and_then(|pencil| pencil.factor_with(&pull)) else {
            return deformed;
        };
        let n = self.len();
        let mut right = faer::Mat::<f64>::zeros(n, 3);
        let mut covariances = vec![[[0.0; 3]; 3]; n];
        for _ in 0..STEPS {
            let rotations = self.turn(&mut deformed, &mut covariances);
            for i in 0..n {
                let mut sum = targets[i].map(|y| pull[i] * y);
                for &j in self.neighbours(i) {
                    let j = j as usize;
                    let edge = minus(self.rest[i], self.rest[j]);
                    let both = plus(turned(&rotations[i], edge), turned(&rotations[j], edge));
                    (0..3).for_each(|c| sum[c] += 0.5 * both[c]);
                }
                (0..3).for_each(|c| right[(i, c)] = sum[c]);
            }
            factor.solve(right.as_mut());
            for (i, position) in deformed.positions.iter_mut().enumerate() {
                *position = std::array::from_fn(|c| right[(i, c)]);
            }
        }
        self.turn(&mut deformed, &mut covariances);
        deformed
    }

    /// Turns every point's surroundings to where its positions ask for. `covariances` is scratch space (s).
    fn turn(&self, deformed: &mut Deformation, covariances: &mut [[Vector; 3]]) -> Vec<Rotation> {
        let x = &deformed.positions;
        for (i, covariance) in covariances.iter_mut().enumerate() {
            *covariance = [[0.0; 3]; 3];
            for &j in self.neighbours(i) {
                let (to, from) = (minus(x[i], x[j as usize]), minus(self.rest[i], self.rest[j as usize]));
                for p in 0..3 {
                    (0..3).for_each(|q| covariance[p][q] += to[p] * from[q]);
                }
            }
        }
        for i in 0..self.len() {
            let mut smooth = covariances[i];
            for &j in self.neighbours(i) {
                for (row, other) in smooth.iter_mut().zip(&covariances[j as usize]) {
                    (0..3).for_each(|q| row[q] += other[q]);
                }
            }
            deformed.turns[i] = nearest_rotation(&smooth, deformed.turns[i]);
        }
        deformed.rotations()
    }
}

impl Deformation {
    /// Rotations (s).
    pub(super) fn rotations(&self) -> Vec<Rotation> {
        self.turns.iter().map(matrix).collect()
    }
}

/// The rotation nearest to a matrix, sought from `q` on by Newton's method for the largest trace of RᵀA; where that is not concave, by the steps of Müller et
/// al. 2016 ("A robust method to extract the rotational part of deformations"). What a flat or straight neighbourhood leaves open stays as it was.
/// Rational, so it is the same on every machine, and several times as fast as a singular value decomposition.
fn nearest_rotation(a: &[Vector; 3], mut q: Quaternion) -> Quaternion {
    for _ in 0..TURNS {
        let r = matrix(&q);
        // A Rᵀ: symmetric where R is the nearest rotation.
        let m: [Vector; 3] = std::array::from_fn(|i| std::array::from_fn(|j| dot(a[i], r[j])));
        let trace = m[0][0] + m[1][1] + m[2][2];
        let axis = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
        let hessian: [Vector; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { (1.0 + 1e-9) * trace } else { 0.0 } - 0.5 * (m[i][j] + m[j][i]))
        });
        let turn = newton_step(&hessian, axis).unwrap_or_else(|| {
            // Beyond half a turn the length says nothing.
            let scale = trace.abs().max(0.5 * norm(axis)).max(f64::MIN_POSITIVE);
            axis.map(|x| x / scale)
        });
        let angle = norm(turn);
        if !(STILL..f64::MAX).contains(&angle) {
            break;
        }
        q = unit(product([1.0, 0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2]], q));
    }
    q
}

/// H⁻¹ g for a positive definite H; none for others.
fn newton_step(h: &[Vector; 3], g: Vector) -> Option<Vector> {
    let first = cross(h[1], h[2]);
    let (determinant, minor) = (dot(h[0], first), h[0][0] * h[1][1] - h[0][1] * h[1][0]);
    if !(h[0][0] > 0.0 && minor > 0.0 && determinant > 0.0) {
        return None;
    }
    // The columns of the inverse are those cross products of rows.
    let (second, third) = (cross(h[2], h[0]), cross(h[0], h[1]));
    Some(std::array::from_fn(|c| (g[0] * first[c] + g[1] * second[c] + g[2] * third[c]) / determinant))
}

fn matrix(&[w, x, y, z]: &Quaternion) -> Rotation {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// Of a rotation; the largest of the four parts is found first, for the sake of rounding.
fn quaternion(r: &Rotation) -> Quaternion {
    let [xx, yy, zz] = [r[0][0], r[1][1], r[2][2]];
    let squares = [1.0 + xx + yy + zz, 1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz];
    let largest = (1..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let s = squares[largest];
    unit(match largest {
        0 => [s, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]],
        1 => [r[2][1] - r[1][2], s, r[0][1] + r[1][0], r[0][2] + r[2][0]],
        2 => [r[0][2] - r[2][0], r[0][1] + r[1][0], s, r[1][2] + r[2][1]],
        _ => [r[1][0] - r[0][1], r[0][2] + r[2][0], r[1][2] + r[2][1], s],
    })
}

fn product([a, b, c, d]: Quaternion, [e, f, g, h]: Quaternion) -> Quaternion {
    [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]
}

fn unit(q: Quaternion) -> Quaternion {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::super::alignment::{Rotation, turned};
    use super::{DeformationGraph, STILL, Vector, matrix, nearest_rotation, quaternion, unit};
    use crate::vector::{minus, norm, plus, squared_distance};

    /// A tube of radius 1 along x, 60 rings of 12 points, each holding on to those of the next ring and of its own.
    fn rod() -> (Vec<Vector>, Vec<[u32; 2]>) {
        let (mut points, mut adjacent) = (Vec::new(), Vec::new());
        for ring in 0..60_u32 {
            for step in 0..12_u32 {
                let (s, c) = (f64::from(step) / 12.0 * std::f64::consts::TAU).sin_cos();
                points.push([0.5 * f64::from(ring), c, s]);
                let at = |ring: u32, step: u32| 12 * ring + step % 12;
                let (own, next) = (at(ring, step), at(ring, step + 1));
                adjacent.push([own.min(next), own.max(next)]);
                if ring + 1 < 60 {
                    adjacent.extend([[own, at(ring + 1, step)], [own, at(ring + 1, step + 1)]]);
                }
            }
        }
        (points, adjacent)
    }

    fn turn() -> Rotation {
        matrix(&unit([0.3, -0.5, 0.7, 0.4]))
    }

    /// Root mean square of the relative change of edge lengths.
    fn strain(graph: &DeformationGraph, adjacent: &[[u32; 2]], x: &[Vector]) -> f64 {
        let length = |x: &[Vector], [i, j]: [u32; 2]| norm(minus(x[i as usize], x[j as usize]));
        let square = |&edge: &[u32; 2]| (length(x, edge) / length(graph.rest(), edge) - 1.0).powi(2);
        (adjacent.iter().map(square).sum::<f64>() / adjacent.len() as f64).sqrt()
    }

    #[test]
    fn a_body_that_only_moves_is_put_exactly_there() {
        let (rest, adjacent) = rod();
        let graph = DeformationGraph::new(rest.clone(), &adjacent);
        let moved: Vec<Vector> = rest.iter().map(|&p| plus(turned(&turn(), p), [3.0, -7.0, 2.0])).collect();
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for stiffness in [0.1, 10.0, 1000.0] {
            let start = graph.start_at(moved.clone(), &identity);
            let weights: Vec<f64> = (0..rest.len()).map(|i| if i % 3 == 0 { 1.0 } else { 0.02 }).collect();
            let deformed = graph.deform(&moved, &weights, stiffness, start);
            let worst =
                deformed.positions.iter().zip(&moved).map(|(&x, &y)| squared_distance(x, y).sqrt()).fold(0.0, f64::max);
            assert!(worst < 1e-7, "μ = {stiffness}: {worst}");
            let off = |r: &Rotation| r.iter().flatten().zip(turn().as_flattened()).any(|(r, t)| (r - t).abs() > 1e-7);
            assert!(!deformed.rotations().iter().any(off), "μ = {stiffness}");
        }
    }

    #[test]
    fn a_bent_rod_keeps_its_lengths_better_than_its_smoothed_targets_do() {
        let (rest, adjacent) = rod();
        let graph = DeformationGraph::new(rest.clone(), &adjacent);
        // Bent along a quarter of a circle, and then smoothed as a few eigenfunctions would: thinner, and its bend cut short.
        let radius = 29.5 / (0.5 * std::f64::consts::PI);
        let bent = |&[x, y, z]: &Vector| {
            let (s, c) = (x / radius).sin_cos();
            [(radius - y) * s, radius - (radius - y) * c, z]
        };
        let truth: Vec<Vector> = rest.iter().map(bent).collect();
        let mut targets = truth.clone();
        for _ in 0..2 {
            let before = targets.clone();
            for (i, target) in targets.iter_mut().enumerate() {
                let near = graph.neighbours(i);
                let sum = near.iter().fold([0.0; 3], |sum, &j| plus(sum, before[j as usize]));
                *target = sum.map(|c| c / near.len() as f64);
            }
        }
        let start = graph.start_at(targets.clone(), &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let deformed = graph.deform(&targets, &vec![1.0; rest.len()], 10.0, start);
        let (smooth, rigid) = (strain(&graph, &adjacent, &targets), strain(&graph, &adjacent, &deformed.positions));
        println!("strain of the targets {smooth:.3}, of the rod {rigid:.3}, of the truth {:.3}", {
            strain(&graph, &adjacent, &truth)
        });
        assert!(smooth > 0.1 && rigid < 0.4 * smooth, "{smooth} {rigid}");
    }

    #[test]
    fn a_rotation_is_found_from_afar_and_what_nothing_determines_stays() {
        let near = |r: &Rotation, s: &Rotation| {
            r.iter().flatten().zip(s.iter().flatten()).all(|(x, y)| (x - y).abs() < 100.0 * STILL)
        };
        let aim = turn();
        let stretched: Rotation = std::array::from_fn(|i| std::array::from_fn(|j| [3.0, 2.0, 0.1][j] * aim[i][j]));
        for start in [[1.0, 0.0, 0.0, 0.0], [0.1, 0.9, 0.1, -0.4], [-0.5, 0.5, 0.5, 0.5]] {
            assert!(near(&matrix(&nearest_rotation(&stretched, unit(start))), &aim), "from {start:?}");
        }
        let nothing = [[0.0; 3]; 3];
        let q = unit([0.2, 0.4, -0.6, 0.8]);
        assert_eq!(nearest_rotation(&nothing, q), q);
        for r in [matrix(&q), matrix(&[0.0, 1.0, 0.0, 0.0]), matrix(&[0.0, 0.0, 0.0, 1.0]), aim] {
            assert!(near(&matrix(&quaternion(&r)), &r));
        }
    }
}
