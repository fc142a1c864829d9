//! How fast the error falls with the number of samples, on integrals with known values.

mod support;

use std::f64::consts::PI;

use glam::{DVec3, Vec3, dvec3};
use lumel_sample::{SamplerKind, Stream, cosine_hemisphere, uniform_triangle};
use support::{fitted_exponent, gauss_legendre, integrate_2d, polygon_irradiance, rms_error, stream};

/// An integrand over the samples of a stream, with its exact mean.
struct Integral {
    exact: f64,
    value: fn(&Stream, u32) -> f64,
}

const COUNTS: [u32; 5] = [16, 64, 256, 1024, 4096];
const SEEDS: u32 = 200;

impl Integral {
    /// RMS error of the mean over the `COUNTS`; each has a standard deviation of 1/√(2·200) = 5 %.
    fn errors(&self, kind: SamplerKind) -> Vec<(u32, f64)> {
        COUNTS
            .iter()
            .map(|&n| {
                let error = rms_error(SEEDS, self.exact, |seed| {
                    let (stream, n) = stream(kind, n, seed);
                    (0..n).map(|i| (self.value)(&stream, i)).sum::<f64>() / f64::from(n)
                });
                (n, error)
            })
            .collect()
    }

    /// Order of convergence. The five points span ln 256, so 5 % of noise each make a standard deviation of 0.012:
    /// a margin of 0.07 is 6σ.
    fn slope(&self, kind: SamplerKind) -> f64 {
        fitted_exponent(&self.errors(kind))
    }
}

/// Radiance 1 from the light `[0, 1]²` at height 1, facing down, on a receiver at height 0 facing up.
fn light_integrand([x, y]: [f32; 2], [px, py]: [f64; 2]) -> f64 {
    ((f64::from(x) - px).powi(2) + (f64::from(y) - py).powi(2) + 1.0).powi(-2)
}

/// Exact irradiance of a polygon at height 1 on the receiver (px, py, 0).
fn ceiling_irradiance(corners: &[[f64; 2]], [px, py]: [f64; 2]) -> f64 {
    let corners: Vec<DVec3> = corners.iter().map(|[x, y]| dvec3(x - px, y - py, 1.0)).collect();
    polygon_irradiance(&corners)
}

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const RECEIVER: [f64; 2] = [0.3, 0.2];

fn smooth_light() -> Integral {
    let exact = ceiling_irradiance(&SQUARE, RECEIVER);
    assert!((exact - 0.649_208_136).abs() < 1e-9);
    Integral { exact, value: |stream, i| light_integrand(stream.sample_2d(i), RECEIVER) }
}

/// The same light, visible on one side of the line x + 0.7 y = 0.8 only.
fn cut_light() -> Integral {
    let exact = ceiling_irradiance(&[[0.0, 0.0], [0.8, 0.0], [0.1, 1.0], [0.0, 1.0]], RECEIVER);
    assert!((exact - 0.365_049_049).abs() < 1e-9);
    Integral {
        exact,
        value: |stream, i| {
            let point = stream.sample_2d(i);
            let visible = f64::from(point[0]) + 0.7 * f64::from(point[1]) < 0.8;
            if visible { light_integrand(point, RECEIVER) } else { 0.0 }
        },
    }
}

/// Radiance of the walls x = 0, x = 1, y = 0, y = 1, z = 1 of the unit cube.
const WALLS: [f64; 5] = [0.1, 0.9, 0.3, 0.6, 1.0];

/// Radiance of the wall that a ray from the receiver on the floor meets.
fn wall_radiance(direction: Vec3) -> f64 {
    let d = direction.as_dvec3();
    let origin = dvec3(RECEIVER[0], RECEIVER[1], 0.0);
    let distance = |d: f64, x: f64| if d < 0.0 { -x / d } else { (1.0 - x) / d };
    let (tx, ty, tz) = (distance(d.x, origin.x), distance(d.y, origin.y), 1.0 / d.z);
    if tz < tx.min(ty) {
        WALLS[4]
    } else if tx < ty {
        WALLS[usize::from(d.x > 0.0)]
    } else {
        WALLS[2 + usize::from(d.y > 0.0)]
    }
}

/// Gathering in a cube with constant walls, with cosine-distributed rays.
fn cube_gather() -> Integral {
    let [px, py] = RECEIVER;
    let wall = |corners: [[f64; 3]; 4]| {
        let corners = corners.map(|[x, y, z]| dvec3(x - px, y - py, z));
        polygon_irradiance(&corners)
    };
    let along_x = |x: f64| wall([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]]);
    let along_y = |y: f64| wall([[0.0, y, 0.0], [1.0, y, 0.0], [1.0, y, 1.0], [0.0, y, 1.0]]);
    let walls =
        [along_x(0.0), along_x(1.0), along_y(0.0), along_y(1.0), ceiling_irradiance(&SQUARE, RECEIVER)];
    assert!((walls.iter().sum::<f64>() - PI).abs() < 1e-12, "the walls fill the hemisphere");
    let exact: f64 = walls.iter().zip(WALLS).map(|(e, radiance)| e * radiance).sum();
    assert!((exact - 1.545_682_021).abs() < 1e-9);
    Integral { exact, value: |stream, i| PI * wall_radiance(cosine_hemisphere(stream.sample_2d(i))) }
}

/// Mean irradiance of the triangle (0,0), (1,0), (0,1) on the floor under the light: receiver and light point in 4-D.
fn triangle_under_light() -> Integral {
    let exact = integrate_2d(&gauss_legendre(24), |a, b| {
        2.0 * a * ceiling_irradiance(&SQUARE, [a * (1.0 - b), a * b])
    });
    assert!((exact - 0.627_768_424).abs() < 1e-9, "{exact}");
    Integral {
        exact,
        value: |stream, i| {
            let [u0, u1, x, y] = stream.sample_4d(i);
            light_integrand([x, y], uniform_triangle([u0, u1]).map(f64::from))
        },
    }
}

#[test]
fn random_errors_fall_like_the_square_root() {
    for integral in [smooth_light(), cut_light(), cube_gather(), triangle_under_light()] {
        let slope = integral.slope(SamplerKind::Random);
        assert!((slope + 0.5).abs() < 0.07, "{slope}");
    }
}

/// In theory -1.5 up to logarithms; measured -1.43.
#[test]
fn sobol_errors_of_smooth_light_fall_fastest() {
    let slope = smooth_light().slope(SamplerKind::Sobol);
    assert!(slope <= -1.25, "{slope}");
}

/// An edge in 2-D crosses √N of N cells, which gives -0.75 for every stratified set.
#[test]
fn errors_of_light_with_an_edge_fall_like_the_three_quarter_power() {
    for integral in [cut_light(), cube_gather()] {
        for kind in [SamplerKind::Stratified, SamplerKind::Halton, SamplerKind::Sobol] {
            let slope = integral.slope(kind);
            assert!(slope <= -0.65, "{kind}: {slope}");
        }
    }
}

/// In theory -1 for jittered cells. Halton points are as good up to logarithms; measured -0.91.
#[test]
fn stratified_and_halton_errors_of_smooth_light_fall_almost_linearly() {
    let light = smooth_light();
    let stratified = light.slope(SamplerKind::Stratified);
    assert!((stratified + 1.0).abs() < 0.07, "{stratified}");
    let halton = light.slope(SamplerKind::Halton);
    assert!(halton <= -0.8, "{halton}");
}

#[test]
fn sobol_gathers_four_times_more_accurately_than_random() {
    let gather = cube_gather();
    let at_256 = |kind| gather.errors(kind)[2].1;
    let gain = at_256(SamplerKind::Random) / at_256(SamplerKind::Sobol);
    assert!(gain >= 4.0, "{gain}");
}

/// Measured -1.12 for true 4-D Sobol points, -0.75 for Halton points, but only -0.5 for two padded grids.
#[test]
fn only_true_4d_points_converge_fast_in_4d() {
    let integral = triangle_under_light();
    let sobol = integral.slope(SamplerKind::Sobol);
    assert!(sobol <= -1.0, "{sobol}");
    let halton = integral.slope(SamplerKind::Halton);
    assert!(halton <= -0.65, "{halton}");
    let padded = integral.slope(SamplerKind::Stratified);
    assert!((-0.65..=-0.45).contains(&padded), "{padded}");
}
