//! As-rigid-as-possible deformation (Sorkine & Alexa 2007): a body follows targets while its surroundings turn, but do not stretch.
//!
//! Rotations are smoothed over neighbours (Levi & Gotsman 2015 penalise their differences; here neighbours share covariances), which gives a
//! surface some stiffness against bending.

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
pub(super) struct Elastic {
    rest: Vec<Vector>,
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    /// Graph Laplacian (s, s), every diagonal entry stored.
    laplacian: CsMat<f64>,
    ones: Vec<f64>,
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

impl Elastic {
    /// `touching` are pairs of rows of `rest` (s, 3), each once.
    pub(super) fn new(rest: Vec<Vector>, touching: &[[u32; 2]]) -> Self {
        let n = rest.len();
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n];
        for &[i, j] in touching {
            rows[i as usize].push(j);
            rows[j as usize].push(i);
        }
        let (mut starts, mut neighbours) = (vec![0], Vec::with_capacity(2 * touching.len()));
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
        Self { rest, starts, neighbours, laplacian, ones: vec![1.0; n] }
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

    /// What all factorisations share. `None` when memory for it cannot be had.
    pub(super) fn pencil(&self) -> Option<Pencil<'_>> {
        Pencil::new(&self.laplacian, &self.ones)
    }

    /// Positions as they are, the turns still to be found from that of the whole body.
    pub(super) fn laid_at(&self, positions: Vec<Vector>, whole: &Rotation) -> Deformation {
        let turns = vec![quaternion(whole); positions.len()];
        Deformation { positions, turns }
    }

    /// min Σ wᵢ|xᵢ − yᵢ|² + μ Σ |(xᵢ − xⱼ) − ½(Rᵢ + Rⱼ)(pᵢ − pⱼ)|² over the pairs that hold on to each other, from `start` on. `targets` y (s, 3),
    /// `weights` w (s) positive, `stiffness` μ. Stays at `start` if the system cannot be factored.
    pub(super) fn deform(
        &self,
        pencil: &Pencil<'_>,
        targets: &[Vector],
        weights: &[f64],
        stiffness: f64,
        start: Deformation,
    ) -> Deformation {
        let mut deformed = start;
        let pull: Vec<f64> = weights.iter().map(|w| w / stiffness).collect();
        let Some(mut factor) = pencil.factor_with(&pull) else { return deformed };
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

/// The rotation nearest to a matrix, sought from `q` on (Müller et al. 2016, "A robust method to extract the rotational part of deformations"). What
/// a flat or straight neighbourhood leaves open stays as it was. Rational, so it is the same on every machine.
fn nearest_rotation(a: &[Vector; 3], mut q: Quaternion) -> Quaternion {
    let column = |m: &[Vector; 3], c: usize| [m[0][c], m[1][c], m[2][c]];
    for _ in 0..TURNS {
        let r = matrix(&q);
        let (mut axis, mut agreement) = ([0.0; 3], 0.0);
        for c in 0..3 {
            axis = plus(axis, cross(column(&r, c), column(a, c)));
            agreement += dot(column(&r, c), column(a, c));
        }
        let angle = norm(axis) / agreement.abs().max(f64::MIN_POSITIVE);
        // Nothing to turn by, or nothing to turn.
        if !(STILL..f64::MAX).contains(&angle) {
            break;
        }
        // A half turn at most: beyond that the length says nothing.
        let half = axis.map(|x| 0.5 * x / agreement.abs().max(0.5 * norm(axis)));
        q = unit(product([1.0, half[0], half[1], half[2]], q));
    }
    q
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
