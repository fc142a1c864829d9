//! An order that covers a range evenly from the start.

use std::ops::Range;

/// Stretches of a range that are visited here and there. Within one, neighbours follow each other and meet the
/// triangles that the last one has brought into the cache.
const STRETCHES: u32 = 64;

/// The numbers of a range, each once, in stretches that follow each other as van der Corput's sequence has it: by
/// their bits read backwards.
///
/// However many stretches have been visited, from wherever in the order, no gap between them is longer than three
/// times the mean gap. (Multiples of a stride near the golden ratio, the usual choice, leave gaps of up to sixteen
/// times where the count has no coprime stride that is near enough.)
pub(crate) fn scattered(range: Range<u32>) -> Vec<u32> {
    let length = range.end.saturating_sub(range.start).div_ceil(STRETCHES).max(1);
    let starts: Vec<u32> = range.clone().step_by(length as usize).collect();
    let stretch = |i: u32| (starts[i as usize]..range.end).take(length as usize);
    bits_backwards(starts.len() as u32).flat_map(stretch).collect()
}

/// The numbers below `n`.
fn bits_backwards(n: u32) -> impl Iterator<Item = u32> {
    let bits = u32::BITS - n.saturating_sub(1).leading_zeros();
    let backwards = move |i: u32| (u64::from(i.reverse_bits()) >> (u32::BITS - bits)) as u32;
    (0..1 << bits).map(backwards).filter(move |&i| i < n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_visited_once() {
        for n in (0..300).chain([1000, 5121]) {
            let mut order = scattered(7..7 + n);
            order.sort_unstable();
            assert!(order.into_iter().eq(7..7 + n), "{n}");
        }
    }

    #[test]
    fn any_part_of_the_order_covers_the_range_evenly() {
        for n in [3, 16, 50, 203, STRETCHES, 5 * STRETCHES] {
            let order = scattered(0..n);
            let stretch = n.div_ceil(STRETCHES);
            for first in [0, order.len() / 3, order.len() / 2] {
                let mut visited = vec![false; n as usize];
                for (k, &i) in order[first..].iter().enumerate() {
                    visited[i as usize] = true;
                    let gap = longest_gap(&visited);
                    let n_stretches = (k as u32 + 1).div_ceil(stretch);
                    assert!(
                        gap * n_stretches <= 3 * n + stretch,
                        "{n}: a gap of {gap} after {k} from {first}"
                    );
                }
            }
        }
    }

    /// From one visited number to the next, round the end.
    fn longest_gap(visited: &[bool]) -> u32 {
        let (mut longest, mut gap) = (0, 0);
        for &visited in visited.iter().cycle().take(2 * visited.len()) {
            gap += 1;
            if visited {
                (longest, gap) = (longest.max(gap), 0);
            }
        }
        longest
    }
}
