//! Known answers, and the errors that are documented.

use super::*;
use lumel_sample::{Dim, Sampler, StreamKey, uniform_hemisphere, unit_hash};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Grey light of these coefficients, the others being zero.
fn grey(coefficients: &[(usize, f32)]) -> IncidentRadiance {
    let mut all = [Vec3::ZERO; HARMONICS];
    coefficients.iter().for_each(|&(i, c)| all[i] = Vec3::splat(c));
    IncidentRadiance::new(&all).unwrap()
}

/// Light from direction +z that gives the irradiance 1 there.
fn from_above() -> IncidentRadiance {
    IncidentRadiance::new(&spherical_harmonics(Vec3::Z).map(Vec3::splat)).unwrap()
}

fn tilted(degrees: f32) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(sin, 0.0, cos)
}

fn assert_irradiance(light: &IncidentRadiance, degrees: f32, expected: [f32; 4]) {
    for (shading, expected) in
        [Shading::Linear, Shading::Quadratic, Shading::NonLinear, Shading::Zh3].into_iter().zip(expected)
    {
        let found = shading.irradiance(light, tilted(degrees)).0.x;
        assert!((found - expected).abs() < 1e-5, "{shading} at {degrees}: {found}, not {expected}");
    }
}

#[test]
fn shading_of_known_light_is_as_computed_by_hand() {
    // Radiance 1 from above the horizon.
    let sky = grey(&[(0, 1.772_453_9), (2, 1.534_990_1)]);
    assert_irradiance(&sky, 0.0, [PI, PI, 3.665_191, 3.597_575]);
    assert_irradiance(&sky, 60.0, [2.356_194, 2.356_194, 2.290_745, 2.299_197]);
    assert_irradiance(&sky, 90.0, [FRAC_PI_2, FRAC_PI_2, 1.308_997, 1.342_805]);
    assert_irradiance(&from_above(), 0.0, [0.75, 1.0625, 1.0, 1.020_923]);
    assert_irradiance(&from_above(), 60.0, [0.5, 0.460_938, 0.421_875, 0.466_135]);
    assert_irradiance(&from_above(), 90.0, [0.25, 0.093_75, 0.125, 0.114_539]);
    assert_irradiance(&from_above(), 180.0, [-0.25, 0.0625, 0.0, 0.020_923]);
    let cosine = grey(&[(0, 0.886_227), (2, 1.023_327), (6, 0.495_416)]);
    assert_irradiance(&cosine, 0.0, [1.832_596, 2.078_033, 2.251_475, 2.224_394]);
    let everywhere = grey(&[(0, 3.544_907_7)]);
    for degrees in [0.0, 33.0, 180.0] {
        assert_irradiance(&everywhere, degrees, [PI; 4]);
    }
}

#[test]
fn normals_that_are_not_tilted_show_what_was_measured() {
    let light = grey(&[(0, 1.0), (1, 0.3), (2, 0.9), (3, -0.2), (4, 0.1), (6, 0.2)]);
    let measured = Irradiance(Vec3::new(1.0, 2.5, 0.25));
    for shading in Shading::ALL {
        let flat = tilted(17.0);
        assert_eq!(shading.shade(measured, &light, flat, flat), measured, "{shading}");
        let bright = shading.shade(measured, &light, flat, Vec3::new(0.0, 0.6, 0.8)).0;
        assert!(bright.cmpgt(measured.0).all(), "{shading}: {bright}");
    }
}

#[test]
fn ratios_are_bounded_and_darkness_stays_dark() {
    let measured = Irradiance::splat(1.0);
    let horizon = IncidentRadiance::new(&spherical_harmonics(Vec3::X).map(Vec3::splat)).unwrap();
    for shading in Shading::ALL {
        let [towards, away] =
            [Vec3::X, Vec3::NEG_X].map(|n| shading.shade(measured, &horizon, Vec3::Z, n).0.x);
        assert!(
            towards > 2.0 && towards <= MOST && (0.0..0.7).contains(&away),
            "{shading}: {towards} {away}"
        );
        let dark = shading.shade(Irradiance::ZERO, &grey(&[]), Vec3::Z, tilted(40.0));
        assert_eq!(dark, Irradiance::ZERO, "{shading}");
        let noise = grey(&[(0, -0.1), (1, 1.0)]);
        assert!(shading.shade(measured, &noise, Vec3::Z, tilted(40.0)).0.is_finite(), "{shading}");
    }
}

#[test]
fn colours_are_shaded_apart() {
    let (red, blue) = (spherical_harmonics(tilted(50.0)), spherical_harmonics(tilted(-50.0)));
    let mut coefficients = [Vec3::ZERO; 4];
    for (i, c) in coefficients.iter_mut().enumerate() {
        *c = Vec3::new(red[i], 0.0, blue[i]);
    }
    let light = IncidentRadiance::new(&coefficients).unwrap();
    for shading in Shading::ALL {
        let found = shading.shade(Irradiance::splat(1.0), &light, Vec3::Z, tilted(30.0)).0;
        assert!(found.x > 1.05 && found.z < 0.9 && found.y == 1.0, "{shading}: {found}");
    }
}

#[test]
fn four_coefficients_do_for_l2() {
    let light = IncidentRadiance::new(&from_above().coefficients()[..4]).unwrap();
    let [l2, zh3] = [Shading::Quadratic, Shading::Zh3].map(|s| s.irradiance(&light, tilted(20.0)));
    assert_eq!(l2, zh3);
    for count in [0, 1, 3, 5, 8, 10] {
        assert_eq!(IncidentRadiance::new(&vec![Vec3::ONE; count]), None);
    }
}

#[test]
fn names_round_trip() {
    for shading in Shading::ALL {
        assert_eq!(shading.to_string().parse(), Ok(shading));
    }
    let error = "L2".parse::<Shading>().unwrap_err().to_string();
    let names = Shading::ALL.map(Shading::name).join(", ");
    assert_eq!(error, format!("unknown shading \"L2\": expected one of {names}"));
}

/// Light above a surface: from everywhere, and from one to four lobes.
struct Lobes {
    ambient: f32,
    /// Direction, exponent of the cosine, power.
    lobes: Vec<(Vec3, f32, f32)>,
}

impl Lobes {
    fn random(seed: u32) -> Self {
        let random = |lobe: u32, what: u32| unit_hash(&[seed, lobe, what]);
        let lobe = |k: u32| {
            let exponent = 4.0 * 16_f32.powf(random(k, 0));
            let direction = uniform_hemisphere([random(k, 1), random(k, 2)]);
            (direction, exponent, random(k, 3) * (exponent + 1.0) / TAU)
        };
        let count = 1 + (4.0 * random(0, 0)) as u32;
        Self { ambient: 0.2 * random(0, 1), lobes: (1..=count).map(lobe).collect() }
    }

    fn radiance(&self, direction: Vec3) -> f32 {
        let lobe =
            |&(axis, exponent, power): &(Vec3, f32, f32)| power * axis.dot(direction).max(0.0).powf(exponent);
        self.ambient + self.lobes.iter().map(lobe).sum::<f32>()
    }
}

#[test]
fn the_errors_of_all_shadings_are_those_that_are_documented() {
    let points = |n: u32, seed| {
        let stream = Sampler::Sobol.stream(StreamKey::new(seed), Dim::Hemisphere);
        (0..n).map(move |i| stream.sample_2d(i))
    };
    let directions: Vec<Vec3> = points(2048, 1).map(uniform_hemisphere).collect();
    let share = TAU / directions.len() as f32;
    // Even over the cap of 45°.
    let normals: Vec<Vec3> = points(16, 2)
        .map(|[u, v]| {
            let z = 1.0 - u * (1.0 - 0.5_f32.sqrt());
            let (sin, cos) = (TAU * v).sin_cos();
            Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + z * Vec3::Z
        })
        .collect();
    let (mut raw, mut shaded) = ([0.0_f32; 4], [0.0_f32; 4]);
    let trials = 200;
    for seed in 0..trials {
        let lobes = Lobes::random(seed);
        let radiances: Vec<f32> = directions.iter().map(|&d| share * lobes.radiance(d)).collect();
        let mut coefficients = [Vec3::ZERO; HARMONICS];
        for (&direction, &radiance) in directions.iter().zip(&radiances) {
            let at = spherical_harmonics(direction);
            coefficients.iter_mut().zip(at).for_each(|(c, y)| *c += Vec3::splat(radiance * y));
        }
        let light = IncidentRadiance::new(&coefficients).unwrap();
        let truth =
            |n: Vec3| directions.iter().zip(&radiances).map(|(d, r)| r * d.dot(n).max(0.0)).sum::<f32>();
        let flat = truth(Vec3::Z);
        for &normal in &normals {
            let truth = truth(normal);
            for (i, shading) in Shading::ALL.into_iter().enumerate() {
                let of_light = shading.irradiance(&light, normal).0.x;
                let of_ratio = shading.shade(Irradiance::splat(flat), &light, Vec3::Z, normal).0.x;
                raw[i] += ((of_light - truth) / flat).powi(2);
                shaded[i] += ((of_ratio - truth) / flat).powi(2);
            }
        }
    }
    let percent = |sum: f32| 100.0 * (sum / (trials as usize * normals.len()) as f32).sqrt();
    let (raw, shaded) = (raw.map(percent), shaded.map(percent));
    // Kinds in the order of `Shading::ALL`.
    let near = |found: [f32; 4], expected: [f32; 4]| {
        let is_near = |(found, expected): (&f32, &f32)| (found / expected - 1.0).abs() < 0.2;
        assert!(found.iter().zip(&expected).all(is_near), "{found:?} {expected:?}");
    };
    near(raw, [11.8, 9.1, 8.6, 2.2]);
    near(shaded, [13.1, 6.4, 6.4, 2.9]);
}
