//! Block Lanczos with thick restarts (Wu & Simon 2000) for the eigenvalues of largest magnitude of an operator.
//!
//! The whole basis is kept orthogonal at every step, so the projected matrix VᵀAV is simply what orthogonalisation subtracted,
//! restarts and extra starting vectors need no special case, and clusters up to the block size come out together.

use faer::linalg::matmul::matmul;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, ColMut, Mat, MatMut, MatRef, Par, Side};

/// A correction this small beside what is left has lost no digits.
const SLIGHT: f64 = 1e-3;

/// A growing orthonormal basis V, and H = VᵀAV for those columns that A has been applied to.
pub(super) struct Lanczos<A> {
    /// Replaces the columns it is given by A times them.
    apply: A,
    basis: Mat<f64>,
    projected: Mat<f64>,
    /// Columns of V in use; the last `block` of them wait for A.
    filled: usize,
    block: usize,
    /// Columns that the block after them is coupled to.
    coupled: usize,
    /// R of the newest block: A V = V H + Q R on the last columns.
    coupling: Mat<f64>,
    random: Random,
    /// Blocks A has been applied to.
    pub(super) applications: usize,
}

/// Ritz pairs, largest magnitude first.
pub(super) struct Ritz {
    pub(super) values: Vec<f64>,
    /// Coefficients in the basis, one column per pair.
    coefficients: Mat<f64>,
    /// A x − θ x in terms of the waiting block (block, pairs).
    tails: Mat<f64>,
    /// ‖A x − θ x‖ per pair.
    pub(super) residuals: Vec<f64>,
}

impl<A: FnMut(MatMut<'_, f64>)> Lanczos<A> {
    /// Starts from `known` (n, any), orthonormal eigenvectors of A for the eigenvalue `value`, and one random block.
    /// `capacity` columns are the most that A is applied to.
    pub(super) fn new(apply: A, known: MatRef<'_, f64>, value: f64, block: usize, capacity: usize) -> Self {
        let n = known.nrows();
        let mut this = Self {
            apply,
            basis: Mat::zeros(n, capacity + block),
            projected: Mat::zeros(capacity + block, capacity + block),
            filled: 0,
            block,
            coupled: known.ncols(),
            coupling: Mat::zeros(block, block),
            random: Random(0x9E37_79B9_7F4A_7C15),
            applications: 0,
        };
        this.basis.subcols_mut(0, known.ncols()).copy_from(known);
        (0..known.ncols()).for_each(|j| this.projected[(j, j)] = value);
        this.filled = known.ncols();
        this.push_block(|_, _| ());
        this
    }

    /// Columns A has been applied to.
    pub(super) fn applied(&self) -> usize {
        self.filled - self.block
    }

    /// Whether another block fits.
    pub(super) fn has_room(&self) -> bool {
        self.filled + self.block <= self.basis.ncols()
    }

    /// One step: A times the waiting block, which becomes part of the projection; what is left waits next.
    pub(super) fn step(&mut self) {
        let remainder = self.apply_to_last_block();
        let before = self.filled;
        self.push_block(|column, j| column.copy_from(remainder.col(j)));
        // R = QᵀW: what the new orthonormal block carries of the remainder.
        matmul(
            self.coupling.as_mut(),
            Accum::Replace,
            self.basis.subcols(before, self.block).transpose(),
            remainder.as_ref(),
            1.0,
            Par::Seq,
        );
    }

    /// Computes A times the last block, writes its column of H, and returns what is orthogonal to the basis.
    fn apply_to_last_block(&mut self) -> Mat<f64> {
        let (m, b) = (self.filled, self.block);
        let mut w = self.basis.subcols(m - b, b).to_owned();
        (self.apply)(w.as_mut());
        self.applications += 1;
        let mut coefficients = Mat::<f64>::zeros(m, b);
        let mut subtract = |w: &mut Mat<f64>, from: usize| {
            let v = self.basis.subcols(from, m - from);
            let mut part = Mat::<f64>::zeros(m - from, b);
            matmul(part.as_mut(), Accum::Replace, v.transpose(), w.as_ref(), 1.0, Par::Seq);
            matmul(w.as_mut(), Accum::Add, v, part.as_ref(), -1.0, Par::Seq);
            let mut sum = coefficients.as_mut().subrows_mut(from, m - from);
            sum += &part;
            (0..b).all(|j| part.col(j).norm_l2() <= SLIGHT * w.col(j).norm_l2())
        };
        // What A couples the block to: the two newest, or after a restart everything. The rest is rounding, which a pass over all takes away,
        // and another where it was more than that: twice is enough (Giraud, Langou & Rozložník 2005).
        subtract(&mut w, if m - b <= self.coupled { 0 } else { m - 2 * b });
        if !subtract(&mut w, 0) {
            subtract(&mut w, 0);
        }
        for j in 0..b {
            for i in 0..m {
                self.projected[(i, m - b + j)] = coefficients[(i, j)];
                self.projected[(m - b + j, i)] = coefficients[(i, j)];
            }
        }
        w
    }

    /// Appends an orthonormal block: `fill` writes candidates into zeroed columns; columns it leaves at (nearly) nothing become random.
    fn push_block(&mut self, fill: impl Fn(&mut ColMut<'_, f64>, usize)) {
        for j in 0..self.block {
            let (done, rest) = self.basis.as_mut().split_at_col_mut(self.filled + j);
            let done = done.rb();
            let mut column = rest.col_mut(0);
            column.fill(0.0);
            fill(&mut column, j);
            let scale = column.norm_l2();
            // A candidate was orthogonal to all but its own block, and stays so unless most of it is subtracted.
            let within = done.subcols(self.filled, j);
            let kept = orthogonalise(column.rb_mut(), within);
            if kept > 0.1 * scale {
                let inverse = 1.0 / kept;
                column.rb_mut().iter_mut().for_each(|x| *x *= inverse);
                let inverse = 1.0 / orthogonalise(column.rb_mut(), within);
                column.rb_mut().iter_mut().for_each(|x| *x *= inverse);
                continue;
            }
            let mut left = orthogonalise(column.rb_mut(), done);
            let mut enough = (1e-13 * scale).max(f64::MIN_POSITIVE);
            // A random vector is dependent on the others with probability zero, so the second try is the last but for a broken operator.
            for _ in 0..4 {
                if left > enough {
                    break;
                }
                column.rb_mut().iter_mut().for_each(|x| *x = self.random.next());
                left = orthogonalise(column.rb_mut(), done);
                enough = 1e-8;
            }
            let inverse = 1.0 / left;
            column.rb_mut().iter_mut().for_each(|x| *x *= inverse);
            orthogonalise(column.rb_mut(), done);
            let inverse = 1.0 / column.norm_l2();
            column.rb_mut().iter_mut().for_each(|x| *x *= inverse);
        }
        self.filled += self.block;
    }

    /// Ritz pairs of everything A has been applied to.
    pub(super) fn ritz(&self) -> Option<Ritz> {
        let m = self.applied();
        let eigen = self.projected.submatrix(0, 0, m, m).self_adjoint_eigen(Side::Lower).ok()?;
        let theta = |j: usize| eigen.S()[j];
        let mut order: Vec<usize> = (0..m).collect();
        order.sort_by(|&i, &j| theta(j).abs().total_cmp(&theta(i).abs()));
        let coefficients = Mat::from_fn(m, m, |i, j| eigen.U()[(i, order[j])]);
        let values: Vec<f64> = order.iter().map(|&j| theta(j)).collect();
        let last = self.block.min(m);
        let tails = &self.coupling * coefficients.submatrix(m - last, 0, last, m);
        let residuals = (0..m).map(|j| tails.col(j).norm_l2()).collect();
        Some(Ritz { values, coefficients, tails, residuals })
    }

    /// A times Ritz vectors over their values (n, chosen): the Ritz vectors with their residual added, which costs no solve, and
    /// leaves ‖A⁻¹y − y/θ‖ = ‖r‖/θ² however much A⁻¹ amplifies (Ericsson & Ruhe 1980). Orthonormal to ‖r‖²/θ².
    pub(super) fn vectors(&self, ritz: &Ritz, chosen: &[usize]) -> Mat<f64> {
        let m = self.applied();
        let coefficients = Mat::from_fn(self.filled, chosen.len(), |i, c| {
            let j = chosen[c];
            if i < m { ritz.coefficients[(i, j)] } else { ritz.tails[(i - m, j)] / ritz.values[j] }
        });
        self.basis.subcols(0, self.filled) * coefficients
    }

    /// Keeps only the `chosen` Ritz vectors, and the waiting block, or a random one in its place when `afresh`.
    pub(super) fn restart(&mut self, ritz: &Ritz, chosen: &[usize], afresh: bool) {
        let (m, count) = (self.applied(), chosen.len());
        let coefficients = Mat::from_fn(m, count, |i, c| ritz.coefficients[(i, chosen[c])]);
        let kept = self.basis.subcols(0, m) * coefficients;
        let waiting = self.basis.subcols(m, self.block).to_owned();
        self.basis.subcols_mut(0, count).copy_from(&kept);
        self.projected.fill(0.0);
        for (at, &j) in chosen.iter().enumerate() {
            self.projected[(at, at)] = ritz.values[j];
        }
        self.filled = count;
        self.coupled = count;
        self.push_block(|column, j| {
            if !afresh {
                column.copy_from(waiting.col(j))
            }
        });
    }
}

/// Subtracts from `column` its part in the orthonormal columns `done` and returns the norm of what is left.
fn orthogonalise(mut column: ColMut<'_, f64>, done: MatRef<'_, f64>) -> f64 {
    if done.ncols() > 0 {
        let correction = done.transpose() * column.rb();
        matmul(column.rb_mut().as_mat_mut(), Accum::Add, done, correction.as_ref().as_mat(), -1.0, Par::Seq);
    }
    column.norm_l2()
}

/// A small deterministic generator (xorshift*) of numbers in [−1, 1): starting vectors only.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
