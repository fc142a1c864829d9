//! Layers of single lights: they add up to all light, and each is what a bake with its light alone gives.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{EulerRot, Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Control, Emitter, EmitterSampling, Layers, Light, Memory, Method, Observer, Progress,
    Projection, Reading, Saved, Scene, SceneBuilder, Settings, Silent, SolveError, SolveState, SolverKind,
    Step, Tail, Tracker, light_layers,
};
use lumel_basis::Field;
use lumel_scene::{DirectionalLight, PointLight, Radiance, RectLight, SpotLight};
use lumel_testkit::mesh::{self, Facing, cuboid};
use lumel_testkit::scene::{ceiling_light, grey, placed, reordered};
use std::sync::{Arc, Mutex};

fn settings() -> Settings {
    Settings {
        bounces: BounceLimit::Count(2),
        direct_samples: 8,
        indirect_samples: 32,
        layers: Layers::Lights,
        ..Settings::default()
    }
}

fn point(position: Vec3) -> PointLight {
    PointLight { position, intensity: Vec3::new(0.3, 0.2, 0.1), range: f32::INFINITY }
}

/// Two rectangles, a point, a spot and a sun in the unit cube.
fn lights() -> [(&'static str, Light); 5] {
    let small = ceiling_light(Vec3::new(0.3, 0.7, 0.9), 0.2, 0.2, 9.0);
    let large = ceiling_light(Vec3::new(0.7, 0.3, 0.8), 0.5, 0.3, 2.0);
    let spot = SpotLight {
        point: point(Vec3::new(0.5, 0.5, 0.9)),
        direction: Vec3::NEG_Z,
        cos_inner: 0.9,
        cos_outer: 0.7,
    };
    let sun =
        DirectionalLight { direction: Vec3::new(0.3, 0.2, -1.0).normalize(), irradiance: Vec3::splat(0.7) };
    [
        ("small", Light::Rect(small)),
        ("large", Light::Rect(large)),
        ("bulb", Light::Point(point(Vec3::new(0.2, 0.3, 0.6)))),
        ("spot", Light::Spot(spot)),
        ("sun", Light::Directional(sun)),
    ]
}

/// A room without a ceiling, with a box in it and an emissive square on a wall.
fn room() -> SceneBuilder {
    room_of(6, 2)
}

/// The room with so many cells along each edge of a wall and of the box.
fn room_of(cells: u32, of_box: u32) -> SceneBuilder {
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, cells, Facing::Inward, [0; 6]);
    objects.pop();
    let (min, max) = (Vec3::new(0.25, 0.3, -0.1), Vec3::new(0.6, 0.7, 0.4));
    objects.extend(cuboid(min, max, of_box, Facing::Outward, [0; 6]));
    let square = [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]].map(|[y, z]| Vec3::new(0.01, y, z));
    objects.push(mesh::quad(square, [1, 1], 1));
    let mut screen = grey(0.5, 4.0);
    screen.name = "screen".to_owned();
    SceneBuilder {
        sky: Radiance(Vec3::new(0.1, 0.2, 0.3)).into(),
        ..lumel_testkit::scene::scene(objects, vec![grey(0.6, 0.0), screen], Vec::new())
    }
}

fn with_lights<'a>(
    mut builder: SceneBuilder,
    lights: impl IntoIterator<Item = &'a (&'static str, Light)>,
) -> SceneBuilder {
    builder.clear_lights();
    for (name, light) in lights {
        builder.add_named_light(*name, *light);
    }
    builder
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn solved(scene: &Arc<Scene>, settings: &Settings) -> (Baker, SolveState, u64) {
    settings.validate().unwrap();
    let baker = Baker::new(Arc::clone(scene), settings.clone());
    let (mut state, control) = (SolveState::new(), Control::default());
    baker.run(&mut state, &control, &Silent).unwrap();
    (baker, state, control.rays())
}

/// The names of the layers.
fn names(scene: &Scene, settings: &Settings) -> Vec<String> {
    light_layers(scene, settings).into_iter().map(|layer| layer.name).collect()
}

fn mean(field: &Field) -> f64 {
    field.values().iter().map(|v| v.as_dvec3().element_sum() / 3.0).sum::<f64>() / field.node_count() as f64
}

/// Checks that layers add up to all light.
fn assert_whole(state: &SolveState, what: &str) {
    let total = state.total();
    let mean = mean(&total);
    assert!(mean > 0.0 && state.layers.len() > 1, "{what}");
    let mut worst = 0.0_f64;
    for (node, whole) in total.values().iter().enumerate() {
        let sum: glam::DVec3 = state.layers.iter().map(|layer| layer.values()[node].as_dvec3()).sum();
        let whole = whole.as_dvec3();
        worst = worst.max((sum - whole).abs().max_element() / whole.max_element().max(mean));
    }
    println!("{what}: {worst:.1e}");
    assert!(worst < 1e-6, "{what}: layers are off the whole by {worst:e}");
    for layer in &state.layers {
        assert!(self::mean(layer) > 0.0, "{what}: a layer is dark");
    }
}

/// Every way to solve: where light is measured, how rays are kept, what is added.
fn ways() -> Vec<(&'static str, Settings)> {
    let ways = [
        ("stored", settings()),
        ("traced", Settings { solver: SolverKind::Neumann, ..settings() }),
        ("stored, with a tail", Settings { tail: Tail::Geometric, ..settings() }),
        ("final gather", Settings { memory: Memory(40_000), ..settings() }),
        ("emission by rays", Settings { emitters: EmitterSampling::Rays, ..settings() }),
    ];
    let over_areas =
        ways.clone().map(|(way, settings)| (way, Settings { projection: Projection::Area, ..settings }));
    ways.into_iter().chain(over_areas).collect()
}

#[test]
fn layers_add_up_to_all_light() {
    let scene = built(with_lights(room(), &lights()));
    for (way, settings) in ways() {
        let (baker, state, _) = solved(&scene, &settings);
        let gathers = matches!(baker.method(), Method::FinalGather { .. });
        assert_eq!(gathers, way == "final gather", "{}", baker.method());
        assert_eq!(state.tail.is_some(), settings.tail == Tail::Geometric);
        let expected = ["small", "large", "bulb", "spot", "sun", "sky", "screen"];
        assert_eq!(names(&scene, &settings), expected);
        assert_whole(&state, &format!("{way}, {:?}", settings.projection));
    }
}

/// Stops a solve when a step begins.
struct StopAt<'a>(Step, &'a Control);

impl Observer for StopAt<'_> {
    fn step_started(&self, step: Step) {
        if step == self.0 {
            self.1.cancel();
        }
    }
}

/// Checks that a solve that is stopped when a step begins and resumed ends as if it had not been.
fn assert_resumed(baker: &Baker, at: Step, whole: &SolveState, what: &str) {
    let (mut stopped, control) = (SolveState::new(), Control::default());
    let result = baker.run(&mut stopped, &control, &StopAt(at, &control));
    assert_eq!(result, Err(SolveError::Cancelled), "{what}: there is no {at:?}");
    let saved = Saved::Checkpoint(Box::new(baker.checkpoint(&stopped)));
    let mut resumed = baker.resume(&saved).unwrap();
    baker.run(&mut resumed, &Control::default(), &Silent).unwrap();
    assert!(resumed == *whole, "{what}: other bits after a stop at {at:?}");
}

#[test]
fn wherever_a_coarse_scene_lies_layers_add_up_and_a_stop_changes_no_bit() {
    let given = with_lights(room_of(1, 1), &lights());
    let (turn, far) = (Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3), Vec3::new(1000.0, -700.0, 400.0));
    let scenes = [
        ("as given", given.clone()),
        ("far away", placed(given.clone(), Quat::IDENTITY, far)),
        ("turned", placed(given.clone(), turn, Vec3::ZERO)),
        ("reordered", reordered(given.clone())),
        ("all at once", reordered(placed(given, turn, far))),
    ];
    for projection in [Projection::Point, Projection::Area] {
        let mut as_given = None;
        for (name, builder) in &scenes {
            let (scene, what) = (built(builder.clone()), format!("{projection:?}, {name}"));
            let stored = Settings { projection, tail: Tail::Geometric, ..settings() };
            let (baker, state, _) = solved(&scene, &stored);
            let light = baker.power(&state.total());
            let ratio = light / *as_given.get_or_insert(light);
            println!("{what}: {ratio:.4} of the light");
            // Eight shadow rays for a whole triangle are noisy: by some per cent of all light.
            assert!((ratio - 1.0).abs() < 0.1, "{what}: {ratio} times as much light");
            assert_whole(&state, &format!("{what}, stored"));
            for at in [Step::Bounce(1), Step::Bounce(2), Step::Layer(0), Step::Layer(4)] {
                assert_resumed(&baker, at, &state, &what);
            }
            let Method::Cached { memory: Memory(all) } = baker.method() else { panic!("{}", baker.method()) };
            let gathers = Settings { memory: Memory(3 * all / 4), ..stored.clone() };
            let traced = Settings { solver: SolverKind::Neumann, ..stored.clone() };
            for (way, settings) in [("gathers", gathers), ("traced", traced)] {
                let (baker, state, _) = solved(&scene, &settings);
                assert_eq!(matches!(baker.method(), Method::FinalGather { .. }), way == "gathers");
                assert_whole(&state, &format!("{what}, {way}"));
                assert_resumed(&baker, Step::Bounce(2), &state, &what);
            }
            let target_error = "2%".parse().unwrap();
            let (baker, state, _) = solved(&scene, &Settings { target_error, layers: Layers::Off, ..stored });
            assert!(state.rounds.len() > 2, "{what}: one round was enough");
            assert_resumed(&baker, Step::Round(1), &state, &what);
        }
    }
}

#[test]
fn layers_of_many_area_lights_add_up_to_all_light() {
    let rects = [0.2, 0.4, 0.6, 0.8].map(|x| [0.3, 0.5, 0.7].map(|y| Vec3::new(x, y, 0.95)));
    let mut builder = room();
    for at in rects.into_iter().flatten() {
        builder.add_light(ceiling_light(at, 0.1, 0.1, 5.0));
    }
    let scene = built(builder);
    assert_eq!(names(&scene, &settings())[11], "light 12");
    assert_whole(&solved(&scene, &settings()).1, "one of many lights for each sample");
}

#[test]
fn layers_of_built_in_scenes_add_up_to_all_light() {
    for name in ["cornell-box", "atrium"] {
        let mut builder = lumel::open(name, &lumel::OpenOptions::default()).unwrap().builder;
        let Light::Rect(rect) = builder.lights[0] else { panic!("{name} has a rectangle") };
        let center = rect.center + 0.5 * rect.u + 0.1 * rect.u.cross(rect.v).normalize() * rect.u.length();
        builder.add_named_light("second", RectLight { center, u: 0.5 * rect.u, ..rect });
        builder.add_light(Light::Point(point(center)));
        builder.sky = Radiance(builder.sky.mean().0.max(Vec3::splat(0.1))).into();
        let scene = built(builder);
        let settings = Settings { bounces: BounceLimit::Count(1), direct_samples: 2, ..settings() };
        assert_whole(&solved(&scene, &settings).1, name);
    }
}

#[test]
fn the_layer_of_a_light_is_a_bake_with_that_light_alone() {
    let lights = lights();
    let scene = built(with_lights(room(), &lights));
    let mut dark = room();
    dark.sky = Radiance::ZERO.into();
    dark.materials[1].emission = Radiance::ZERO;
    for (way, settings) in ways().into_iter().filter(|(_, settings)| settings.tail == Tail::Off) {
        let (_, state, _) = solved(&scene, &settings);
        for (number, light) in lights.iter().enumerate() {
            let what = format!("{way}, {:?}, {}", settings.projection, light.0);
            let alone = |seed| {
                let settings = Settings { seed, layers: Layers::Off, ..settings.clone() };
                let state = solved(&built(with_lights(dark.clone(), [light])), &settings).1;
                state.total()
            };
            let (layer, alone_here) = (&state.layers[number], alone(0));
            if light.0 != "large" {
                // No samples, or those of the first of all area lights.
                assert!(*layer == alone_here, "{what}: other bits");
                continue;
            }
            // Its sample points are those of the second area light: as far off as those of another seed.
            let difference = |other: &Field| {
                let pairs = layer.values().iter().zip(other.values());
                let squares = pairs.map(|(a, b)| (a.as_dvec3() - b.as_dvec3()).length_squared());
                (squares.sum::<f64>() / layer.node_count() as f64).sqrt()
            };
            let (here, elsewhere) = (difference(&alone_here), difference(&alone(1)));
            println!("{what}: {here:.2e} and {elsewhere:.2e} of {:.2e}", mean(layer));
            assert!(here > 0.0 && here < 1.2 * elsewhere, "{what}: {here} and {elsewhere}");
            // The mean over all nodes is some standard errors off at most.
            let off = (mean(layer) - mean(&alone_here)).abs();
            let error = here / (layer.node_count() as f64).sqrt();
            assert!(off < 4.0 * error, "{what}: {off} and {error}");
        }
    }
}

#[test]
fn layers_cost_their_shadow_rays_and_no_hemisphere_ray() {
    let mut builder = with_lights(room(), &lights());
    // A sky brings light along the stored rays.
    builder.materials[1].emission = Radiance::ZERO;
    let scene = built(builder);
    for projection in [Projection::Point, Projection::Area] {
        // With that many rays, vertices inside geometry are found with the stored ones.
        let with = Settings { projection, indirect_samples: 128, ..settings() };
        let without = Settings { layers: Layers::Off, ..with.clone() };
        let (baker, mut state, rays) = solved(&scene, &without);
        // On rays that are stored, and where it is known what is hidden, only those to lights are traced.
        let control = Control::default();
        state.bounces.clear();
        baker.run(&mut state, &control, &Silent).unwrap();
        let shadow = control.rays();
        assert!(shadow > 0 && shadow < rays / 2, "{projection:?}");
        let (_, state, rays_with_layers) = solved(&scene, &with);
        assert_eq!(state.layers.len(), 6);
        // Each light's shadow rays once more, in its layer.
        assert_eq!(rays_with_layers, rays + shadow, "{projection:?}");
    }
}

/// Follows a solve and keeps its progress at the end of every step.
struct Follower<'a> {
    tracker: Mutex<Tracker>,
    control: &'a Control,
    ended: Mutex<Vec<Progress>>,
}

impl Observer for Follower<'_> {
    fn step_started(&self, step: Step) {
        self.tracker.lock().unwrap().step_started(step, Reading::new(self.control, 0.0));
    }

    fn step_done(&self, step: Step, _: &SolveState) {
        let (now, mut tracker) = (Reading::new(self.control, 1.0), self.tracker.lock().unwrap());
        self.ended.lock().unwrap().push(tracker.progress(now));
        tracker.step_done(step, None, None, now);
    }
}

#[test]
fn progress_counts_layers_as_steps() {
    let scene = built(with_lights(room(), &lights()));
    for (way, settings) in ways() {
        let baker = Baker::new(Arc::clone(&scene), settings);
        let (mut state, control) = (SolveState::new(), Control::default());
        let tracker = Mutex::new(Tracker::new(&baker, &state));
        let follower = Follower { tracker, control: &control, ended: Mutex::default() };
        baker.run(&mut state, &control, &follower).unwrap();
        let ended = follower.ended.into_inner().unwrap();
        assert!(ended.iter().all(|at| at.layers == 7 && at.step_share == Some(1.0)), "{way}: {ended:?}");
        let layers: Vec<&Progress> =
            ended.iter().filter(|at| matches!(at.step, Some(Step::Layer(_)))).collect();
        let left: Vec<f64> = layers.iter().filter_map(|at| at.seconds_left).collect();
        let falls = left.is_sorted_by(|before, after| before > after);
        assert!(left.len() == 7 && falls && left.last().unwrap().abs() < 1e-9, "{way}: {left:?}");
        let direct = ended.iter().find(|at| at.step == Some(Step::Bounce(0))).unwrap();
        let off = Settings { layers: Layers::Off, ..baker.settings().clone() };
        let without =
            Tracker::new(&baker.relit(Arc::clone(&scene), off), &state).progress(Reading::default());
        assert!(direct.seconds_left > Some(0.0) && without.layers == 0, "{way}");
    }
}

#[test]
fn emitters_that_share_a_name_make_one_layer() {
    let [small, large, ..] = lights();
    let mut builder = with_lights(room(), &[("left", small.1), ("screen", large.1), ("left", small.1)]);
    let scene = built(builder.clone());
    let layers = light_layers(&scene, &settings());
    let found: Vec<(&str, usize)> = layers.iter().map(|l| (l.name.as_str(), l.emitters.len())).collect();
    assert_eq!(found, [("left", 2), ("screen", 2), ("sky", 1)]);
    assert_eq!(layers[0].emitters, [Emitter::Light(0), Emitter::Light(2)]);
    let off = Settings { emitters: EmitterSampling::Off, ..settings() };
    assert_eq!(light_layers(&scene, &off)[1].emitters, [Emitter::Light(1)]);
    assert_whole(&solved(&scene, &settings()).1, "shared names");
    builder.materials[1].name.clear();
    assert_eq!(names(&built(builder), &settings())[3], "material 2");
}

#[test]
fn a_resumed_bake_has_the_layers_of_an_uninterrupted_one() {
    let scene = built(with_lights(room(), &lights()));
    let (baker, state, _) = solved(&scene, &settings());
    let whole = baker.solution(&state);
    let direct_only = Settings { bounces: BounceLimit::Count(0), layers: Layers::Off, ..settings() };
    let (stopped, early, _) = solved(&scene, &direct_only);
    let mut resumed = baker.resume(&Saved::Checkpoint(Box::new(stopped.checkpoint(&early)))).unwrap();
    baker.run(&mut resumed, &Control::default(), &Silent).unwrap();
    assert_eq!(baker.solution(&resumed).layers, whole.layers);
    assert_eq!(whole.layers.len(), 7);
}

#[test]
fn dimmed_layers_are_the_light_of_dimmed_lights() {
    let scene = built(with_lights(room(), &lights()));
    // The nearest function is kept from ringing at the edges of all direct light, which is another light if some is dimmed.
    let settings = Settings { projection: Projection::Area, ..settings() };
    let (baker, state, _) = solved(&scene, &settings);
    let all = baker.light_at_vertices(&state);
    let difference = |a: &[Vec3], b: &[Vec3]| {
        a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
    };
    assert!(difference(&baker.mixed(&state, |_| Vec3::ONE).unwrap(), &all) < 1e-5);
    let dimmed = baker.mixed(&state, |name| Vec3::splat(if name == "sun" { 0.5 } else { 1.0 })).unwrap();
    let mut dim = lights();
    if let Light::Directional(sun) = &mut dim[4].1 {
        sun.irradiance *= 0.5;
    }
    let relit = built(with_lights(room(), &dim));
    let (other, state, _) = solved(&relit, &settings);
    assert!(difference(&dimmed, &other.light_at_vertices(&state)) < 1e-5);
    assert!(difference(&dimmed, &all) > 0.1);
    assert_eq!(baker.mixed(&SolveState::new(), |_| Vec3::ONE), None);
}
