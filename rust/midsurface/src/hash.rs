//! One number made of several: of equal ones equal, of others as good as never.

/// Mixes words, each with the finalizer of MurmurHash3 (Appleby).
pub(crate) fn mixed(words: impl Iterator<Item = u64>) -> u64 {
    words.fold(0, |hash: u64, word| {
        let mut h = (hash.rotate_left(5) ^ word).wrapping_mul(0xff51_afd7_ed55_8ccd);
        h ^= h >> 33;
        h = h.wrapping_mul(0xc4ce_b9fe_1a85_ec53);
        h ^ h >> 33
    })
}
