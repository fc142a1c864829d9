//! Piecewise constant densities, sampled by inverting their cumulative distribution.

use crate::bits::unit_from_f64;

/// A choice among cells with probabilities in proportion to weights.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant1D {
    /// Cumulative probabilities: one more than there are cells, from exactly 0 to exactly 1.
    cdf: Vec<f64>,
}

impl PiecewiseConstant1D {
    /// A distribution over `weights.len()` cells, of any unit.
    ///
    /// Returns `None` without a positive weight, or if a weight is negative or not finite.
    #[must_use]
    pub fn new(weights: &[f32]) -> Option<Self> {
        let valid = weights.iter().all(|w| w.is_finite() && *w >= 0.0);
        if !valid {
            return None;
        }
        let mut cdf = Vec::with_capacity(weights.len() + 1);
        let total = push_cdf(&mut cdf, weights.iter().copied().map(f64::from));
        (total > 0.0).then_some(Self { cdf })
    }

    /// Selects a cell: its index, `u` remapped to `[0, 1)` within it, and its probability.
    ///
    /// Never selects a cell of weight zero. The remapped value is uniform again, but has fewer bits left.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let (index, offset) = locate(&self.cdf, u);
        (index, offset, self.probability(index))
    }

    /// Probability of the cell `index`.
    ///
    /// # Panics
    ///
    /// If there is no such cell.
    #[inline]
    #[must_use]
    pub fn probability(&self, index: usize) -> f32 {
        (self.cdf[index + 1] - self.cdf[index]) as f32
    }

    /// The `u` that [`sample`](Self::sample) maps to the cell `index` and `offset` within it.
    ///
    /// # Panics
    ///
    /// If there is no such cell.
    #[inline]
    #[must_use]
    pub fn inverse(&self, index: usize, offset: f32) -> f32 {
        delocate(&self.cdf, index, offset)
    }
}

/// A density over the unit square, constant on each cell of a grid: a texture that emits light, for example.
///
/// Chooses a row by its total weight, then a column within the row. Row 0 lies at y = 0. Memory: 8 bytes per cell.
///
/// Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., A.5.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant2D {
    width: usize,
    rows: PiecewiseConstant1D,
    /// One cumulative distribution of `width + 1` values per row, all zero in a row without weight.
    columns: Vec<f64>,
}

impl PiecewiseConstant2D {
    /// A density in proportion to `weights`, `width × height` values row by row.
    ///
    /// Returns `None` if the number of weights does not fit, if none is positive, or if one is negative or not finite.
    #[must_use]
    pub fn new(weights: &[f32], width: usize, height: usize) -> Option<Self> {
        let valid = weights.iter().all(|w| w.is_finite() && *w >= 0.0);
        if width == 0 || width.checked_mul(height) != Some(weights.len()) || !valid {
            return None;
        }
        let mut columns = Vec::with_capacity(weights.len() + height);
        let totals: Vec<f64> = weights
            .chunks_exact(width)
            .map(|row| push_cdf(&mut columns, row.iter().copied().map(f64::from)))
            .collect();
        let mut cdf = Vec::with_capacity(height + 1);
        let total = push_cdf(&mut cdf, totals);
        (total > 0.0).then_some(Self { width, rows: PiecewiseConstant1D { cdf }, columns })
    }

    /// A point of the unit square and the density there.
    ///
    /// The density is per unit square: one on average, and never zero here.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, y) = locate(&self.rows.cdf, u[1]);
        let (column, x) = locate(self.columns_of(row), u[0]);
        let point = [within_cell(column, x, self.width), within_cell(row, y, self.height())];
        (point, self.density(row, column))
    }

    /// Density at `point` of the unit square, per unit square; zero outside of it.
    #[inline]
    #[must_use]
    pub fn pdf(&self, point: [f32; 2]) -> f32 {
        if point.iter().all(|x| (0.0..=1.0).contains(x)) {
            self.density(cell_of(point[1], self.height()).0, cell_of(point[0], self.width).0)
        } else {
            0.0
        }
    }

    /// The point of the unit square that [`sample`](Self::sample) maps to `point`.
    #[inline]
    #[must_use]
    pub fn inverse(&self, point: [f32; 2]) -> [f32; 2] {
        let (row, y) = cell_of(point[1], self.height());
        let (column, x) = cell_of(point[0], self.width);
        [delocate(self.columns_of(row), column, x), delocate(&self.rows.cdf, row, y)]
    }

    #[inline]
    fn height(&self) -> usize {
        self.rows.cdf.len() - 1
    }

    #[inline]
    fn columns_of(&self, row: usize) -> &[f64] {
        let stride = self.width + 1;
        &self.columns[row * stride..][..stride]
    }

    #[inline]
    fn density(&self, row: usize, column: usize) -> f32 {
        let in_row = self.rows.cdf[row + 1] - self.rows.cdf[row];
        let columns = self.columns_of(row);
        let in_column = columns[column + 1] - columns[column];
        (in_row * in_column * (self.width * self.height()) as f64) as f32
    }
}

/// Appends the running sums of `weights`, from zero and scaled to end at one; returns the unscaled total.
///
/// Without a positive weight all values are zero.
fn push_cdf(cdf: &mut Vec<f64>, weights: impl IntoIterator<Item = f64>) -> f64 {
    let begin = cdf.len();
    let mut total = 0.0;
    cdf.push(0.0);
    for weight in weights {
        total += weight;
        cdf.push(total);
    }
    if total > 0.0 {
        // The last of them, and the ends of cells without weight behind it, become total / total: exactly one.
        cdf[begin..].iter_mut().for_each(|sum| *sum /= total);
    }
    total
}

/// The cell of `cdf` that holds `u`, and the place within it, `[0, 1)`.
#[inline]
fn locate(cdf: &[f64], u: f32) -> (usize, f32) {
    let u = f64::from(u).clamp(0.0, 1.0 - f64::EPSILON);
    // The last value not above u begins the cell. The next is above it, so the cell has weight.
    let index = cdf.partition_point(|&sum| sum <= u).clamp(1, cdf.len() - 1) - 1;
    let (low, high) = (cdf[index], cdf[index + 1]);
    (index, unit_from_f64((u - low) / (high - low)))
}

/// The inverse of [`locate`].
#[inline]
fn delocate(cdf: &[f64], index: usize, offset: f32) -> f32 {
    let (low, high) = (cdf[index], cdf[index + 1]);
    unit_from_f64(low + f64::from(offset) * (high - low))
}

/// The coordinate at `offset` within cell `index` of `n`, such that [`cell_of`] finds the same cell.
///
/// Rounding to f32 may carry the coordinate over a border, where the density can be another, even zero.
#[inline]
fn within_cell(index: usize, offset: f32, n: usize) -> f32 {
    let x = unit_from_f64((index as f64 + f64::from(offset)) / n as f64);
    match cell_of(x, n).0.cmp(&index) {
        std::cmp::Ordering::Less => x.next_up(),
        std::cmp::Ordering::Equal => x,
        std::cmp::Ordering::Greater => x.next_down(),
    }
}

/// The cell of `n` that holds `x` in `[0, 1]`, and the place within it, `[0, 1)`.
#[inline]
fn cell_of(x: f32, n: usize) -> (usize, f32) {
    let scaled = f64::from(x) * n as f64;
    let index = (scaled as usize).min(n - 1);
    (index, unit_from_f64(scaled - index as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_weights_make_no_distribution() {
        for weights in [&[] as &[f32], &[0.0, 0.0], &[1.0, -1.0], &[1.0, f32::NAN], &[f32::INFINITY]] {
            assert_eq!(PiecewiseConstant1D::new(weights), None);
            assert_eq!(PiecewiseConstant2D::new(weights, weights.len(), 1), None);
        }
        assert_eq!(PiecewiseConstant2D::new(&[1.0; 6], 4, 2), None);
        assert_eq!(PiecewiseConstant2D::new(&[], 0, 0), None);
        assert_eq!(PiecewiseConstant2D::new(&[], 1, 0), None);
        assert_eq!(PiecewiseConstant2D::new(&[1.0], usize::MAX, 3), None);
    }

    #[test]
    fn cells_of_weight_zero_are_never_chosen() {
        let distribution = PiecewiseConstant1D::new(&[0.0, 1.0, 0.0, 3.0, 0.0]).unwrap();
        for i in 0..=1000 {
            let (index, offset, probability) = distribution.sample(i as f32 / 1000.0);
            assert!((0.0..1.0).contains(&offset));
            match index {
                1 => assert_eq!(probability, 0.25),
                3 => assert_eq!(probability, 0.75),
                _ => panic!("cell {index} has no weight"),
            }
        }
        assert_eq!(distribution.probability(0), 0.0);
        assert_eq!(distribution.sample(0.0), (1, 0.0, 0.25));
        assert_eq!(distribution.sample(0.25), (3, 0.0, 0.75));
    }

    #[test]
    fn choosing_a_cell_is_invertible() {
        let distribution = PiecewiseConstant1D::new(&[0.2, 0.0, 1.7, 0.01, 3.0]).unwrap();
        for i in 0..1000 {
            let u = i as f32 / 1000.0;
            let (index, offset, _) = distribution.sample(u);
            // Two roundings to f32, 2⁻²⁵ each.
            assert!((distribution.inverse(index, offset) - u).abs() <= 1.2e-7);
        }
    }

    /// A point that rounds onto the border of its cell would find the density zero of the neighbour.
    #[test]
    fn sampled_points_have_the_density_they_were_drawn_with() {
        for n in [3, 7, 129, 1000, 4099] {
            let weights: Vec<f32> = (0..n).map(|i| (i % 2) as f32).collect();
            let density = PiecewiseConstant2D::new(&weights, n, 1).unwrap();
            for i in 0..20_000_u32 {
                let u = (i.wrapping_mul(0x9e37_79b9) >> 8) as f32 * 2.0_f32.powi(-24);
                let (point, pdf) = density.sample([u, 0.3]);
                assert!(pdf > 0.0 && density.pdf(point) == pdf, "n = {n}, u = {u}");
            }
            for column in 0..n {
                for offset in [0.0, 1.0 - f32::EPSILON / 2.0] {
                    assert_eq!(cell_of(within_cell(column, offset, n), n).0, column);
                }
            }
        }
    }

    #[test]
    fn the_density_is_zero_outside_of_the_square() {
        let density = PiecewiseConstant2D::new(&[1.0; 4], 2, 2).unwrap();
        assert_eq!(density.pdf([0.5, 1.0]), 1.0);
        for point in [[-0.1, 0.5], [0.5, 1.1], [f32::NAN, 0.5]] {
            assert_eq!(density.pdf(point), 0.0);
        }
    }
}
