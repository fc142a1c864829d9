//! How much two sets of light differ.

use glam::{DVec3, Vec3};
use serde::Serialize;

/// The difference of light A from light B. `None` stands for what does not exist, such as a ratio to darkness.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Root of the mean of (A − B)² over vertices and channels, W·m⁻².
    pub rmse: f64,
    /// `rmse` over the root of the mean of B².
    pub relative_rmse: Option<f64>,
    /// Mean of A over mean of B.
    pub mean_ratio: Option<f64>,
    /// Pearson's correlation of A and B.
    pub correlation: Option<f64>,
    /// Percentiles of |A − B| over the mean of B.
    pub percentiles: Option<Percentiles>,
    /// Mean of A per channel, W·m⁻².
    pub mean_a: [f64; 3],
    /// Mean of B per channel, W·m⁻².
    pub mean_b: [f64; 3],
}

/// The values below which so many of all values lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Percentiles {
    /// The median.
    pub p50: f64,
    /// Of nine in ten values.
    pub p90: f64,
    /// Of all but one in a hundred.
    pub p99: f64,
    /// The largest.
    pub p100: f64,
}

impl Percentiles {
    /// The shares of all values, percent.
    pub const PERCENTS: [f64; 4] = [50.0, 90.0, 99.0, 100.0];

    /// From the least to the largest.
    pub fn to_array(self) -> [f64; 4] {
        [self.p50, self.p90, self.p99, self.p100]
    }
}

impl Difference {
    /// The difference at the vertices that count; `None` when there are none.
    pub fn of(a: &[Vec3], b: &[Vec3], counts: &[bool]) -> Option<Self> {
        let values = |light: &[Vec3]| -> Vec<DVec3> {
            let counted = light.iter().zip(counts).filter(|(_, counts)| **counts);
            counted.map(|(value, _)| value.as_dvec3()).collect()
        };
        let (a, b) = (values(a), values(b));
        if a.is_empty() || a.len() != b.len() {
            return None;
        }
        let n = a.len() as f64;
        let mean = |values: &[DVec3]| values.iter().sum::<DVec3>() / n;
        let mean_square = |values: &mut dyn Iterator<Item = DVec3>| {
            values.map(|v| v.length_squared()).sum::<f64>() / (3.0 * n)
        };
        let (mean_a, mean_b) = (mean(&a), mean(&b));
        let [gray_a, gray_b] = [mean_a, mean_b].map(|mean| mean.element_sum() / 3.0);
        let rmse = mean_square(&mut a.iter().zip(&b).map(|(a, b)| a - b)).sqrt();
        let rms_b = mean_square(&mut b.iter().copied()).sqrt();
        Some(Self {
            rmse,
            relative_rmse: ratio(rmse, rms_b),
            mean_ratio: ratio(gray_a, gray_b),
            correlation: correlation(&a, &b, [gray_a, gray_b]),
            percentiles: percentiles(&a, &b, gray_b),
            mean_a: mean_a.to_array(),
            mean_b: mean_b.to_array(),
        })
    }
}

/// A quotient, unless it is no number.
fn ratio(a: f64, b: f64) -> Option<f64> {
    let ratio = a / b;
    ratio.is_finite().then_some(ratio)
}

fn correlation(a: &[DVec3], b: &[DVec3], [mean_a, mean_b]: [f64; 2]) -> Option<f64> {
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        ab += a.dot(b);
        aa += a.length_squared();
        bb += b.length_squared();
    }
    ratio(ab, (aa * bb).sqrt())
}

fn percentiles(a: &[DVec3], b: &[DVec3], scale: f64) -> Option<Percentiles> {
    let differences = a.iter().zip(b).flat_map(|(a, b)| (a - b).abs().to_array());
    let mut relative: Vec<f64> = differences.map(|difference| difference / scale).collect();
    relative.sort_unstable_by(f64::total_cmp);
    // Nearest rank.
    let at = |percent: f64| {
        let rank = (percent / 100.0 * relative.len() as f64).ceil() as usize;
        relative[rank.clamp(1, relative.len()) - 1]
    };
    let [p50, p90, p99, p100] = Percentiles::PERCENTS.map(at);
    p100.is_finite().then_some(Percentiles { p50, p90, p99, p100 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lights() -> (Vec<Vec3>, Vec<Vec3>) {
        let b: Vec<Vec3> = (0..100).map(|i| Vec3::new(1.0, 2.0, 3.0) * (1.0 + i as f32)).collect();
        (b.iter().map(|v| v * 1.5).collect(), b)
    }

    #[test]
    fn a_scaled_solution_differs_by_its_scale() {
        let (a, b) = lights();
        let difference = Difference::of(&a, &b, &[true; 100]).unwrap();
        let close = |value: Option<f64>, wanted: f64| (value.unwrap() - wanted).abs() < 1e-9;
        assert!(close(difference.relative_rmse, 0.5) && close(difference.mean_ratio, 1.5));
        assert!(close(difference.correlation, 1.0));
        // The largest: 0.5 * 300 over the mean 2 * 50.5.
        assert!(close(difference.percentiles.map(|p| p.p100), 150.0 / 101.0));
        assert_eq!(difference.mean_b, [50.5, 101.0, 151.5]);
    }

    #[test]
    fn only_vertices_that_count_count() {
        let (mut a, b) = lights();
        a[..50].copy_from_slice(&b[..50]);
        let counts: Vec<bool> = (0..100).map(|i| i < 50).collect();
        let difference = Difference::of(&a, &b, &counts).unwrap();
        assert_eq!((difference.rmse, difference.relative_rmse), (0.0, Some(0.0)));
        assert_eq!(Difference::of(&a, &b, &[false; 100]), None);
    }

    #[test]
    fn darkness_has_no_ratios() {
        let (a, _) = lights();
        let dark = vec![Vec3::ZERO; 100];
        let difference = Difference::of(&a, &dark, &[true; 100]).unwrap();
        assert!(difference.rmse > 0.0);
        assert_eq!(
            (difference.relative_rmse, difference.mean_ratio, difference.correlation),
            (None, None, None)
        );
        assert_eq!(Difference::of(&dark, &dark, &[true; 100]).unwrap().rmse, 0.0);
    }
}
