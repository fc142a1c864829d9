//! Closed rooms whose walls all emit and reflect alike: every point sees the same light.

use crate::{mean, solved, solved_by};
use glam::Vec3;
use lumel_sample::SamplerKind;
use lumel_scene::{Face, MaterialId, ObjectMesh, SceneBuilder, Smoothing};
use lumel_solve::Stop;
use lumel_testkit::mesh::{Facing, cuboid, sphere};
use lumel_testkit::scene::{cube, grey, scene};
use lumel_testkit::{Estimate, Method, ROUNDING, Stage};
use lumel_transport::{EmitterSampling, LightSampling, Plan};

const ALBEDOS: [f32; 5] = [0.0, 0.2, 0.5, 0.8, 0.95];
const BOUNCES: u32 = 5;

/// Solves with few rays, found by rays and so without variance, and compares every node of every bounce.
#[track_caller]
fn assert_furnace(name: &str, make: impl Fn(f32) -> SceneBuilder, n_rays: u32) {
    for albedo in ALBEDOS {
        let stage = Stage::new(make(albedo));
        for method in Method::ALL {
            for sampler in SamplerKind::ALL {
                let plan = Plan {
                    sampler,
                    indirect_samples: n_rays,
                    direct_samples: n_rays,
                    emitters: EmitterSampling::Rays,
                    ..Plan::default()
                };
                let state = solved(&stage, method, plan, Stop::Bounces(BOUNCES));
                let label = format!("{name}, albedo {albedo}, {method}, {sampler}");
                assert!(state.valid.iter().all(|valid| *valid), "{label}: a node counts as hidden");
                let mut series = 0.0;
                let mut totals = vec![0.0; state.valid.len()];
                for (bounce, field) in state.bounces.iter().enumerate() {
                    series += f64::from(albedo).powi(bounce as i32);
                    for (node, e) in field.values().iter().enumerate() {
                        totals[node] += f64::from(e.x);
                        let off = totals[node] / series - 1.0;
                        // Each bounce adds the rounding of a few products.
                        let tolerance = ROUNDING * (1.0 + bounce as f64);
                        assert!(off.abs() < tolerance, "{label}, bounce {bounce}, node {node}: {off:+.2e}");
                    }
                }
            }
        }
    }
}

fn emissive_cube(albedo: f32) -> SceneBuilder {
    cube(3, [(); 6].map(|()| grey(albedo, 1.0)))
}

fn with(occluder: Vec<ObjectMesh>, albedo: f32) -> SceneBuilder {
    let mut builder = emissive_cube(albedo);
    builder.objects.extend(occluder);
    builder
}

#[test]
fn an_emissive_cube_is_the_geometric_series_in_every_vertex_with_one_ray() {
    assert_furnace("cube", emissive_cube, 1);
}

#[test]
fn an_emissive_cube_stays_so_with_many_rays() {
    assert_furnace("cube", emissive_cube, 64);
}

#[test]
fn an_emissive_sphere_is_the_geometric_series_with_one_ray() {
    let ball = |albedo| {
        let mesh = sphere(Vec3::new(0.3, -0.2, 0.1), 1.0, 2, Facing::Inward, 0);
        scene(vec![mesh], vec![grey(albedo, 1.0)], vec![])
    };
    assert_furnace("sphere", ball, 1);
}

#[test]
fn a_coarse_emissive_sphere_loses_no_ray_of_many() {
    // Twenty faces: around each corner the next ones rise steeply.
    let ball = |albedo| {
        let mesh = sphere(Vec3::ZERO, 1.0, 0, Facing::Inward, 0);
        scene(vec![mesh], vec![grey(albedo, 1.0)], vec![])
    };
    assert_furnace("icosahedron", ball, 256);
}

#[test]
fn a_box_inside_a_furnace_cannot_be_seen() {
    let inner = || cuboid(Vec3::new(0.2, 0.3, 0.15), Vec3::new(0.6, 0.5, 0.8), 2, Facing::Outward, [0; 6]);
    assert_furnace("cube with a box", |albedo| with(inner(), albedo), 1);
}

#[test]
fn a_ball_inside_a_furnace_cannot_be_seen() {
    let inner = || vec![sphere(Vec3::new(0.5, 0.4, 0.6), 0.25, 1, Facing::Outward, 0)];
    assert_furnace("cube with a ball", |albedo| with(inner(), albedo), 16);
}

/// Four equal triangles that look at each other.
fn tetrahedron(albedo: f32) -> SceneBuilder {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(Vec3::from);
    let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Flat };
    let mesh = ObjectMesh {
        positions: corners.into(),
        faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(face).into(),
        ..ObjectMesh::default()
    };
    scene(vec![mesh], vec![grey(albedo, 1.0)], vec![])
}

#[test]
fn closed_forms_of_an_emissive_tetrahedron_add_up_without_noise() {
    let stage = Stage::new(tetrahedron(0.5));
    for sampler in SamplerKind::ALL {
        let plan = Plan { sampler, emitters: EmitterSampling::Lights, direct_samples: 16, ..Plan::default() };
        for method in Method::ALL {
            let state = solved(&stage, method, plan, Stop::Bounces(0));
            for (node, e) in state.bounces[0].values().iter().enumerate() {
                // Origins start a thousandth inside the room; the room is closed as seen from anywhere.
                assert!((e.x - 1.0).abs() < 1e-5, "{method}, {sampler}, node {node}: {}", e.x);
            }
        }
    }
}

#[test]
fn sampling_the_glow_as_lights_gives_the_same_mean() {
    // Twelve triangles: chosen by power. Uniform in solid angle, so that touching walls keep a finite variance.
    let stage = Stage::new(cube(1, [(); 6].map(|()| grey(0.5, 1.0))));
    for sampler in SamplerKind::ALL {
        for method in Method::ALL {
            let means: Vec<[f64; 2]> = (0..32)
                .map(|seed| {
                    let plan = Plan {
                        sampler,
                        seed,
                        emitters: EmitterSampling::Lights,
                        light_sampling: LightSampling::Analytic,
                        direct_samples: 128,
                        indirect_samples: 32,
                        portion: 0,
                    };
                    let operator = stage.operator(method, plan);
                    let state = solved_by(&operator, &stage, Stop::Bounces(2));
                    [mean(&operator, &state.bounces[0]), mean(&operator, &state.total())]
                })
                .collect();
            let label = |what| format!("{what}, {method}, {sampler}");
            // Every corner of the cube is a node: 64 samples of light as uneven as itself bias a ratio by 1.4 %, with
            // the sign of a correlation that vanishes here by symmetry.
            Estimate::new(means.iter().map(|m| m[0])).assert_near(1.0, 1e-3, label("direct"));
            Estimate::new(means.iter().map(|m| m[1])).assert_near(1.75, 2e-3, label("two bounces"));
        }
    }
}
