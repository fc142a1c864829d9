//! Means with their errors, and when to believe them.

use lumel_basis::{Field, NodeId};
use std::fmt::Display;

/// Relative error of a few operations in f32; the only tolerance of what has no variance.
pub const ROUNDING: f64 = 4e-6;

/// Two-sided chance of four standard errors or more: what one comparison may fail with by accident.
const SIGNIFICANCE: f64 = 6.33e-5;

/// Bound of the relative bias of area sampling, whose weights are sampled too.
///
/// A node's value is a ratio of sums over `samples` points around it. To first order its bias is at most
/// `sd(λ(E − Ē)) sd(λ) / (N ⟨λ⟩²)`; a hat λ over a triangle has mean 1/3, standard deviation 0.236 and root mean
/// square 0.408, so with irradiance that deviates from its mean by the share `spread` it is below `0.87 spread / N`.
pub fn ratio_bias(samples: u32, spread: f64) -> f64 {
    0.87 * spread / f64::from(samples)
}

/// A mean of independent replicates.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
    /// Number of replicates.
    pub count: usize,
}

impl Estimate {
    /// The mean of at least two replicates.
    pub fn new(replicates: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = replicates.into_iter().collect();
        let n = values.len() as f64;
        assert!(values.len() >= 2, "a standard error needs two replicates");
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Self { mean, error: (variance / n).sqrt(), count: values.len() }
    }

    /// The replicates' values of one node of a field, first channel.
    pub fn of_node(fields: &[Field], node: usize) -> Self {
        Self::new(fields.iter().map(|field| f64::from(field.values()[node].x)))
    }

    /// The replicates' values of one node of a field in a channel.
    pub fn of_channel(fields: &[Field], node: usize, channel: usize) -> Self {
        let value = |field: &Field| f64::from(field.coefficients(NodeId(node as u32))[channel].x);
        Self::new(fields.iter().map(value))
    }

    /// How far from the truth the mean may lie when this is one of `comparisons`.
    ///
    /// Four standard errors for a single comparison of many replicates; wider for several (Bonferroni) and for few
    /// replicates (Student's t of the same significance).
    pub fn tolerance(&self, comparisons: usize) -> f64 {
        let z = normal_quantile(SIGNIFICANCE / comparisons as f64);
        let freedom = (self.count - 1) as f64;
        // Cornish and Fisher's expansion of Student's t.
        let t = z
            + (z.powi(3) + z) / (4.0 * freedom)
            + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * freedom * freedom);
        t * self.error
    }

    /// Fails unless the mean is `truth` up to its noise and `bound`, the discretisation or rounding error.
    #[track_caller]
    pub fn assert_near(&self, truth: f64, bound: f64, what: impl Display) {
        self.assert_near_among(1, truth, bound, what);
    }

    /// The same as one of several comparisons.
    #[track_caller]
    pub fn assert_near_among(&self, comparisons: usize, truth: f64, bound: f64, what: impl Display) {
        let (off, tolerance) = (self.mean - truth, self.tolerance(comparisons));
        assert!(
            off.abs() <= tolerance + bound,
            "{what}: {} is {off:+.3e} off {truth}; noise explains {tolerance:.1e}, the bound is {bound:.1e}",
            self.mean
        );
    }
}

/// A ratio of means over independent pairs.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// Its standard error, to first order in the deviations of the means.
    ///
    /// What both parts of the pairs share, such as the noise of where they are measured, cancels.
    pub error: f64,
}

impl Ratio {
    /// The mean of `above` over the mean of `below`, of at least two pairs.
    pub fn new(above: &[f64], below: &[f64]) -> Self {
        let n = above.len() as f64;
        let sum = below.iter().sum::<f64>();
        let value = above.iter().sum::<f64>() / sum;
        let residuals = above.iter().zip(below).map(|(a, b)| (a - value * b).powi(2));
        Self { value, error: (residuals.sum::<f64>() * n / (n - 1.0)).sqrt() / sum }
    }
}

/// Fails unless every node of the mean of `fields` is what it should be, up to noise and a relative `bound`.
///
/// Nodes without an expected value (NaN) are left out.
#[track_caller]
pub fn assert_nodes_near(fields: &[Field], expected: &[f64], bound: f64, what: impl Display) {
    assert_eq!(fields[0].node_count(), expected.len());
    for (node, &truth) in expected.iter().enumerate().filter(|(_, truth)| truth.is_finite()) {
        let estimate = Estimate::of_node(fields, node);
        let at = format!("{what}, node {node}");
        estimate.assert_near_among(expected.len(), truth, bound * truth.abs(), at);
    }
}

/// The z that a standard normal variable exceeds in magnitude with probability `p`, for p below 0.05.
fn normal_quantile(p: f64) -> f64 {
    let tail = |z: f64| {
        // The continued fraction of Mills' ratio converges fast for z above 2.
        let fraction = (1..60).rev().fold(z, |rest, k| z + f64::from(k) / rest);
        2.0 * (-0.5 * z * z).exp() / (fraction * std::f64::consts::TAU.sqrt())
    };
    let (mut low, mut high) = (1.9, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) > p { low = middle } else { high = middle }
    }
    low
}

/// Root mean square.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = values.into_iter().fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    f64::sqrt(sum / n)
}

/// The exponent s of the power law y ∝ xˢ that fits best in logarithms.
pub fn fitted_slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mean_x, mean_y) =
        (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let products: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    products / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

/// Pearson's correlation of two equally long series.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        ab += (x - mean_a) * (y - mean_b);
        aa += (x - mean_a).powi(2);
        bb += (y - mean_b).powi(2);
    }
    ab / (aa * bb).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_error_is_that_of_the_mean() {
        let estimate = Estimate::new([1.0, 2.0, 3.0, 4.0]);
        assert_eq!(estimate.mean, 2.5);
        assert!((estimate.error - (5.0f64 / 12.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn tolerance_is_four_sigma_for_many_replicates_and_wider_for_few() {
        let many = Estimate { mean: 0.0, error: 1.0, count: 100_000 };
        assert!((many.tolerance(1) - 4.0).abs() < 1e-2);
        assert!((many.tolerance(1000) - 5.41).abs() < 0.02, "{}", many.tolerance(1000));
        let few = Estimate { count: 16, ..many };
        // Student's t with 15 degrees of freedom.
        assert!((few.tolerance(1) - 5.45).abs() < 0.1, "{}", few.tolerance(1));
    }

    #[test]
    fn power_laws_and_correlations_are_found() {
        let law: Vec<(f64, f64)> = [1.0, 2.0, 8.0].map(|x: f64| (x, 3.0 * x.powf(-1.5))).into();
        assert!((fitted_slope(&law) + 1.5).abs() < 1e-12);
        assert!((correlation(&[1.0, 2.0, 3.0], &[2.0, 4.0, 6.0]) - 1.0).abs() < 1e-12);
        assert!(correlation(&[1.0, 2.0, 3.0], &[1.0, 0.0, 1.0]).abs() < 1e-12);
        assert!((rms([3.0, 4.0, 0.0, 0.0]) - 2.5).abs() < 1e-12);
    }

    #[test]
    #[should_panic(expected = "noise explains")]
    fn means_far_from_the_truth_fail() {
        Estimate::new((0..100).map(|i| f64::from(i % 2))).assert_near(0.8, 0.0, "coin");
    }
}
