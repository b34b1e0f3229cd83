//! Attention that streams over the keys.

use super::params::Attention;
use super::recording::rows_per_dispatch;
use super::{Gpu, GpuTensor};
use crate::device::Mask;

/// Queries, and columns of values, per workgroup.
const TILE: usize = 64;

impl Gpu {
    pub(super) fn stream_attention(
        &self,
        (query, query_parts): (&GpuTensor, &GpuTensor),
        (key, key_parts): (&GpuTensor, &GpuTensor),
        value: &GpuTensor,
        mask: Mask,
    ) -> GpuTensor {
        assert_eq!(query.cols, key.cols, "queries and keys have one length");
        assert_eq!(query_parts.cols, key_parts.cols, "queries and keys have the same parts");
        assert!(query_parts.rows == query.rows && key_parts.rows == key.rows, "every query and key has its parts");
        assert_eq!(key.rows, value.rows, "every key has a value");
        let (n, values) = (query.rows, value.cols);
        let out = self.tensor(n, values);
        let blocks = values.div_ceil(TILE);
        // Every block of values makes the scores anew; five operations turn one into a weight.
        let per_key = blocks * (2 * query.cols + 2 * query_parts.cols + 5) + 2 * values;
        let work_per_query = (key.rows * per_key) as u64;
        let slab = rows_per_dispatch(work_per_query, TILE);
        let params = Attention {
            queries: n as u32,
            keys: key.rows as u32,
            width: query.cols as u32,
            parts: query_parts.cols as u32,
            values: values as u32,
            first_query: 0,
            scale: (query.cols as f32).sqrt().recip(),
            hard: u32::from(mask == Mask::Hard),
        };
        let bound = [query, query_parts, key, key_parts, value, &out].map(|tensor| &*tensor.memory);
        for first in (0..n).step_by(slab) {
            let here = slab.min(n - first);
            let groups = [here.div_ceil(TILE) as u32, blocks as u32, 1];
            let params = Attention { first_query: first as u32, ..params };
            self.run(&self.kernels.attention, params, &bound, groups, here as u64 * work_per_query);
        }
        out
    }
}
