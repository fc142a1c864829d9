//! Laws of the warps: samples follow the density, the density integrates to one, the inverse undoes the warp.

mod support;

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use lumel_sample::*;
use support::{SIGNIFICANCE, chi_squared_p_value, gauss_legendre, integrate_2d, random_stream, stream};

const N_SAMPLES: u32 = 100_000;

/// Coordinates up to the borders of `[0, 1)`, both ends of the 24-bit lattice included.
const COORDINATES: [f32; 15] = [
    0.0,
    5.960_464_5e-8,
    1e-6,
    1e-3,
    0.02,
    0.123,
    0.25,
    0.4999,
    0.5,
    0.61,
    0.75,
    0.9,
    0.999,
    1.0 - 1e-6,
    1.0 - 5.960_464_5e-8,
];

fn grid() -> impl Iterator<Item = [f32; 2]> {
    COORDINATES.into_iter().flat_map(|x| COORDINATES.into_iter().map(move |y| [x, y]))
}

/// Chi-squared test of `N_SAMPLES` random samples, sorted into cells by `cell_of` with the given expected shares.
#[track_caller]
fn assert_fits(shares: &[f64], cell_of: impl Fn([f32; 2]) -> usize) {
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-6, "the density integrates to one");
    let samples = random_stream(1);
    let mut observed = vec![0; shares.len()];
    for i in 0..N_SAMPLES {
        observed[cell_of(samples.sample_2d(i))] += 1;
    }
    let expected: Vec<f64> = shares.iter().map(|share| share * f64::from(N_SAMPLES)).collect();
    let p_value = chi_squared_p_value(&observed, &expected);
    assert!(p_value > SIGNIFICANCE, "p = {p_value:.1e}");
}

/// Index of the cell of `n` that holds `x`; the upper border belongs to the last.
fn cell(x: f32, n: usize) -> usize {
    ((x * n as f32) as usize).min(n - 1)
}

/// How far `v` is turned from +x, in full turns.
fn turn(v: Vec2) -> f32 {
    (v.y.atan2(v.x) / TAU).rem_euclid(1.0)
}

/// `inverse(warp(u)) = u` on the grid, the coordinates left out where `lost` says that an edge meets in a point.
///
/// Each warp rounds a few times to f32, and angles are rounded at up to 2π: 5e-7 is eight roundings of a value near 1.
#[track_caller]
fn assert_invertible<P>(
    warp: impl Fn([f32; 2]) -> P,
    inverse: impl Fn(P) -> [f32; 2],
    lost: fn([f32; 2]) -> bool,
) {
    for u in grid() {
        let back = inverse(warp(u));
        let error = [(back[0] - u[0]).abs(), if lost(u) { 0.0 } else { (back[1] - u[1]).abs() }];
        assert!(error[0].max(error[1]) < 5e-7, "{u:?} became {back:?}");
        assert!(back.iter().all(|x| (0.0..1.0).contains(x)), "{u:?} became {back:?}");
    }
}

#[test]
fn triangle_samples_are_uniform() {
    // Cells of a square grid over (u, v); those on the diagonal are half outside.
    let n = 8;
    let shares: Vec<f64> = (0..n * n)
        .map(|cell| match (cell % n + cell / n).cmp(&(n - 1)) {
            std::cmp::Ordering::Less => 2.0 / (n * n) as f64,
            std::cmp::Ordering::Equal => 1.0 / (n * n) as f64,
            std::cmp::Ordering::Greater => 0.0,
        })
        .collect();
    assert_fits(&shares, |u| {
        let [a, b] = uniform_triangle(u);
        cell(a, n) + n * cell(b, n)
    });
}

#[test]
fn triangle_weights_are_never_negative() {
    for u in grid() {
        let [a, b] = uniform_triangle(u);
        assert!(a >= 0.0 && b >= 0.0 && 1.0 - a - b >= 0.0, "{u:?}");
    }
    let samples = random_stream(2);
    for i in 0..N_SAMPLES {
        // Close to the edge opposite to corner 2, where rounding matters, and off the 24-bit lattice, where it occurs.
        let [x, y] = samples.sample_2d(i);
        let [a, b] = uniform_triangle([(1.0 - x * 1e-6).min(1.0 - 6e-8), y * y]);
        assert!(a >= 0.0 && b >= 0.0 && 1.0 - a - b >= 0.0, "{x} {y}");
    }
}

#[test]
fn triangle_inverse_undoes_the_warp() {
    // The edge u₀ = 0 is corner 2: u₁ is lost.
    assert_invertible(uniform_triangle, uniform_triangle_inverse, |u| u[0] == 0.0);
}

#[test]
fn disk_samples_are_uniform() {
    // Polar cells of equal area, which have nothing in common with concentric squares.
    assert_fits(&[1.0 / 96.0; 96], |u| {
        let p = concentric_disk(u);
        cell(p.length_squared(), 6) + 6 * cell(turn(p), 16)
    });
}

#[test]
fn disk_inverse_undoes_the_warp() {
    assert_invertible(concentric_disk, concentric_disk_inverse, |_| false);
    assert_eq!(concentric_disk([0.5, 0.5]), Vec2::ZERO);
    assert_eq!(concentric_disk_inverse(Vec2::ZERO), [0.5, 0.5]);
}

/// The largest error over 100 seeds of 2¹⁶ Sobol points is 2e-6; the map has kinks along the diagonals.
#[test]
fn concentric_disk_has_the_moments_of_the_disk() {
    let (stream, n) = stream(SamplerKind::Sobol, 1 << 16, 0);
    let mean = |f: fn(Vec2) -> f32| {
        (0..n).map(|i| f64::from(f(concentric_disk(stream.sample_2d(i))))).sum::<f64>() / f64::from(n)
    };
    assert!((mean(|p| p.x * p.x) - 1.0 / 4.0).abs() < 1e-5);
    assert!((mean(|p| p.y * p.y) - 1.0 / 4.0).abs() < 1e-5);
    assert!((mean(|p| p.x * p.x * p.y * p.y) - 1.0 / 24.0).abs() < 1e-5);
    assert!((mean(|p| p.length()) - 2.0 / 3.0).abs() < 1e-5);
}

/// Cells over height and turn. The height runs over `[-1, 1]`; the expected share is the integral of `pdf` in them.
#[track_caller]
fn assert_directions_fit(warp: impl Fn([f32; 2]) -> Vec3, pdf: impl Fn(f32) -> f32) {
    let (n_heights, n_turns) = (16, 12);
    let nodes = gauss_legendre(8);
    let shares: Vec<f64> = (0..n_heights * n_turns)
        .map(|cell| {
            let height = f64::from(TAU) * 2.0 / (n_heights * n_turns) as f64;
            let z = |t: f64| 2.0 * ((cell % n_heights) as f64 + t) / n_heights as f64 - 1.0;
            height * integrate_2d(&nodes, |t, _| f64::from(pdf(z(t) as f32)))
        })
        .collect();
    assert_fits(&shares, |u| {
        let direction = warp(u);
        cell(0.5 + 0.5 * direction.z, n_heights) + n_heights * cell(turn(direction.truncate()), n_turns)
    });
}

#[test]
fn hemisphere_and_sphere_samples_follow_their_densities() {
    assert_directions_fit(cosine_hemisphere, cosine_hemisphere_pdf);
    assert_directions_fit(mixed_hemisphere, mixed_hemisphere_pdf);
    assert_directions_fit(uniform_hemisphere, uniform_hemisphere_pdf);
    assert_directions_fit(uniform_sphere, |_| uniform_sphere_pdf());
}

#[test]
fn densities_vanish_below_the_horizon() {
    assert_eq!(cosine_hemisphere_pdf(-0.5), 0.0);
    assert_eq!(mixed_hemisphere_pdf(-0.5), 0.0);
    assert_eq!(uniform_hemisphere_pdf(-0.5), 0.0);
    assert_eq!(cosine_hemisphere_pdf(1.0), 1.0 / PI);
}

#[test]
fn hemisphere_and_sphere_inverses_undo_the_warps() {
    assert_invertible(cosine_hemisphere, cosine_hemisphere_inverse, |_| false);
    assert_invertible(mixed_hemisphere, mixed_hemisphere_inverse, |_| false);
    // u₀ = 0 is the pole: the turn is lost.
    assert_invertible(uniform_hemisphere, uniform_hemisphere_inverse, |u| u[0] == 0.0);
    assert_invertible(uniform_sphere, uniform_sphere_inverse, |u| u[0] == 0.0);
}

#[test]
fn directions_are_unit_and_hemispheres_stay_above_the_horizon() {
    let samples = random_stream(3);
    for u in grid().chain((0..N_SAMPLES).map(|i| samples.sample_2d(i))) {
        // The mixed one is rounded twice as often.
        let directions =
            [(cosine_hemisphere(u), 2e-7), (uniform_hemisphere(u), 2e-7), (mixed_hemisphere(u), 4e-7)];
        for (direction, rounding) in directions {
            assert!(direction.z > 0.0, "{u:?}: {direction}");
            assert!((direction.length() - 1.0).abs() < rounding, "{u:?}: {direction}");
        }
        assert!((uniform_sphere(u).length() - 1.0).abs() < 2e-7, "{u:?}");
    }
}

/// Weights with empty cells, an empty row and a large range.
const TEXELS: [f32; 24] = [
    0.0, 1.0, 2.0, 0.0, 0.5, 7.0, //
    3.0, 0.0, 0.0, 0.0, 0.1, 0.0, //
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, //
    1.0, 1.0, 0.3, 20.0, 0.0, 4.0,
];

#[test]
fn piecewise_samples_follow_the_density() {
    let density = PiecewiseConstant2D::new(&TEXELS, 6, 4).expect("has weight");
    // Three by three cells per texel, with the density in their middles.
    let (n_x, n_y) = (18, 12);
    let middle = |cell: usize, n: usize| (cell as f32 + 0.5) / n as f32;
    let shares: Vec<f64> = (0..n_x * n_y)
        .map(|cell| {
            f64::from(density.pdf([middle(cell % n_x, n_x), middle(cell / n_x, n_y)])) / (n_x * n_y) as f64
        })
        .collect();
    assert_fits(&shares, |u| {
        let (point, pdf) = density.sample(u);
        assert_eq!(pdf, density.pdf(point));
        cell(point[0], n_x) + n_x * cell(point[1], n_y)
    });
    let total: f32 = TEXELS.iter().sum();
    assert!((density.pdf([3.5 / 6.0, 3.5 / 4.0]) / (20.0 / total * 24.0) - 1.0).abs() < 1e-6);
}

/// A point keeps f32 precision, and a step of the point is at most 24·20/40 = 12 times as large in u: 12 roundings.
#[test]
fn piecewise_inverse_undoes_the_warp() {
    let density = PiecewiseConstant2D::new(&TEXELS, 6, 4).expect("has weight");
    for u in grid() {
        let (point, _) = density.sample(u);
        let back = density.inverse(point);
        assert!((back[0] - u[0]).abs().max((back[1] - u[1]).abs()) < 12.0 * 6e-8, "{u:?} became {back:?}");
    }
}

#[test]
fn piecewise_choice_follows_the_probabilities() {
    let weights = &TEXELS[18..];
    let distribution = PiecewiseConstant1D::new(weights).expect("has weight");
    let shares: Vec<f64> = (0..weights.len()).map(|i| f64::from(distribution.probability(i))).collect();
    assert_fits(&shares, |u| distribution.sample(u[0]).0);
    // The remapped number is uniform again.
    assert_fits(&[0.1; 10], |u| cell(distribution.sample(u[0]).1, 10));
}
