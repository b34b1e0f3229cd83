//! Nearest rows of two matrices, both ways, in one pass over tiles.

use ndarray::{ArrayView2, Axis};

/// Candidates handled side by side: two vector registers of the target.
const LANES: usize = if cfg!(target_arch = "wasm32") { 8 } else { 16 };
/// Queries handled together by the innermost loop.
const ROWS: usize = 4;
/// Queries that stay in cache while all candidates pass.
const TILE: usize = 64;

/// For each row of `x` the nearest row of `y`, and the other way round. ‖x − y‖² = ‖x‖² + ‖y‖² − 2 x·y; ties go to the lower index.
pub(super) fn nearest_rows(x: ArrayView2<f32>, y: ArrayView2<f32>) -> (Vec<u32>, Vec<u32>) {
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
    pulp::Arch::new().dispatch(|| {
        for tile in (0..n).step_by(TILE) {
            for (p, panel) in panels.chunks_exact(d * LANES).enumerate() {
                let first = p * LANES;
                for i in (tile..n.min(tile + TILE)).step_by(ROWS) {
                    let products = products(&queries[i * d..(i + ROWS) * d], panel, d);
                    for (r, products) in products.iter().enumerate().take(n - i) {
                        let query = i + r;
                        let best = &mut best_of_x[query];
                        for (c, &product) in products.iter().enumerate().take(m - first) {
                            let candidate = first + c;
                            let distance = x_squares[query] + y_squares[candidate] - 2.0 * product;
                            if distance < best.0 {
                                *best = (distance, candidate as u32);
                            }
                            if distance < best_of_y[candidate].0 {
                                best_of_y[candidate] = (distance, query as u32);
                            }
                        }
                    }
                }
            }
        }
    });
    let indices = |best: Vec<(f32, u32)>| best.into_iter().map(|(_, index)| index).collect();
    (indices(best_of_x), indices(best_of_y))
}

/// Dot products of ROWS queries (each d long) with the LANES candidates of a panel (d, LANES).
#[inline(always)]
fn products(queries: &[f32], panel: &[f32], d: usize) -> [[f32; LANES]; ROWS] {
    let mut sums = [[0.0; LANES]; ROWS];
    let rows: [&[f32]; ROWS] = std::array::from_fn(|r| &queries[r * d..(r + 1) * d]);
    for (t, candidates) in panel.chunks_exact(LANES).enumerate() {
        for r in 0..ROWS {
            let value = rows[r][t];
            for c in 0..LANES {
                sums[r][c] += value * candidates[c];
            }
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
