//! Vertices in one place, and what lies at them.

use glam::Vec3;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Numbers places: the same one for all vertices that are there.
#[derive(Clone, Debug, Default)]
pub struct Weld(HashMap<[u32; 3], u32, BuildHasherDefault<PlaceHasher>>);

impl Weld {
    /// The number of a place: how many other places were there before it.
    pub fn number(&mut self, position: Vec3) -> u32 {
        let next = self.0.len() as u32;
        // Adding zero turns -0 into 0.
        *self.0.entry((position + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    }

    /// How many places have a number.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether no place has.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Hashes coordinates in a few instructions: meshes have millions of them.
#[derive(Debug, Default)]
struct PlaceHasher(u64);

impl PlaceHasher {
    /// 2⁶⁴ over the golden ratio.
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
}

impl Hasher for PlaceHasher {
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(4) {
            let mut whole = [0; 4];
            whole[..word.len()].copy_from_slice(word);
            self.write_u32(u32::from_le_bytes(whole));
        }
    }

    fn write_u32(&mut self, word: u32) {
        self.0 = (self.0.rotate_left(5) ^ u64::from(word)).wrapping_mul(Self::FACTOR);
    }

    fn write_usize(&mut self, _: usize) {
        // The length of a key: all have the same.
    }

    fn finish(&self) -> u64 {
        // Products have their best bits at the top, and tables look at the lowest as well.
        self.0 ^ self.0 >> 32
    }
}

/// Sorts items by a number below `n`, such as that of a place; those with the same number stay in their order.
///
/// Counting takes a pass over the items for each number they have: sort by the last of several numbers first.
pub(crate) fn sorted_by_number<T: Copy>(items: &[T], n: usize, number: impl Fn(&T) -> u32) -> Vec<T> {
    let Some(&any) = items.first() else { return Vec::new() };
    let mut next = vec![0_u32; n + 1];
    items.iter().for_each(|item| next[number(item) as usize + 1] += 1);
    let mut before = 0;
    for next in &mut next {
        before += *next;
        *next = before;
    }
    let mut sorted = vec![any; items.len()];
    for item in items {
        let place = &mut next[number(item) as usize];
        sorted[*place as usize] = *item;
        *place += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_has_a_number_however_near_others_are() {
        let mut weld = Weld::default();
        let mut numbers = Vec::new();
        for i in 0..64_u32 {
            let near = |bits: u32| f32::from_bits(1.0_f32.to_bits() + bits);
            numbers.push(weld.number(Vec3::new(near(i % 4), near(i / 4 % 4), near(i / 16))));
        }
        assert_eq!(numbers, (0..64).collect::<Vec<_>>());
        assert_eq!((weld.number(Vec3::ONE), weld.len()), (0, 64));
        assert_eq!(weld.number(-Vec3::ZERO), weld.number(Vec3::ZERO));
    }

    #[test]
    fn hashes_of_the_places_of_a_grid_fill_a_table_evenly() {
        let mut used = vec![0_u32; 4096];
        for i in 0..4096_u32 {
            let mut hasher = PlaceHasher::default();
            for axis in 0..3 {
                hasher.write_u32(((i >> (4 * axis) & 15) as f32 * 0.125).to_bits());
            }
            used[hasher.finish() as usize % 4096] += 1;
        }
        // Random ones leave 37 % empty and have seven in one place.
        let empty = used.iter().filter(|n| **n == 0).count();
        assert!(empty < 2048 && used.iter().all(|n| *n <= 12), "{empty} {:?}", used.iter().max());
    }

    #[test]
    fn sorting_by_numbers_keeps_the_order_of_equals() {
        let items: Vec<(u32, u32)> = (0..100).map(|i| (i * 7 % 10, i)).collect();
        let mut expected = items.clone();
        expected.sort_by_key(|item| item.0);
        assert_eq!(sorted_by_number(&items, 10, |item| item.0), expected);
        assert!(sorted_by_number(&[], 3, |item: &(u32, u32)| item.0).is_empty());
    }
}
