//! Which pairs of a set are measured.

/// The `limit` items whose lines come first by FNV-1a hash, in that order: a sample that does not depend on the order
/// of the file. Without a limit all, as they are.
pub(super) fn select<T>(mut items: Vec<T>, line: impl Fn(&T) -> String, limit: Option<usize>) -> Vec<T> {
    if let Some(limit) = limit {
        items.sort_by_cached_key(|item| fnv1a_64(line(item).as_bytes()));
        items.truncate(limit);
    }
    items
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
    use super::fnv1a_64;

    #[test]
    fn the_hash_is_that_of_its_authors() {
        // From the test vectors of draft-eastlake-fnv.
        assert_eq!(fnv1a_64(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a_64(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a_64(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
