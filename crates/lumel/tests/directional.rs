//! Light by direction: what it is beside irradiance, in every kind of bake.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Coefficients, Control, Directional, Layers, Light, Memory, Method, Projection, Saved,
    Scene, SceneBuilder, Settings, Silent, SolveState, SolverKind, Step, Tail,
};
use lumel_basis::{Field, NodeId};
use lumel_scene::{PointLight, Radiance};
use lumel_testkit::mesh::{self, Facing, cuboid};
use lumel_testkit::scene::{ceiling_light, grey, placed, scene};
use std::sync::{Arc, Mutex};

fn settings() -> Settings {
    Settings {
        bounces: BounceLimit::Count(2),
        direct_samples: 8,
        indirect_samples: 64,
        ..Settings::default()
    }
}

/// A room without a ceiling, with a box in it, a lamp, a bulb and a sky.
fn room() -> SceneBuilder {
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 5, Facing::Inward, [0; 6]);
    objects.pop();
    let (min, max) = (Vec3::new(0.25, 0.3, -0.1), Vec3::new(0.6, 0.7, 0.4));
    objects.extend(cuboid(min, max, 2, Facing::Outward, [0; 6]));
    let lamp = ceiling_light(Vec3::new(0.3, 0.7, 0.9), 0.2, 0.2, 9.0);
    let bulb = PointLight {
        position: Vec3::new(0.2, 0.3, 0.6),
        intensity: Vec3::new(0.3, 0.2, 0.1),
        range: f32::INFINITY,
    };
    SceneBuilder {
        sky: Radiance(Vec3::new(0.1, 0.2, 0.3)).into(),
        ..scene(objects, vec![grey(0.6, 0.0)], vec![Light::Rect(lamp), Light::Point(bulb)])
    }
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn solved(baker: &Baker) -> SolveState {
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

/// Every way of solving, with every projection.
fn ways() -> Vec<(String, Settings)> {
    let mut ways = Vec::new();
    for projection in [Projection::Point, Projection::Area, Projection::LeastSquares] {
        let settings = Settings { projection, ..settings() };
        let few = Settings { memory: Memory(60_000), tail: Tail::Geometric, ..settings.clone() };
        let to_error = Settings { target_error: "40%".parse().unwrap(), ..settings.clone() };
        let neumann = Settings { solver: SolverKind::Neumann, ..settings.clone() };
        for (name, settings) in
            [("stored", settings), ("gathered", few), ("rounds", to_error), ("traced", neumann)]
        {
            ways.push((format!("{projection:?}, {name}"), settings));
        }
    }
    ways
}

#[test]
fn irradiance_keeps_its_bits_and_the_first_coefficients_are_the_same_for_both_kinds() {
    let scene = built(room());
    for (way, settings) in ways() {
        let with = |directional| Settings { directional, ..settings.clone() };
        let baker = Baker::new(Arc::clone(&scene), with(Directional::Off));
        let gathers = matches!(baker.method(), Method::FinalGather { .. });
        assert_eq!(gathers, way.ends_with("gathered"), "{way}: {}", baker.method());
        let plain = solved(&baker);
        let [sh1, sh2] = [Directional::Sh1, Directional::Sh2].map(|kind| {
            let baker = baker.relit(Arc::clone(&scene), with(kind));
            let mut state = solved(&baker);
            let solution = baker.solution(&state);
            let field = state.directional.take().unwrap();
            assert_eq!(field.channels(), kind.channels());
            assert!(state == plain, "{way}: bits of irradiance differ");
            let total = plain.total();
            assert!(field.values().iter().step_by(kind.channels()).eq(total.values()), "{way}");
            let light = solution.directional.unwrap();
            assert_eq!((light.kind(), light.len()), (kind, scene.vertex_count()));
            field
        });
        for node in (0..sh1.node_count() as u32).map(NodeId) {
            assert_eq!(sh1.coefficients(node), &sh2.coefficients(node)[..5], "{way}");
        }
    }
}

#[test]
fn the_bits_are_the_same_on_any_number_of_threads() {
    let scene = built(room());
    for (way, settings) in ways() {
        let settings = Settings { directional: Directional::Sh1, ..settings };
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solved(&Baker::new(Arc::clone(&scene), settings.clone())))
        };
        assert!(on(1) == on(3), "{way}");
    }
}

#[test]
fn a_solve_that_is_resumed_has_the_same_coefficients() {
    let scene = built(room());
    for (way, settings) in ways() {
        let settings = Settings { directional: Directional::Sh1, ..settings };
        let baker = Baker::new(Arc::clone(&scene), settings.clone());
        let whole = solved(&baker);
        // Directional light is no part of what bounces are: it may be asked for later.
        let part = Settings { bounces: BounceLimit::Count(1), directional: Directional::Off, ..settings };
        let part = Baker::new(Arc::clone(&scene), part);
        if matches!(part.method(), Method::Replicates { .. }) {
            continue;
        }
        let saved = Saved::Checkpoint(Box::new(part.checkpoint(&solved(&part))));
        let mut state = baker.resume(&saved).unwrap();
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        assert!(state == whole, "{way}");
        // What is finished is finished again with the same bits.
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        assert!(state == whole, "{way}");
    }
}

#[test]
fn coefficients_of_layers_add_up_to_those_of_all_light() {
    let scene = built(room());
    for (way, settings) in ways().into_iter().filter(|(way, _)| !way.ends_with("rounds")) {
        let settings = Settings { directional: Directional::Sh2, layers: Layers::Lights, ..settings };
        let baker = Baker::new(Arc::clone(&scene), settings);
        let state = solved(&baker);
        assert_eq!(state.directional_layers.len(), 3, "{way}");
        let (all, sum) = (state.directional.unwrap(), Field::sum(0, &state.directional_layers));
        let largest = all.values().iter().fold(0.0f32, |max, value| max.max(value.abs().max_element()));
        for (a, b) in all.values().iter().zip(sum.values()) {
            assert!((*a - *b).abs().max_element() < 1e-5 * largest, "{way}: {a} {b}");
        }
    }
}

#[test]
fn other_lights_take_shadow_rays_alone() {
    let scene = built(room());
    let lights = scene.lights()[..1].to_vec();
    let relit = Arc::new(scene.relit(lights).unwrap());
    for projection in [Projection::Point, Projection::Area] {
        let settings = Settings { projection, directional: Directional::Sh1, ..settings() };
        let baker = Baker::new(scene.clone(), settings.clone());
        solved(&baker);
        let rays = |baker: &Baker| {
            let (mut state, control) = (SolveState::new(), Control::default());
            baker.run(&mut state, &control, &Silent).unwrap();
            (state, control.rays())
        };
        let (state, few) = rays(&baker.relit(Arc::clone(&relit), settings.clone()));
        let (new, many) = rays(&Baker::new(Arc::clone(&relit), settings.clone()));
        assert!(state == new, "{projection:?}");
        assert!(3 * few < many, "{projection:?}: {few} of {many} rays");
        // Without memory for both, the rays by direction are traced each time: other samples of the same light.
        let Method::Cached { memory } = baker.method() else { panic!("rays are stored") };
        let traced = Baker::new(Arc::clone(&relit), Settings { memory, ..settings });
        assert_eq!(traced.method(), baker.method());
        assert!(solved(&traced).bounces == new.bounces, "{projection:?}");
    }
}

/// The mean coefficients of some vertices.
fn mean(light: &Coefficients, vertices: impl Iterator<Item = usize>) -> Vec<f32> {
    let (mut sums, mut n) = (vec![0.0; light.kind().harmonics()], 0.0);
    for vertex in vertices {
        sums.iter_mut().zip(light.of(vertex)).for_each(|(sum, c)| *sum += c.y);
        n += 1.0;
    }
    sums.into_iter().map(|sum| sum / n).collect()
}

#[test]
fn in_a_furnace_light_comes_from_everywhere() {
    // Radiance is M / π (1 − ρ) in all directions of the hemisphere: its coefficients are known.
    let sphere = mesh::sphere(Vec3::ZERO, 1.0, 2, Facing::Inward, 0);
    let scene = built(scene(vec![sphere], vec![grey(0.5, 1.0)], Vec::new()));
    for (way, settings) in ways() {
        let settings = Settings {
            directional: Directional::Sh2,
            bounces: BounceLimit::Count(3),
            indirect_samples: 256,
            tail: Tail::Off,
            ..settings
        };
        let baker = Baker::new(Arc::clone(&scene), settings);
        let solution = baker.solution(&solved(&baker));
        let radiance = (1.0 + 0.5 + 0.25 + 0.125) * std::f32::consts::FRAC_1_PI;
        let light = solution.directional.unwrap();
        let (mut worst, mut off) = (0.0f32, [0.0f64; 9]);
        for (vertex, n) in solution.normals.iter().enumerate() {
            let (c00, c1) = (1.772_453_9 * radiance, *n * 1.534_990_1 * radiance);
            let expected = [c00, c1.y, c1.z, c1.x, 0.0, 0.0, 0.0, 0.0, 0.0];
            for (k, (c, expected)) in light.of(vertex).iter().zip(expected).enumerate() {
                worst = worst.max((c.x - expected).abs() / c00);
                off[k] += f64::from((c.x - expected) / c00) / light.len() as f64;
            }
        }
        println!("{way}: {worst} {off:?}");
        // One vertex has the noise of 64 rays, or of 32 on each of six triangles; all together have none to speak of, but
        // for the facets that rays start from.
        assert!(worst < 0.3, "{way}: {worst}");
        assert!(off.iter().all(|off| off.abs() < 0.03), "{way}: {off:?}");
    }
}

#[test]
fn turned_scaled_and_far_away_the_light_turns_along() {
    let turn = Quat::from_rotation_z(0.7) * Quat::from_rotation_x(0.4);
    let plain = built(room());
    let moved = [
        ("turned", built(placed(room(), turn, Vec3::ZERO)), turn),
        ("far", built(placed(room(), Quat::IDENTITY, Vec3::new(1e5, -2e5, 3e4))), Quat::IDENTITY),
    ];
    for projection in [Projection::Point, Projection::LeastSquares] {
        let settings = Settings {
            projection,
            directional: Directional::Sh1,
            direct_samples: 64,
            indirect_samples: 512,
            ..settings()
        };
        let light = |scene: &Arc<Scene>| {
            let baker = Baker::new(Arc::clone(scene), settings.clone());
            baker.solution(&solved(&baker)).directional.unwrap()
        };
        let base = light(&plain);
        for (what, scene, turn) in &moved {
            let other = light(scene);
            assert_eq!(other.len(), base.len());
            let (mut squares, mut all) = ([0.0f64; 2], 0.0f64);
            for vertex in 0..base.len() {
                let [a, b] = [&base, &other].map(|light| {
                    let [c, y, z, x] = [0, 1, 2, 3].map(|k| light.of(vertex)[k].y);
                    (c, Vec3::new(x, y, z))
                });
                squares[0] += f64::from(a.0 - b.0).powi(2);
                squares[1] += f64::from((*turn * a.1 - b.1).length_squared());
                all += f64::from(a.0).powi(2);
            }
            let errors = squares.map(|square| (square / all).sqrt());
            println!("{projection:?} {what}: {errors:?}");
            // The noise of 128 rays.
            assert!(errors.iter().all(|&error| error < 0.08), "{projection:?} {what}: {errors:?}");
        }
        let vertices = |wall: Vec3| {
            let normals = plain.normals().iter().enumerate();
            normals.filter(move |(_, n)| n.dot(wall) > 0.9).map(|(vertex, _)| vertex)
        };
        // On the floor most light comes from above, on the wall x = 1 from the left.
        let [floor, wall] = [Vec3::Z, Vec3::NEG_X].map(|n| mean(&base, vertices(n)));
        assert!(floor[2] > 0.5 * floor[0] && wall[3] < -0.5 * wall[0], "{floor:?} {wall:?}");
    }
}

#[test]
fn coefficients_tell_what_a_fresh_gather_finds_on_tilted_normals() {
    let scene = built(room());
    let settings = Settings {
        projection: Projection::Point,
        directional: Directional::Sh2,
        direct_samples: 64,
        indirect_samples: 1024,
        ..settings()
    };
    let baker = Baker::new(Arc::clone(&scene), settings);
    let state = solved(&baker);
    let light = baker.solution(&state).directional.unwrap();
    // Vertices of the floor that nothing touches.
    let vertices: Vec<usize> = (0..scene.vertex_count())
        .filter(|&v| {
            let (p, n) = (scene.positions()[v], scene.normals()[v]);
            let is_inside = [p.x, p.y].iter().all(|x| (0.1..0.9).contains(x));
            let is_covered = (0.25..=0.61).contains(&p.x) && (0.3..=0.7).contains(&p.y);
            n.z > 0.9 && p.z < 0.01 && is_inside && !is_covered
        })
        .collect();
    let tilted = |v: usize| (scene.normals()[v] + Vec3::new(0.4, -0.3, 0.0)).normalize();
    let points = vertices.iter().map(|&v| (scene.positions()[v], tilted(v)));
    let measured = lumel::PointReceivers::new(&scene, points).unwrap();
    let fresh = lumel::measure_points(&baker, &state, &measured, &Control::default()).unwrap();
    let (mut off, mut all) = (0.0f64, 0.0f64);
    for (&v, fresh) in vertices.iter().zip(&fresh.irradiance) {
        let (y, c) = (lumel_basis::spherical_harmonics(tilted(v)), light.of(v));
        let by_band = [1.0, 2.0 / 3.0, 0.25].map(|a: f32| a * std::f32::consts::PI);
        let told: f32 = (0..9).map(|k| by_band[[0, 1, 1, 1, 2, 2, 2, 2, 2][k]] * c[k].y * y[k]).sum();
        off += f64::from(told - fresh.y).powi(2);
        all += f64::from(fresh.y).powi(2);
    }
    let error = (off / all).sqrt();
    println!("{} vertices, {error}", vertices.len());
    // Nine coefficients of light from lamps and walls: see the errors of reconstructions.
    assert!(vertices.len() > 8 && error < 0.07, "{error}");
}

#[test]
fn the_step_is_told_and_can_be_cancelled() {
    struct Steps<'a>(Mutex<Vec<Step>>, &'a Control);
    impl lumel::Observer for Steps<'_> {
        fn step_started(&self, step: Step) {
            self.0.lock().unwrap().push(step);
            if step == Step::Directional {
                self.1.cancel();
            }
        }
    }
    let baker = Baker::new(built(room()), Settings { directional: Directional::Sh1, ..settings() });
    let (mut state, control) = (SolveState::new(), Control::default());
    let steps = Steps(Mutex::default(), &control);
    assert!(baker.run(&mut state, &control, &steps).is_err());
    assert_eq!(steps.0.into_inner().unwrap().last(), Some(&Step::Directional));
    assert!(state.directional.is_none() && state.bounces.len() == 3);
    // What was finished stays.
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    assert!(state == solved(&baker));
}
