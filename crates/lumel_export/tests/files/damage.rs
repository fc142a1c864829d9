//! Damage that disks and transfers do to files.

/// Every beginning of a file.
pub(crate) fn truncations(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    (0..bytes.len()).map(|end| &bytes[..end])
}

/// Copies with one to three bits flipped, and every byte changed at least once.
pub(crate) fn flips(bytes: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    // Knuth's MMIX generator; its high bits are good enough to choose bytes.
    let mut state = 1_u64;
    let mut below = move |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let singles = (0..bytes.len()).map(|at| {
        let mut copy = bytes.to_vec();
        copy[at] ^= if at % 2 == 0 { 0x01 } else { 0xff };
        copy
    });
    let several = (0..800).map(move |_| {
        let mut copy = bytes.to_vec();
        for _ in 0..1 + below(3) {
            copy[below(bytes.len())] ^= 1 << below(8);
        }
        copy
    });
    singles.chain(several)
}
