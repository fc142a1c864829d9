//! Triangles of a page that lie on each other.

use glam::DVec2;
use rayon::prelude::*;

/// The side of the cells in which triangles meet, lumels. Triangles thinner than the tolerance are not looked at, so that
/// a cell has no more than some hundreds of those that do not overlap.
const CELL: f64 = 2.0;
const NOTHING: u32 = u32::MAX;

/// Pairs of triangles that lie on each other by more than `tolerance` in every direction, in the order of the second: one
/// for each triangle that lies on one before it.
///
/// The unit of the coordinates must be about the size of the triangles or of the tolerance: memory grows with the area.
pub(crate) fn overlapping(triangles: &[[DVec2; 3]], tolerance: f64) -> Vec<[usize; 2]> {
    let is_thick = |t: &[DVec2; 3]| t.iter().all(|c| c.is_finite()) && least_height(t) > tolerance;
    let mut in_cells: Vec<([i32; 2], u32)> = Vec::new();
    for (i, triangle) in triangles.iter().enumerate().filter(|(_, t)| is_thick(t)) {
        crate::raster::touched(triangle.map(|c| c / CELL), 0.0, |y, first, end| {
            in_cells.extend((first..end).map(|x| ([x as i32, y as i32], i as u32)));
        });
    }
    in_cells.par_sort_unstable();
    let mut lies_on = vec![NOTHING; triangles.len()];
    for cell in in_cells.chunk_by(|a, b| a.0 == b.0) {
        for (n, &(_, i)) in cell.iter().enumerate() {
            let hit =
                |&&(_, other): &&_| penetrate(&triangles[other as usize], &triangles[i as usize], tolerance);
            if lies_on[i as usize] == NOTHING
                && let Some(&(_, other)) = cell[..n].iter().find(hit)
            {
                lies_on[i as usize] = other;
            }
        }
    }
    let pairs = lies_on.iter().enumerate().filter(|(_, other)| **other != NOTHING);
    pairs.map(|(i, &other)| [other as usize, i]).collect()
}

/// The least distance of a corner from the opposite edge.
fn least_height(t: &[DVec2; 3]) -> f64 {
    let longest = (0..3).map(|k| t[k].distance(t[(k + 1) % 3])).fold(0.0, f64::max);
    if longest > 0.0 { (t[1] - t[0]).perp_dot(t[2] - t[0]).abs() / longest } else { 0.0 }
}

/// Whether the triangles overlap by more than `tolerance` along the normal of each of their edges: if they do not along
/// one, it separates them.
fn penetrate(a: &[DVec2; 3], b: &[DVec2; 3], tolerance: f64) -> bool {
    let edges = |t: &[DVec2; 3]| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    edges(a).into_iter().chain(edges(b)).filter_map(|edge| edge.perp().try_normalize()).all(|axis| {
        let ends = |t: &[DVec2; 3]| {
            let [x, y, z] = t.map(|c| c.dot(axis));
            (x.min(y).min(z), x.max(y).max(z))
        };
        let ((a_min, a_max), (b_min, b_max)) = (ends(a), ends(b));
        a_max.min(b_max) - a_min.max(b_min) > tolerance
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, size: f64) -> [DVec2; 3] {
        let min = DVec2::new(x, y);
        [min, min + DVec2::X * size, min + DVec2::Y * size]
    }

    #[test]
    fn neighbours_do_not_overlap_and_a_shifted_one_does() {
        let other_half = [DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0), DVec2::new(0.0, 1.0)];
        assert!(overlapping(&[at(0.0, 0.0, 1.0), other_half, at(1.0, 0.0, 1.0)], 0.01).is_empty());
        assert_eq!(overlapping(&[at(0.0, 0.0, 1.0), other_half, at(0.3, 0.3, 1.0)], 0.01), [[0, 2]]);
    }

    #[test]
    fn a_small_triangle_inside_a_large_one_is_found_far_from_its_corners() {
        assert_eq!(overlapping(&[at(0.0, 0.0, 100.0), at(40.0, 40.0, 0.5)], 0.01), [[0, 1]]);
    }

    #[test]
    fn what_is_thinner_than_the_tolerance_is_nowhere() {
        let line = [DVec2::ZERO, DVec2::X, DVec2::X * 0.5];
        assert!(overlapping(&[at(0.0, 0.0, 1.0), line, [DVec2::NAN; 3]], 0.01).is_empty());
    }
}
