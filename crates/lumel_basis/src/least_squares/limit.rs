//! Taking back what overshoots.

use super::LeastSquares;
use glam::DVec3;
use rayon::prelude::*;

impl LeastSquares {
    /// Limits coefficients `u` of the projection of `means`.
    pub(super) fn limit(&self, means: &[DVec3], u: &[DVec3], slack: f64, border: f64) -> Vec<DVec3> {
        let n = u.len();
        let bounds = |i: usize| {
            let (mut low, mut high) = (means[i], means[i]);
            for (column, _) in self.matrix.row(i) {
                let j = column.index();
                if self.areas[j] <= 0.0 { continue; }
                low = low.min(means[j]);
                high = high.max(means[j]);
            }
            let s = if self.is_border[i] { border } else { 0.0 };
            let room = s * (high - low);
            [low - room.max(slack * low.abs()), high + room.max(slack * high.abs())]
        };
        let bounds: Vec<[DVec3; 2]> = (0..n).into_par_iter().map(bounds).collect();
        let mut factors: Vec<[f64; 2]> = vec![[1.0; 2]; n];
        let scaled = |factors: &[[f64; 2]], i: usize, j: usize, flux: DVec3| {
            let (up, down) = (factors[i][1].min(factors[j][0]), factors[i][0].min(factors[j][1]));
            // one factor for all colours
            DVec3::select(flux.cmpgt(DVec3::ZERO), DVec3::splat(up), DVec3::splat(down)) * flux
        };
        for _ in 0..4 {
            let next = |i: usize| -> [f64; 2] {
                let area = self.areas[i];
                let [low, high] = bounds[i];
                let (mut sum_up, mut sum_down) = (DVec3::ZERO, DVec3::ZERO);
                for (column, value) in self.matrix.row(i) {
                    let j = column.index();
                    if j == i { continue; }
                    let flux = scaled(&factors, i, j, value * (u[i] - u[j]));
                    sum_up += flux.max(DVec3::ZERO);
                    sum_down += flux.min(DVec3::ZERO);
                }
                let net = sum_up + sum_down;
                let (up, down) = (area * (high - means[i]), area * (low - means[i]));
                let mut f = factors[i];
                for c in 0..3 {
                    if net[c] > up[c] { f[1] = f[1].min(factors[i][1] * ((up[c] - sum_down[c]) / sum_up[c]).clamp(0.0, 1.0)); }
                    if net[c] < down[c] { f[0] = f[0].min(factors[i][0] * ((down[c] - sum_up[c]) / sum_down[c]).clamp(0.0, 1.0)); }
                }
                f
            };
            let new: Vec<[f64; 2]> = (0..n).into_par_iter().map(next).collect();
            let changed = new.iter().zip(&factors).filter(|(a, b)| a != b).count();
            eprintln!("limited {changed} of {n}");
            factors = new;
        }
        let limited = |i: usize| {
            let area = self.areas[i];
            if area <= 0.0 { return u[i]; }
            let mut sum = DVec3::ZERO;
            for (column, value) in self.matrix.row(i) {
                let j = column.index();
                if j == i { continue; }
                sum += scaled(&factors, i, j, value * (u[i] - u[j]));
            }
            means[i] + sum / area
        };
        (0..n).into_par_iter().map(limited).collect()
    }
}
