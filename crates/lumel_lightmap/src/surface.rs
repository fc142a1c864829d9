//! Neighbours on a chart.

use crate::charts::charts;
use crate::nearest::NONE;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;
use std::ops::{AddAssign, Div, Mul};

/// A cubic B-spline at whole numbers, which weighs neighbours along each axis.
pub(crate) const SPLINE: [f32; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

/// A share that `n` lumels tell counts for `1 − FEW / n` of itself. James and Stein have 2 for what is independent.
///
/// Measured in the house, whose charts have few lumels, the atrium and the Cornell box: with 0, light in the house comes out worse at
/// production than it was; with more, noise is left in the others at draft.
const FEW: f32 = 3.0;

/// Which lumels of a coverage are near each other on a chart.
pub(crate) struct Surface<'a> {
    atlas: &'a Atlas,
    coverage: &'a Coverage,
    /// Those that count, as places in the coverage; ascending.
    places: Vec<usize>,
    /// By lumel of all pages: its chart, and its index in `places` or `NONE`.
    charts: Vec<u32>,
    indices: Vec<u32>,
}

impl<'a> Surface<'a> {
    /// Those for which `counts(place)`.
    pub(crate) fn new(atlas: &'a Atlas, coverage: &'a Coverage, counts: impl Fn(usize) -> bool) -> Self {
        let places: Vec<usize> = (0..coverage.len()).filter(|&place| counts(place)).collect();
        let charts = charts(atlas, coverage);
        let mut indices = vec![NONE; charts.len()];
        for (index, &place) in places.iter().enumerate() {
            indices[coverage.lumels()[place] as usize] = index as u32;
        }
        Self { atlas, coverage, places, charts, indices }
    }

    /// The places in the coverage.
    pub(crate) fn places(&self) -> &[usize] {
        &self.places
    }

    /// The lumels, as indices into all pages.
    pub(crate) fn lumels(&self) -> impl Iterator<Item = usize> {
        self.places.iter().map(|&place| self.coverage.lumels()[place] as usize)
    }

    /// The means of values around each, `reach` and twice `reach` away.
    pub(crate) fn means<T>(&self, values: &[T], reach: i64) -> Vec<T>
    where
        T: Copy + Default + Send + Sync + AddAssign + Mul<f32, Output = T> + Div<f32, Output = T>,
    {
        let mean = |index: usize| {
            let (mut sum, mut weights) = (T::default(), 0.0);
            self.around(index, reach, |near, weight| {
                sum += values[near] * weight;
                weights += weight;
            });
            sum / weights
        };
        (0..values.len()).into_par_iter().map(mean).collect()
    }

    /// How far what those around one say together is to be trusted, if they are looked at at some reaches: not at all if they are few.
    pub(crate) fn trust(&self, index: usize, reaches: &[i64]) -> f32 {
        let mut n = 0;
        for &reach in reaches {
            self.around(index, reach, |_, _| n += 1);
        }
        (1.0 - FEW / n as f32).max(0.0)
    }

    /// Calls `add(index, weight)` for those around one of them, `reach` and twice `reach` away.
    pub(crate) fn around(&self, index: usize, reach: i64, mut add: impl FnMut(usize, f32)) {
        let lumel = self.coverage.lumels()[self.places[index]] as usize;
        let (page, [x, y]) = self.atlas.column_and_row(lumel);
        let [width, height] = self.atlas.pages()[page].map(i64::from);
        let first = self.atlas.first_lumel(page);
        for (j, down) in SPLINE.iter().enumerate() {
            let y = i64::from(y) + (j as i64 - 2) * reach;
            for (i, along) in SPLINE.iter().enumerate().filter(|_| (0..height).contains(&y)) {
                let x = i64::from(x) + (i as i64 - 2) * reach;
                if !(0..width).contains(&x) {
                    continue;
                }
                let near = first + (y * width + x) as usize;
                if self.charts[near] == self.charts[lumel] && self.indices[near] != NONE {
                    add(self.indices[near] as usize, down * along);
                }
            }
        }
    }
}
