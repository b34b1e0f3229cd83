//! Nearest rows of two matrices, both ways, in one pass over tiles.

use ndarray::{ArrayView2, Axis};

/// Candidates handled side by side: two 128-bit registers. Four would spill.
const LANES: usize = 8;
/// Queries handled together by the innermost loop, so that 4 × 8 sums stay in registers.
const ROWS: usize = 4;
/// Queries that stay in cache while all candidates pass.
const TILE: usize = 64;

/// For each row of `x` the nearest row of `y`, and the other way round, with the widest vectors of the machine.
///
/// Compiled for plain x86-64 it did 22 GFlop/s by itself but 6 in the middle of a match, probably because faer leaves the upper halves of
/// wide registers in use. This way a match of two bodies of 5000 points takes 1.2 s natively instead of 7, with the same bytes.
pub(super) fn nearest_rows(x: ArrayView2<f32>, y: ArrayView2<f32>) -> (Vec<u32>, Vec<u32>) {
    pulp::Arch::new().dispatch(Comparison { x, y })
}

/// The work as pulp wants it. A closure would not be inlined, and so be compiled for the plain instruction set after all.
struct Comparison<'a> {
    x: ArrayView2<'a, f32>,
    y: ArrayView2<'a, f32>,
}

impl pulp::WithSimd for Comparison<'_> {
    type Output = (Vec<u32>, Vec<u32>);

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        compare(self.x, self.y)
    }
}

/// For each row of `x` the nearest row of `y`, and the other way round. ‖x − y‖² = ‖x‖² + ‖y‖² − 2 x·y; ties go to the lower index.
#[inline(always)]
fn compare(x: ArrayView2<f32>, y: ArrayView2<f32>) -> (Vec<u32>, Vec<u32>) {
    assert_eq!(x.ncols(), y.ncols(), "rows to compare have one length");
    let (n, m, d) = (x.nrows(), y.nrows(), x.ncols());
    let queries = pad(x, ROWS);
    let panels = panels(y);
    let squares = |a: ArrayView2<f32>| -> Vec<f32> { a.axis_iter(Axis(0)).map(|row| row.dot(&row)).collect() };
    let (x_squares, mut y_squares) = (squares(x), squares(y));
    // Padding candidates are infinitely far away.
    y_squares.resize(m.next_multiple_of(LANES), f32::INFINITY);

    let mut best_of_x = vec![(f32::INFINITY, 0u32); n];
    let mut best_of_y = vec![(f32::INFINITY, 0u32); m];
    for tile in (0..n).step_by(TILE) {
        for (p, panel) in panels.chunks_exact(d * LANES).enumerate() {
            let first = p * LANES;
            for i in (tile..n.min(tile + TILE)).step_by(ROWS) {
                let products = products(&queries[i * d..(i + ROWS) * d], panel, d);
                for (query, products) in (i..n).zip(&products) {
                    let distances: [f32; LANES] =
                        std::array::from_fn(|c| x_squares[query] + y_squares[first + c] - 2.0 * products[c]);
                    let least = distances.into_iter().fold(f32::INFINITY, |a, b| if b < a { b } else { a });
                    if least < best_of_x[query].0 {
                        let c = distances.iter().position(|&distance| distance == least).unwrap_or(0);
                        best_of_x[query] = (least, (first + c) as u32);
                    }
                    for (best, distance) in best_of_y[first..].iter_mut().zip(distances) {
                        if distance < best.0 {
                            *best = (distance, query as u32);
                        }
                    }
                }
            }
        }
    }
    let indices = |best: Vec<(f32, u32)>| best.into_iter().map(|(_, index)| index).collect();
    (indices(best_of_x), indices(best_of_y))
}

/// Dot products of ROWS queries (each d long) with the LANES candidates of a panel (d, LANES).
#[inline(always)]
fn products(queries: &[f32], panel: &[f32], d: usize) -> [[f32; LANES]; ROWS] {
    let mut sums = [[0.0; LANES]; ROWS];
    let (first, rest) = queries.split_at(d);
    let (second, rest) = rest.split_at(d);
    let (third, fourth) = rest.split_at(d);
    // Zipped rather than indexed: one bounds check less per product is a factor of four here.
    let values = first.iter().zip(second).zip(third).zip(fourth);
    for (candidates, (((&a, &b), &c), &d)) in panel.as_chunks::<LANES>().0.iter().zip(values) {
        for lane in 0..LANES {
            sums[0][lane] += a * candidates[lane];
            sums[1][lane] += b * candidates[lane];
            sums[2][lane] += c * candidates[lane];
            sums[3][lane] += d * candidates[lane];
        }
    }
    sums
}

/// Candidates as panels of LANES columns: panel p holds value t of candidate p·LANES + c at (t, c).
fn panels(y: ArrayView2<f32>) -> Vec<f32> {
    let (m, d) = y.dim();
    let mut packed = vec![0.0; m.next_multiple_of(LANES) * d];
    for (j, row) in y.rows().into_iter().enumerate() {
        let panel = &mut packed[j / LANES * LANES * d..];
        for (t, &value) in row.iter().enumerate() {
            panel[t * LANES + j % LANES] = value;
        }
    }
    packed
}

/// Row-major values with zero rows up to a multiple of `rows`.
fn pad(x: ArrayView2<f32>, rows: usize) -> Vec<f32> {
    let mut values: Vec<f32> = x.iter().copied().collect();
    values.resize(x.nrows().next_multiple_of(rows) * x.ncols(), 0.0);
    values
}
