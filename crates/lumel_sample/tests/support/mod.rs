//! Statistics, quadrature and closed forms that the tests measure against.
#![allow(dead_code, reason = "every test binary compiles this module and uses its own part of it")]

use lumel_sample::{Dim, Sampler, SamplerKind, Stream, StreamKey};

/// A stream of `kind` made for `count` points, one per `seed`.
pub(crate) fn stream(kind: SamplerKind, count: u32, seed: u32) -> (Stream, u32) {
    let count = kind.sample_count(count);
    (kind.for_count(count).stream(StreamKey::new(2024).element(seed), Dim::Hemisphere), count)
}

/// Random numbers to place test cases with.
pub(crate) fn random_stream(seed: u32) -> Stream {
    Sampler::Random.stream(StreamKey::new(77).element(seed), Dim::Area)
}

/// A probability of this much or less counts as a failure.
///
/// Seeds are fixed, so a passing test goes on passing; about a hundred p-values are tested in all, so a correct
/// implementation had a chance of 1 % to need another seed.
pub(crate) const SIGNIFICANCE: f64 = 1e-4;

/// The p-value of Pearson's chi-squared test: the chance that a correct sampler fits as badly as this or worse.
///
/// Cells with fewer than five expected samples are pooled. `expected` sums to the number of samples.
pub(crate) fn chi_squared_p_value(observed: &[u32], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let (mut statistic, mut cells, mut pooled) = (0.0, 0, (0.0, 0.0));
    for (&observed, &expected) in observed.iter().zip(expected) {
        let observed = f64::from(observed);
        if expected >= 5.0 {
            statistic += (observed - expected).powi(2) / expected;
            cells += 1;
        } else {
            pooled = (pooled.0 + observed, pooled.1 + expected);
        }
    }
    if pooled.1 >= 5.0 {
        statistic += (pooled.0 - pooled.1).powi(2) / pooled.1;
        cells += 1;
    } else if pooled.0 > 0.0 && pooled.1 == 0.0 {
        return 0.0; // samples where the density is zero
    }
    upper_gamma(0.5 * f64::from(cells - 1), 0.5 * statistic)
}

/// The regularised upper incomplete gamma function Q(a, x), to about 1e-12.
///
/// Below a + 1 by the power series of P, above by the continued fraction of Q (Lentz's method).
pub(crate) fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-15 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        1.0 - front * sum
    } else {
        let mut b = x + 1.0 - a;
        let (mut c, mut d) = (1e300, 1.0 / b);
        let mut fraction = d;
        for i in 1..10_000 {
            let n = f64::from(i);
            let numerator = -n * (n - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            fraction *= c * d;
            if (c * d - 1.0).abs() < 1e-15 {
                break;
            }
        }
        front * fraction
    }
}

/// ln Γ(x) for x > 0: Stirling's series after shifting x above 12.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 12.0 {
        shift -= x.ln();
        x += 1.0;
    }
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    let series = inverse * (1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0)));
    shift + (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series
}

/// Nodes and weights of the `n`-point Gauss-Legendre rule on `[0, 1]`.
pub(crate) fn gauss_legendre(n: u32) -> Vec<(f64, f64)> {
    let degree = f64::from(n);
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (f64::from(i) + 0.75) / (degree + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 2..=n {
                    let k = f64::from(k);
                    (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                }
                slope = degree * (x * p1 - p0) / (x * x - 1.0);
                x -= p1 / slope;
            }
            (0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// ∫ f over the unit square by the product rule of `nodes`.
pub(crate) fn integrate_2d(nodes: &[(f64, f64)], f: impl Fn(f64, f64) -> f64) -> f64 {
    let row = |x: f64| nodes.iter().map(|&(y, w)| w * f(x, y)).sum::<f64>();
    nodes.iter().map(|&(x, w)| w * row(x)).sum()
}

/// Root mean square of `estimate(seed) − exact` over `seeds` seeds.
pub(crate) fn rms_error(seeds: u32, exact: f64, estimate: impl Fn(u32) -> f64) -> f64 {
    let squares: f64 = (0..seeds).map(|seed| (estimate(seed) - exact).powi(2)).sum();
    (squares / f64::from(seeds)).sqrt()
}

/// The exponent s of the power law y ∝ nˢ that fits best in logarithms.
pub(crate) fn fitted_exponent(points: &[(u32, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|&(n, y)| (f64::from(n).ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / count;
    let (mean_x, mean_y) = (mean(|p| p.0), mean(|p| p.1));
    let products: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let squares: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    products / squares
}

/// Irradiance at the origin with normal +z from a polygon of radiance one above the plane z = 0.
///
/// Lambert, 1760; for polygons that need no clipping at the horizon.
pub(crate) fn polygon_irradiance(corners: &[glam::DVec3]) -> f64 {
    let directions: Vec<glam::DVec3> = corners.iter().map(|c| c.normalize()).collect();
    let edges = directions.iter().zip(directions.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let cross = a.cross(*b);
            let sin = cross.length();
            if sin < 1e-15 { 0.0 } else { sin.atan2(a.dot(*b)) * cross.z / sin }
        })
        .sum();
    0.5 * sum.abs()
}
