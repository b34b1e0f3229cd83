//! Which pairs of a set are measured.

/// The `limit` items whose lines come first by [`rank`], in that order: a sample that does not depend on the order of the file, and in which lines
/// with one beginning are no likelier to stay together than others. Without a limit all, as they are.
pub(super) fn select<T>(mut items: Vec<T>, line: impl Fn(&T) -> String, limit: Option<usize>) -> Vec<T> {
    if let Some(limit) = limit {
        items.sort_by_cached_key(|item| rank(&line(item)));
        items.truncate(limit);
    }
    items
}

/// Where a line stands: its FNV-1a hash, finalised. By the hash as it is, lines that differ in their last letters alone stay together, as those letters
/// hardly reach its upper bits: 40 pairs of a grid of 20 shapes came from 3 of them.
pub(crate) fn rank(line: &str) -> u64 {
    fmix64(fnv1a_64(line.as_bytes()))
}

/// The finaliser of MurmurHash3 for 64 bits (Appleby 2011): one to one, and every bit of the result depends on all bits of `hash`.
fn fmix64(hash: u64) -> u64 {
    let hash = (hash ^ (hash >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    let hash = (hash ^ (hash >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    hash ^ (hash >> 33)
}

/// Whether a pair is one of about every `n`-th.
#[cfg(feature = "train")]
pub(super) fn every(n: u64, line: &str) -> bool {
    fnv1a_64(line.as_bytes()).is_multiple_of(n)
}

/// Fowler, Noll & Vo: FNV-1a, 64 bits.
pub(super) fn fnv1a_64(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::{fnv1a_64, rank, select};

    #[test]
    fn the_hash_is_that_of_its_authors() {
        // From the test vectors of draft-eastlake-fnv.
        assert_eq!(fnv1a_64(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a_64(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a_64(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn the_order_is_that_of_the_finalised_hash() {
        // Worked out in Python, with integers of any size taken modulo 2^64.
        assert_eq!(rank(""), 0xefd0_1f60_ba99_2926);
        assert_eq!(rank("a"), 0x82a2_a958_a9be_ce5b);
        assert_eq!(rank("foobar"), 0x2c22_1949_22d1_672b);
        assert_eq!(rank("body_00 body_01"), 0x2980_e3e4_6f21_8cc1);
        let first = select(grid(), String::clone, Some(4));
        assert_eq!(first, ["body_02 body_11", "body_05 body_17", "body_16 body_03", "body_10 body_07"]);
    }

    /// All pairs of 20 shapes.
    fn grid() -> Vec<String> {
        let pairs = (0..20).flat_map(|a| (0..20).map(move |b| (a, b))).filter(|(a, b)| a != b);
        pairs.map(|(a, b)| format!("body_{a:02} body_{b:02}")).collect()
    }

    #[test]
    fn a_sample_of_all_pairs_of_some_shapes_has_most_of_the_shapes_on_both_sides() {
        let sample = select(grid(), String::clone, Some(40));
        for side in 0..2 {
            let mut times = BTreeMap::new();
            sample.iter().for_each(|line| *times.entry(line.split(' ').nth(side)).or_insert(0) += 1);
            assert!(times.len() >= 15 && times.values().all(|&times| times <= 6), "{times:?}");
        }
    }
}
