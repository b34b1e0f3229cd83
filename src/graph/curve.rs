//! An order in which what is near in space is near in time.

/// Cells per axis, as a power of two.
const BITS: u32 = 16;

/// The points along a Z-order curve (Morton 1966). Whatever is computed in this order finds the data of neighbours still in cache.
pub(super) fn along_curve(points: &[[f64; 3]]) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        for c in 0..3 {
            low[c] = low[c].min(p[c]);
            high[c] = high[c].max(p[c]);
        }
    }
    let longest = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    let scale = if longest > 0.0 { ((1_u64 << BITS) - 1) as f64 / longest } else { 0.0 };
    let cell = |p: &[f64; 3]| -> u64 { (0..3).map(|c| spread(((p[c] - low[c]) * scale) as u64) << c).sum() };
    let mut order: Vec<(u64, u32)> = points.iter().zip(0..).map(|(p, i)| (cell(p), i)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// Two zeros before each of the lowest 16 bits.
fn spread(x: u64) -> u64 {
    let x = (x | (x << 16)) & 0x0000_ff00_00ff;
    let x = (x | (x << 8)) & 0x00f0_0f00_f00f;
    let x = (x | (x << 4)) & 0x0c30_c30c_30c3;
    (x | (x << 2)) & 0x2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_by_three() {
        for bit in 0..16 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(0xffff), 0x2492_4924_9249);
    }

    #[test]
    fn every_point_comes_once_whatever_the_points() {
        for scale in [0.0, 1e-300, 1.0, 1e300] {
            let points: Vec<[f64; 3]> =
                (0..50).map(|i| [f64::from(i % 7), f64::from(i % 5), 1.0].map(|x| scale * x)).collect();
            let mut order = along_curve(&points);
            order.sort_unstable();
            assert!(order.into_iter().eq(0..50));
        }
    }
}
