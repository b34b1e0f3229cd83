//! Solving with a sparse L̂ D L̂ᵀ for several right-hand sides side by side.

use faer::MatMut;
use faer::prelude::ReborrowMut;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;

/// Right-hand sides next to each other: one 256-bit register, or two of 128 bits.
pub(super) const LANES: usize = 4;
/// Rows of a panel that are kept in registers together.
const TILE: usize = 4;

type Row = [f64; LANES];

/// The factors of a supernodal factorisation in the order in which solving reads them.
///
/// faer's own solve calls a matrix product for every supernode, most of which are a few columns wide: of a cloud of 5000 points that takes
/// 0.25 ms natively for a right-hand side where this takes 0.14, and in WebAssembly products so small are not even vectorised.
pub(super) struct Sweeps {
    /// Row of the right-hand side at each place of the elimination order.
    order: Vec<u32>,
    supernodes: Vec<Supernode>,
    /// Rows below each supernode, made a multiple of [`TILE`] by a row that does not exist.
    rows: Vec<u32>,
    /// Of each supernode: the rows of its unit triangle, left of the diagonal; one over its diagonal; the tiles below, column by column.
    values: Vec<f64>,
    x: Vec<Row>,
}

/// Consecutive columns with the same rows below them.
struct Supernode {
    start: usize,
    width: usize,
    /// First of its rows, and of its values.
    rows: usize,
    values: usize,
}

impl Sweeps {
    /// Copies a factor. `order` (n) is the row that stands at each place of the elimination order.
    pub(super) fn new(factor: &SupernodalLdltRef<'_, usize, f64>, order: impl Iterator<Item = usize>) -> Self {
        let n = factor.symbolic().nrows();
        let mut this = Self {
            order: order.map(|row| row as u32).collect(),
            supernodes: Vec::with_capacity(factor.symbolic().n_supernodes()),
            rows: Vec::new(),
            values: Vec::with_capacity(factor.values().len()),
            x: vec![[0.0; LANES]; n + 1],
        };
        for s in 0..factor.symbolic().n_supernodes() {
            let supernode = factor.supernode(s);
            let (l, width) = (supernode.val(), supernode.val().ncols());
            let (rows, values) = (this.rows.len(), this.values.len());
            this.supernodes.push(Supernode { start: supernode.start(), width, rows, values });
            for i in 0..width {
                this.values.extend((0..i).map(|j| l[(i, j)]));
            }
            this.values.extend((0..width).map(|j| 1.0 / l[(j, j)]));
            for (tile, of) in supernode.pattern().chunks(TILE).enumerate() {
                this.rows.extend((0..TILE).map(|q| of.get(q).map_or(n, |&row| row) as u32));
                for j in 0..width {
                    let entry = |q: usize| if q < of.len() { l[(width + TILE * tile + q, j)] } else { 0.0 };
                    this.values.extend((0..TILE).map(entry));
                }
            }
        }
        this
    }

    /// Solves in place for the columns of `rhs` (n, b).
    pub(super) fn solve(&mut self, mut rhs: MatMut<'_, f64>) {
        for first in (0..rhs.ncols()).step_by(LANES) {
            let lanes = LANES.min(rhs.ncols() - first);
            for c in 0..lanes {
                let column = rhs.rb_mut().col_mut(first + c);
                self.x.iter_mut().zip(&self.order).for_each(|(x, &row)| x[c] = column[row as usize]);
            }
            pulp::Arch::new().dispatch(Both { factor: (&self.supernodes, &self.rows, &self.values), x: &mut self.x });
            for c in 0..lanes {
                let mut column = rhs.rb_mut().col_mut(first + c);
                self.x.iter().zip(&self.order).for_each(|(x, &row)| column[row as usize] = x[c]);
            }
        }
    }
}

/// Both sweeps as pulp wants them: a closure would not be inlined, and so be compiled for the plain instruction set.
struct Both<'a> {
    factor: (&'a [Supernode], &'a [u32], &'a [f64]),
    x: &'a mut [Row],
}

impl pulp::WithSimd for Both<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let (supernodes, rows, values) = self.factor;
        let ends = supernodes.iter().skip(1).map(|s| (s.rows, s.values)).chain([(rows.len(), values.len())]);
        for (s, (rows_end, values_end)) in supernodes.iter().zip(ends) {
            forward(s, &rows[s.rows..rows_end], &values[s.values..values_end], self.x);
        }
        let mut ends = (rows.len(), values.len());
        for s in supernodes.iter().rev() {
            backward(s, &rows[s.rows..ends.0], &values[s.values..ends.1], self.x);
            ends = (s.rows, s.values);
        }
    }
}

/// x ← D⁻¹ L̂⁻¹ x for the columns of one supernode.
#[inline(always)]
fn forward(s: &Supernode, rows: &[u32], values: &[f64], x: &mut [Row]) {
    let end = s.start + s.width;
    let (upper, below) = x.split_at_mut(end);
    let top = &mut upper[s.start..];
    let (triangle, rest) = values.split_at(s.width * (s.width - 1) / 2);
    let (inverse, tiles) = rest.split_at(s.width);
    let mut at = 0;
    for i in 1..s.width {
        let (known, row) = top.split_at_mut(i);
        let mut sum = [0.0; LANES];
        for (l, y) in triangle[at..at + i].iter().zip(known.iter()) {
            (0..LANES).for_each(|c| sum[c] += l * y[c]);
        }
        (0..LANES).for_each(|c| row[0][c] -= sum[c]);
        at += i;
    }
    for (tile, rows) in tiles.chunks_exact(TILE * s.width).zip(rows.chunks_exact(TILE)) {
        let mut sums = [[0.0; LANES]; TILE];
        for (l, y) in tile.as_chunks::<TILE>().0.iter().zip(top.iter()) {
            for q in 0..TILE {
                (0..LANES).for_each(|c| sums[q][c] += l[q] * y[c]);
            }
        }
        for q in 0..TILE {
            let row = &mut below[rows[q] as usize - end];
            (0..LANES).for_each(|c| row[c] -= sums[q][c]);
        }
    }
    for (y, d) in top.iter_mut().zip(inverse) {
        (0..LANES).for_each(|c| y[c] *= d);
    }
}

/// x ← L̂⁻ᵀ x for the columns of one supernode.
#[inline(always)]
fn backward(s: &Supernode, rows: &[u32], values: &[f64], x: &mut [Row]) {
    let end = s.start + s.width;
    let (upper, below) = x.split_at_mut(end);
    let top = &mut upper[s.start..];
    let (triangle, rest) = values.split_at(s.width * (s.width - 1) / 2);
    let tiles = &rest[s.width..];
    for (tile, rows) in tiles.chunks_exact(TILE * s.width).zip(rows.chunks_exact(TILE)) {
        let known: [Row; TILE] = std::array::from_fn(|q| below[rows[q] as usize - end]);
        for (l, y) in tile.as_chunks::<TILE>().0.iter().zip(top.iter_mut()) {
            for q in 0..TILE {
                (0..LANES).for_each(|c| y[c] -= l[q] * known[q][c]);
            }
        }
    }
    let mut at = triangle.len();
    for i in (1..s.width).rev() {
        at -= i;
        let (others, row) = top.split_at_mut(i);
        for (l, y) in triangle[at..at + i].iter().zip(others.iter_mut()) {
            (0..LANES).for_each(|c| y[c] -= l * row[0][c]);
        }
    }
}
