//! Moments of light by direction: coefficients of spherical harmonics.

use glam::{DVec3, Vec3};
use lumel_basis::{AreaReceivers, Directional, HARMONICS, NodeId, PointReceivers, spherical_harmonics};
use lumel_sample::{Frame, SamplerKind};
use lumel_scene::{
    DirectionalLight, Light, PointLight, Radiance, SceneBuilder, Sky, SkyGradient, SkyImage, SphereLight,
    SpotLight, SunLight, Texture,
};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{ceiling_light, cube, grey, lights_only, scene};
use lumel_testkit::{Estimate, Estimator, ROUNDING, Stage, measure, replicates};
use lumel_transport::{Emitter, EmitterMask, EmitterSampling, LightSampling, Plan, Source};
use std::f64::consts::{PI, TAU};

type Channels = [f64; 1 + HARMONICS];

/// A normal that favours no axis.
const TILTED: Vec3 = Vec3::new(0.6, 0.64, 0.48);

/// What light of radiance `l` by direction brings in each channel at a normal, by quadrature.
fn moments(normal: Vec3, l: impl Fn(DVec3) -> f64) -> Channels {
    let (n_rings, n_turns) = (600, 1200);
    let frame = Frame::from_normal(normal);
    let mut sums = [0.0; 1 + HARMONICS];
    for ring in 0..n_rings {
        let z = (f64::from(ring) + 0.5) / f64::from(n_rings);
        for turn in 0..n_turns {
            let (sin, cos) = (TAU * (f64::from(turn) + 0.5) / f64::from(n_turns)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let direction = frame.to_world(DVec3::new(r * cos, r * sin, z).as_vec3());
            let weight = l(direction.as_dvec3()) * TAU / f64::from(n_rings * n_turns);
            sums[0] += weight * z;
            for (sum, y) in sums[1..].iter_mut().zip(spherical_harmonics(direction)) {
                *sum += weight * f64::from(y);
            }
        }
    }
    sums
}

/// What light from one direction brings in each channel that gives a surface that faces it an irradiance of one.
fn of_direction(normal: Vec3, direction: Vec3) -> Channels {
    let y = spherical_harmonics(direction).map(f64::from);
    std::array::from_fn(|k| if k == 0 { f64::from(normal.dot(direction)).max(0.0) } else { y[k - 1] })
}

/// Fails unless a point with a normal has these moments in all kinds of directional light.
#[track_caller]
fn assert_moments(stage: &Stage, point: (Vec3, Vec3), plan: Plan, truth: &Channels, bound: f64, what: &str) {
    let n = 32;
    for kind in [Directional::Sh1, Directional::Sh2] {
        let receivers = PointReceivers::new(stage.scene(), [point]).expect("points have normals");
        let transport = stage.directional(receivers, kind, plan);
        assert_eq!(transport.shape().channels, kind.channels());
        let fields = replicates(&*transport, Source::Emitters(None), n);
        for (channel, truth) in truth[..kind.channels()].iter().enumerate() {
            let estimate = Estimate::of_channel(&fields, 0, channel);
            estimate.assert_near_among(10, *truth, bound, format!("{what}, {kind:?}, channel {channel}"));
        }
    }
}

/// A black floor that faces up, z, under a sky.
fn under(sky: Sky) -> SceneBuilder {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, -100.0));
    SceneBuilder { sky, ..scene(vec![quad(corners, [2, 2], 0)], vec![grey(0.0, 0.0)], Vec::new()) }
}

#[test]
fn an_even_sky_has_the_moments_of_a_hemisphere() {
    let stage = Stage::new(under(Sky::Uniform(Radiance::splat(1.0))));
    let n = TILTED.as_dvec3();
    let along = [n.y, n.z, n.x].map(|n| 1.534_990_062 * n);
    let mut truth = [0.0; 1 + HARMONICS];
    truth[..5].copy_from_slice(&[PI, 1.772_453_851, along[0], along[1], along[2]]);
    // The floor hides 3e-5 of the hemisphere.
    for estimator in Estimator::all() {
        assert_moments(&stage, (Vec3::ZERO, TILTED), estimator.plan(16, 256), &truth, 2e-4, "sky");
    }
}

#[test]
fn lights_without_area_have_the_harmonics_of_their_direction() {
    let direction = Vec3::new(-0.36, 0.48, 0.8);
    let point = PointLight { position: 2.0 * direction, intensity: Vec3::splat(4.0), range: f32::INFINITY };
    let lights = [
        Light::Directional(DirectionalLight { direction: -direction, irradiance: Vec3::ONE }),
        Light::Point(point),
        Light::Spot(SpotLight { point, direction: -direction, cos_inner: 0.9, cos_outer: 0.8 }),
    ];
    for light in lights {
        let stage = Stage::new(lights_only(vec![light]));
        let truth = of_direction(TILTED, direction);
        assert_moments(
            &stage,
            (Vec3::ZERO, TILTED),
            Plan::default(),
            &truth,
            10.0 * ROUNDING,
            &format!("{light:?}"),
        );
    }
}

#[test]
fn a_sun_of_a_small_disk_is_nearly_a_direction() {
    let direction = Vec3::new(-0.36, 0.48, 0.8);
    let parallel = DirectionalLight { direction: -direction, irradiance: Vec3::ONE };
    let stage = Stage::new(lights_only(vec![Light::Sun(SunLight { parallel, sin_half_angle: 0.01 })]));
    let truth = of_direction(TILTED, direction);
    for estimator in Estimator::all() {
        assert_moments(&stage, (Vec3::ZERO, TILTED), estimator.plan(16, 16), &truth, 3e-4, "sun");
    }
}

/// The mean and the variance of each channel over many measurements of a point above the floor.
fn spread(stage: &Stage, light_sampling: LightSampling) -> [[f64; 2]; 1 + HARMONICS] {
    let receivers = PointReceivers::new(stage.scene(), [(Vec3::ZERO, Vec3::Z)]).expect("a normal");
    let plan = Plan { direct_samples: 16, light_sampling, ..Plan::default() };
    let fields =
        replicates(&*stage.directional(receivers, Directional::Sh2, plan), Source::Emitters(None), 64);
    std::array::from_fn(|channel| {
        let estimate = Estimate::of_channel(&fields, 0, channel);
        [estimate.mean, 64.0 * estimate.error.powi(2)]
    })
}

#[test]
fn spheres_and_suns_have_closed_forms_that_take_noise_off() {
    let direction = Vec3::new(0.6, 0.48, 0.64);
    let sphere = |center| Light::Sphere(SphereLight { center, radius: 0.5, radiance: Radiance::splat(2.0) });
    let parallel = DirectionalLight { direction: -direction, irradiance: Vec3::splat(0.5) };
    let lights = [
        sphere(direction),
        // The horizon cuts it.
        sphere(Vec3::new(0.8, 0.6, 0.2)),
        Light::Sun(SunLight { parallel, sin_half_angle: 0.4 }),
    ];
    for light in lights {
        let stage = |is_hidden: bool| {
            let wall = [[-9.0, 0.0], [9.0, 0.0], [9.0, 9.0], [-9.0, 9.0]];
            // It hides what is lower than about the middle of the light.
            let wall = wall.map(|[across, up]| {
                let along = Vec3::new(-0.6, 0.8, 0.0) * across + Vec3::Z * (0.1 * light_height(&light) - up);
                0.1 * Vec3::new(0.8, 0.6, 0.0) + along
            });
            let walls = if is_hidden { vec![quad(wall, [1, 1], 0)] } else { vec![] };
            let mut scene = lights_only(vec![light]);
            scene.objects.extend(walls);
            Stage::new(scene)
        };
        for is_hidden in [false, true] {
            let stage = stage(is_hidden);
            let [closed, sampled] =
                [LightSampling::Analytic, LightSampling::Area].map(|by| spread(&stage, by));
            let total = |spread: &[[f64; 2]]| spread[1..].iter().map(|[_, variance]| variance).sum::<f64>();
            println!(
                "{light:?}, hidden {is_hidden}: variance {:.3e}, without {:.3e}",
                total(&closed),
                total(&sampled)
            );
            for (channel, ([a, of_a], [b, of_b])) in closed.into_iter().zip(sampled).enumerate() {
                let noise = 5.0 * ((of_a + of_b) / 64.0).sqrt();
                assert!((a - b).abs() < noise + 1e-5, "{light:?} {is_hidden} {channel}: {a} {b}");
            }
            // Half hidden, a few samples of the pilot guess the share that is seen badly.
            let most = if is_hidden { 2.0 } else { 1e-8 };
            assert!(total(&closed) < most * total(&sampled), "{light:?} {is_hidden}");
        }
    }
}

/// How high the middle of a light stands per horizontal distance.
fn light_height(light: &Light) -> f32 {
    let towards = match light {
        Light::Sphere(sphere) => sphere.center,
        Light::Sun(sun) => -sun.parallel.direction,
        _ => Vec3::Z,
    };
    towards.z / towards.truncate().length()
}

#[test]
fn light_at_the_horizon_counts() {
    // A hundredth above it: no irradiance to speak of, and all of its moments.
    let direction = Vec3::new(1.0, 0.0, 0.01).normalize();
    let light = Light::Directional(DirectionalLight { direction: -direction, irradiance: Vec3::ONE });
    let stage = Stage::new(lights_only(vec![light]));
    let receivers = PointReceivers::new(stage.scene(), [(Vec3::ZERO, Vec3::Z)]).unwrap();
    let transport = stage.directional(receivers, Directional::Sh1, Plan::default());
    let field = measure(&*transport, Source::Emitters(None), 0).field;
    let [e, c00, .., c11] = field.coefficients(NodeId(0)) else { unreachable!("five channels") };
    assert!(e.x < 0.011 && (c00.x - 0.282_095).abs() < 1e-5 && (c11.x - 0.488_6).abs() < 1e-4, "{field:?}");
}

#[test]
fn a_sky_that_varies_has_the_moments_of_its_radiance() {
    let gradient = SkyGradient {
        zenith: Radiance::splat(3.0),
        horizon: Radiance::splat(1.0),
        ground: Radiance::splat(0.25),
    };
    // The image has a sun in one texel, which shadow rays and hemisphere rays find together.
    let texels =
        (0..64 * 32).map(|i| [if i == 20 + 9 * 64 { 1e3 } else { 0.1 + (i % 5) as f32 }; 3]).collect();
    let image = SkyImage::new(Texture::from_floats("sky", 64, 32, texels).unwrap(), 0.3, 1.0);
    for (sky, plan_samples) in [(Sky::from(gradient), [1, 256]), (Sky::from(image), [64, 256])] {
        let truth = moments(TILTED, |direction| f64::from(sky.radiance(direction.as_vec3()).0.x));
        let stage = Stage::new(under(sky));
        for sampler in SamplerKind::ALL {
            let plan = Plan {
                sampler,
                direct_samples: plan_samples[0],
                indirect_samples: plan_samples[1],
                ..Plan::default()
            };
            // Quadrature of texels with edges, and the floor far below.
            assert_moments(&stage, (Vec3::ZERO, TILTED), plan, &truth, 0.02, &format!("{sampler}"));
        }
    }
}

/// The walls −x, +x, −y, +y, −z, +z of the unit cube, by radiance.
const WALLS: [f64; 6] = [0.1, 0.9, 0.3, 0.6, 0.2, 1.0];

/// A place within the cube.
const INSIDE: Vec3 = Vec3::new(0.3, 0.4, 0.45);

/// The wall that is seen from there.
fn wall(direction: DVec3) -> usize {
    let d = direction.to_array();
    let t = |axis: usize| {
        let from = f64::from(INSIDE[axis]);
        if d[axis] > 0.0 { (1.0 - from) / d[axis] } else { -from / d[axis] }
    };
    let axis = (0..3).min_by(|&a, &b| t(a).total_cmp(&t(b))).expect("there are three");
    2 * axis + usize::from(d[axis] > 0.0)
}

#[test]
fn emissive_walls_have_their_moments_by_rays_and_as_lights() {
    let glow = |w: usize| grey(0.0, (WALLS[w] * PI) as f32);
    let stage = Stage::new(cube(1, [0, 1, 2, 3, 4, 5].map(glow)));
    let truth = moments(TILTED, |direction| WALLS[wall(direction)]);
    for emitters in [EmitterSampling::Rays, EmitterSampling::Lights] {
        for estimator in Estimator::all() {
            let plan = Plan { emitters, ..estimator.plan(64, 256) };
            let what = format!("{emitters:?}, {estimator}");
            // Origins are pushed off: see `ORIGIN_SHIFT` in `gather`; the quadrature has edges.
            assert_moments(&stage, (INSIDE, TILTED), plan, &truth, 1e-3, &what);
        }
    }
}

#[test]
fn reflected_light_has_the_moments_of_what_is_seen() {
    let stage = Stage::new(cube(2, [(); 6].map(|()| grey(0.5, 0.0))));
    let index =
        |n: Vec3| (0..3).find(|&axis| n[axis].abs() > 0.9).map(|axis| 2 * axis + usize::from(n[axis] < 0.0));
    let source = stage.field(|_, n| index(n).map_or(0.0, |w| (WALLS[w] * PI / 0.5) as f32));
    let truth = moments(TILTED, |direction| WALLS[wall(direction)]);
    for sampler in SamplerKind::ALL {
        let plan = Plan { sampler, indirect_samples: 256, ..Plan::default() };
        let receivers = PointReceivers::new(stage.scene(), [(INSIDE, TILTED)]).unwrap();
        let transport = stage.directional(receivers, Directional::Sh2, plan);
        let fields = replicates(&*transport, Source::Field(&source), 32);
        for (channel, truth) in truth.iter().enumerate() {
            let estimate = Estimate::of_channel(&fields, 0, channel);
            estimate.assert_near_among(10, *truth, 1e-3, format!("{sampler}, channel {channel}"));
        }
    }
}

#[test]
fn over_areas_moments_are_means_under_hat_functions() {
    // On a floor under an even sky all means are the same; a lamp makes them differ, and channel 0 tells by how much.
    let sky = Sky::Uniform(Radiance::splat(1.0));
    let stage = Stage::new(SceneBuilder { sky, ..under(Sky::default()) });
    for sampler in SamplerKind::ALL {
        let plan = Plan { sampler, indirect_samples: 256, direct_samples: 16, ..Plan::default() };
        let transport = stage.directional(AreaReceivers::new(stage.basis().clone()), Directional::Sh2, plan);
        let fields = replicates(&*transport, Source::Emitters(None), 32);
        let truth = moments(Vec3::Z, |_| 1.0);
        for node in 0..stage.nodes().len() {
            for (channel, truth) in truth.iter().enumerate() {
                let estimate = Estimate::of_channel(&fields, node, channel);
                let what = format!("{sampler}, node {node}, channel {channel}");
                estimate.assert_near_among(10 * stage.nodes().len(), *truth, 1e-4, what);
            }
        }
    }
}

#[test]
fn channel_zero_is_what_other_operators_measure() {
    let lamp = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.9), 0.4, 0.4, 5.0));
    let point = PointLight { position: Vec3::new(0.2, 0.3, 0.8), intensity: Vec3::ONE, range: f32::INFINITY };
    let room =
        SceneBuilder { lights: vec![lamp, Light::Point(point)], ..cube(2, [(); 6].map(|()| grey(0.5, 0.1))) };
    let stage = Stage::new(room);
    let plan = Plan { direct_samples: 32, indirect_samples: 256, ..Plan::default() };
    let directional = stage.directional(AreaReceivers::new(stage.basis().clone()), Directional::Sh1, plan);
    let plain = stage.operator(lumel_testkit::Method::AREA.traced(), plan).transport;
    let reflected = stage.field(|p, _| 1.0 + p.x);
    for source in [Source::Emitters(None), Source::Field(&reflected)] {
        let [a, b] = [&directional, &plain].map(|transport| replicates(&**transport, source, 32));
        for node in 0..stage.nodes().len() {
            let [a, b] = [&a, &b].map(|fields| Estimate::of_channel(fields, node, 0));
            let noise = a.tolerance(60).hypot(b.tolerance(60));
            assert!((a.mean - b.mean).abs() < noise + 1e-5, "{source:?} {node}: {a:?} {b:?}");
        }
    }
}

#[test]
fn moments_of_all_lights_are_the_sum_of_those_of_each() {
    let lamp = |x: f32| Light::Rect(ceiling_light(Vec3::new(x, 0.5, 0.9), 0.2, 0.4, 5.0));
    // More than eight are chosen from a tree, where masks leave samples out.
    for n in [2, 12] {
        let lights = (0..n).map(|i| lamp(0.1 + 0.8 * i as f32 / n as f32)).collect();
        let stage = Stage::new(SceneBuilder { lights, ..cube(1, [(); 6].map(|()| grey(0.5, 0.0))) });
        let transport =
            stage.directional(PointReceivers::at_vertices(stage.basis()), Directional::Sh2, Plan::default());
        let of = |mask: Option<&EmitterMask>| measure(&*transport, Source::Emitters(mask), 0).field;
        let only = |emitter| EmitterMask::only(stage.scene(), &[emitter]);
        let parts: Vec<_> =
            Emitter::all(stage.scene()).into_iter().map(|emitter| of(Some(&only(emitter)))).collect();
        assert_eq!(parts.len(), n);
        let (all, sum) = (of(None), lumel_basis::Field::sum(stage.nodes().len(), &parts));
        for (a, b) in all.values().iter().zip(sum.values()) {
            assert!((*a - *b).length() < 1e-5 * (1.0 + a.length()), "{n}: {a} {b}");
        }
    }
}
