//! Nearest rows of two matrices, both ways, tile by tile.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::params::{NearestMerge, NearestRows};
use super::pool::Memory;
use super::recording::rows_per_dispatch;
use super::{Gpu, GpuIndices, GpuTensor};

/// Rows of either matrix per workgroup.
pub(super) const TILE: usize = 64;
/// Label of rows that may be compared with any, as in the shaders.
const ANY: u32 = u32::MAX;

/// The rows of a matrix in the order of their labels, each with the rank of its label among the `shared`; one that is not shared is [`ANY`], which
/// comes last.
fn by_label(labels: &[u32], shared: &BTreeMap<u32, u32>) -> Vec<[u32; 2]> {
    let mut order: Vec<[u32; 2]> =
        (0..).zip(labels).map(|(row, label)| [row, shared.get(label).copied().unwrap_or(ANY)]).collect();
    order.sort_by_key(|&[_, label]| label);
    order
}

/// Labels that both sides have, with their ranks.
fn shared_labels(of_x: &[u32], of_y: &[u32]) -> BTreeMap<u32, u32> {
    let [of_x, of_y] = [of_x, of_y].map(|labels| labels.iter().copied().collect::<BTreeSet<_>>());
    of_x.intersection(&of_y).copied().zip(0..).collect()
}

/// The most rows of y that a row of x is compared with.
fn most_candidates([order_x, order_y]: &[Vec<[u32; 2]>; 2]) -> usize {
    if order_x.last().is_some_and(|&[_, label]| label == ANY) {
        return order_y.len();
    }
    let alone = order_y.iter().filter(|[_, label]| *label == ANY).count();
    let of_one_label = order_y.chunk_by(|a, b| a[1] == b[1]).map(<[_]>::len).max();
    alone + of_one_label.unwrap_or(0)
}

impl Gpu {
    pub(super) fn nearest_both_ways(
        &self,
        x: &GpuTensor,
        y: &GpuTensor,
        parts: Option<(&[u32], &[u32])>,
    ) -> (GpuIndices, GpuIndices) {
        self.nearest_in_slabs(x, y, parts, usize::MAX)
    }

    /// In dispatches of at most `most` rows of x, a multiple of a tile.
    pub(super) fn nearest_in_slabs(
        &self,
        x: &GpuTensor,
        y: &GpuTensor,
        parts: Option<(&[u32], &[u32])>,
        most: usize,
    ) -> (GpuIndices, GpuIndices) {
        assert_eq!(x.cols, y.cols, "rows to compare have one length");
        let (n, m) = (x.rows, y.rows);
        let (to_y, to_x) = (self.indices(n, m), self.indices(m, n));
        let labelled = usize::from(parts.is_some());
        let orders = parts.map(|(of_x, of_y)| {
            assert_eq!((of_x.len(), of_y.len()), (n, m), "a label per row");
            let shared = shared_labels(of_x, of_y);
            [by_label(of_x, &shared), by_label(of_y, &shared)]
        });
        let candidates = orders.as_ref().map_or(m, most_candidates);
        let [order_x, order_y] = match &orders {
            Some(orders) => [0, 1].map(|side: usize| self.send(bytemuck::cast_slice(&orders[side]))),
            None => [Rc::clone(&x.memory), Rc::clone(&y.memory)],
        };
        let [squares_x, squares_y] = [x, y].map(|rows| self.by_rows(&self.kernels.rows.squares, rows, None, 1, 2));

        let work_per_row = 2 * candidates as u64 * x.cols as u64;
        let slab = rows_per_dispatch(work_per_row, TILE).min(most);
        let tiles_of_y = m.div_ceil(TILE);
        // For each row the nearest in each tile of the other matrix; the first row of these is that of all tiles so far.
        let best_of_x = self.room(2 * (1 + tiles_of_y) * slab.min(n));
        let best_of_y = self.room(2 * (1 + slab.min(n).div_ceil(TILE)) * m);
        let merge = &self.kernels.nearest.merge[labelled];
        let merged = |params: NearestMerge, order: &Memory, best: &Memory, out: &GpuIndices| {
            let groups = [params.rows.div_ceil(TILE as u32), 1, 1];
            let work = u64::from(params.rows) * u64::from(params.tiles);
            self.run(merge, params, &[order, best, &out.memory], groups, work);
        };
        for first in (0..n).step_by(slab) {
            let here = slab.min(n - first);
            let tiles = here.div_ceil(TILE);
            let params = NearestRows {
                rows_x: n as u32,
                rows_y: m as u32,
                width: x.cols as u32,
                first_row: first as u32,
                slab: here as u32,
            };
            let bound = [
                &*x.memory,
                &y.memory,
                &squares_x.memory,
                &squares_y.memory,
                &order_x,
                &order_y,
                &best_of_x,
                &best_of_y,
            ];
            let groups = [tiles as u32, tiles_of_y as u32, 1];
            self.run(&self.kernels.nearest.compare[labelled], params, &bound, groups, here as u64 * work_per_row);
            let of_x =
                NearestMerge { rows: here as u32, first_row: first as u32, tiles: tiles_of_y as u32, continued: 0 };
            merged(of_x, &order_x, &best_of_x, &to_y);
            let of_y =
                NearestMerge { rows: m as u32, first_row: 0, tiles: tiles as u32, continued: (first > 0).into() };
            merged(of_y, &order_y, &best_of_y, &to_x);
        }
        if n == 0 {
            let none = NearestMerge { rows: m as u32, first_row: 0, tiles: 0, continued: 0 };
            merged(none, &order_y, &best_of_y, &to_x);
        }
        (to_y, to_x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_by_label_then_by_index_and_those_alone_last() {
        let of_x = [u32::MAX, 7, 3, 7];
        let shared = shared_labels(&of_x, &[9, 7, u32::MAX, 7]);
        assert_eq!(by_label(&of_x, &shared), [[1, 0], [3, 0], [0, 1], [2, ANY]]);
        assert_eq!(by_label(&[], &shared), [[0; 2]; 0]);
    }

    #[test]
    fn only_rows_alone_with_their_label_are_compared_with_all() {
        let of_y = [9, 7, 3, 7];
        let orders = |of_x: &[u32]| {
            let shared = shared_labels(of_x, &of_y);
            [by_label(of_x, &shared), by_label(&of_y, &shared)]
        };
        assert_eq!(most_candidates(&orders(&[7, 3])), 3);
        assert_eq!(most_candidates(&orders(&[7, 3, 1])), 4);
    }
}
