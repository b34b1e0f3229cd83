//! Cross products of all pairs of rows.

use super::params::CrossPairs;
use super::{Gpu, GpuTensor};

impl Gpu {
    pub(super) fn cross_of_pairs(&self, g: &GpuTensor) -> GpuTensor {
        assert_eq!(g.cols, 3, "cross products are of vectors in space");
        let pairs = g.rows * g.rows.saturating_sub(1) / 2;
        let out = self.tensor(pairs, 3);
        let side = if pairs == 0 { 0 } else { g.rows.div_ceil(16) as u32 };
        let params = CrossPairs { rows: g.rows as u32 };
        let bound = [&*g.memory, &out.memory];
        self.run(&self.kernels.cross_pairs, params, &bound, [side, side, 1], 9 * pairs as u64);
        out
    }
}
