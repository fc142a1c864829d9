//! The nearest of marked cells, exactly.

use rayon::prelude::*;

/// No cell.
pub(crate) const NONE: u32 = u32::MAX;

/// For each cell of a grid, row by row, the index of the nearest marked one; [`NONE`] if nothing is marked.
///
/// In two passes, first along columns, then along rows: Felzenszwalb, Huttenlocher, *Distance Transforms of Sampled
/// Functions*, 2012. In whole numbers, so that ties are decided alike everywhere.
pub(crate) fn nearest(width: usize, is_marked: &[bool]) -> Vec<u32> {
    let height = is_marked.len() / width.max(1);
    // The row of the nearest marked cell in the same column.
    let mut rows = vec![NONE; is_marked.len()];
    for y in 0..height {
        for x in 0..width {
            let above = if y > 0 { rows[(y - 1) * width + x] } else { NONE };
            rows[y * width + x] = if is_marked[y * width + x] { y as u32 } else { above };
        }
    }
    for y in (0..height.saturating_sub(1)).rev() {
        for x in 0..width {
            let (here, below) = (rows[y * width + x], rows[(y + 1) * width + x]);
            if below != NONE && (here == NONE || y.abs_diff(below as usize) < y.abs_diff(here as usize)) {
                rows[y * width + x] = below;
            }
        }
    }
    let mut found = vec![NONE; is_marked.len()];
    found.par_chunks_mut(width.max(1)).zip(rows.par_chunks(width.max(1))).enumerate().for_each(
        |(y, (found, rows))| {
            nearest_in_row(y, rows, found);
        },
    );
    found
}

/// The lower envelope of the parabolas that are the squared distances from the marked cells of each column.
fn nearest_in_row(y: usize, rows: &[u32], found: &mut [u32]) {
    let width = rows.len() as i64;
    let height = |x: i64| (i64::from(rows[x as usize]) - y as i64).pow(2);
    // The columns whose cells are nearest, and from which place on.
    let mut envelope: Vec<(i64, i64)> = Vec::new();
    for x in (0..width).filter(|&x| rows[x as usize] != NONE) {
        loop {
            let Some(&(left, start)) = envelope.last() else {
                envelope.push((x, 0));
                break;
            };
            let from = (x * x - left * left + height(x) - height(left)).div_euclid(2 * (x - left)) + 1;
            if from > start {
                envelope.push((x, from));
                break;
            }
            envelope.pop();
        }
    }
    let mut end = width;
    for &(x, start) in envelope.iter().rev().filter(|(_, start)| *start < width) {
        found[start as usize..end as usize].fill(rows[x as usize] * width as u32 + x as u32);
        end = start;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_is_as_near_as_any() {
        let (width, height) = (37, 23);
        for rarity in [1, 7, 90, 400] {
            let is_marked: Vec<bool> = (0..width * height)
                .map(|i: usize| i.wrapping_mul(2_654_435_761) >> 7 & 1023 < 1024 / rarity)
                .collect();
            let marked: Vec<usize> = (0..is_marked.len()).filter(|&i| is_marked[i]).collect();
            assert!(!marked.is_empty());
            let found = nearest(width, &is_marked);
            for (cell, &found) in found.iter().enumerate() {
                let distance = |to: usize| {
                    (cell % width).abs_diff(to % width).pow(2) + (cell / width).abs_diff(to / width).pow(2)
                };
                let least = marked.iter().map(|&to| distance(to)).min().unwrap();
                assert!(is_marked[found as usize]);
                assert_eq!(distance(found as usize), least, "{cell} {rarity}");
            }
        }
    }

    #[test]
    fn nothing_is_near_where_nothing_is_marked() {
        assert_eq!(nearest(3, &[false; 6]), [NONE; 6]);
        assert_eq!(nearest(0, &[]), []);
    }
}
