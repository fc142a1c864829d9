//! Shooting in bakes: with everything else that a bake can do, and against gathering.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

mod keep;

use glam::{DVec3, Vec3};
use keep::Keep;
use lumel::{
    Baker, Control, Layers, Light, Lumels, Memory, Method, Observer, OpenOptions, Projection, SamplerKind,
    Saved, Scene, SceneBuilder, ScheduleKind, Settings, Silent, SolveState, SolverKind, Step,
};
use lumel_basis::Field;
use lumel_export::{SolutionError, SolutionSelection};
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::scene::{bulb, ceiling_light, grey, scene};
use lumel_testkit::{Estimate, rms};
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use std::sync::{Arc, Mutex};

/// A room with a light, a bulb and a box that stands over vertices of the floor.
fn room() -> Arc<Scene> {
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 5, Facing::Inward, [0, 1, 0, 0, 0, 0]);
    let (min, max) = (Vec3::new(0.25, 0.3, -0.1), Vec3::new(0.6, 0.7, 0.4));
    objects.extend(cuboid(min, max, 2, Facing::Outward, [1; 6]));
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.4, 0.4, 5.0));
    let lights = vec![light, bulb(Vec3::new(0.8, 0.8, 0.6), 2.0)];
    built(scene(objects, vec![grey(0.6, 0.0), grey(0.3, 0.2)], lights))
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn settings(projection: Projection) -> Settings {
    Settings {
        projection,
        schedule: ScheduleKind::Shoot,
        remainder: 1e-2,
        direct_samples: 8,
        indirect_samples: 32,
        ..Settings::default()
    }
}

/// Every way to shoot: by columns of all rays or of few of them, and by points.
fn ways(projection: Projection) -> [(&'static str, Settings); 3] {
    let stored = settings(projection);
    let few = Settings { memory: Memory(150_000), indirect_samples: 64, ..stored.clone() };
    let points =
        Settings { solver: SolverKind::Neumann, remainder: 0.1, indirect_samples: 16, ..stored.clone() };
    [("stored", stored), ("few stored", few), ("points", points)]
}

fn run(baker: &Baker, mut state: SolveState) -> SolveState {
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

fn solved(scene: &Arc<Scene>, settings: &Settings) -> (Baker, SolveState) {
    settings.validate().unwrap();
    let baker = Baker::new(Arc::clone(scene), settings.clone());
    let state = run(&baker, SolveState::new());
    (baker, state)
}

/// The root mean square of a difference by that of the second field.
fn difference(a: &Field, b: &Field) -> f64 {
    let square = |v: DVec3| v.length_squared();
    let pairs = a.values().iter().zip(b.values());
    let off: f64 = pairs.map(|(a, b)| square(a.as_dvec3() - b.as_dvec3())).sum();
    (off / b.values().iter().map(|v| square(v.as_dvec3())).sum::<f64>()).sqrt()
}

#[test]
fn a_bake_that_was_stopped_after_any_shot_and_resumed_has_the_same_bits() {
    let scene = room();
    for projection in [Projection::Point, Projection::LeastSquares] {
        for (way, settings) in ways(projection) {
            let baker = Baker::new(Arc::clone(&scene), settings);
            let is_few = matches!(baker.method(), Method::FinalGather { .. });
            assert_eq!(is_few, way == "few stored", "{projection:?}, {way}: {}", baker.method());
            let (keep, mut whole) = (Keep(&baker, Mutex::default()), SolveState::new());
            baker.run(&mut whole, &Control::default(), &keep).unwrap();
            let kept = keep.1.into_inner().unwrap();
            assert!(kept.len() > 3 && whole.gathered.is_some() == is_few, "{way}: {}", kept.len());
            let folder = tempfile::tempdir().unwrap();
            for saved in [0, 1, kept.len() / 2, kept.len() - 1].map(|k| &kept[k]) {
                let Saved::Checkpoint(checkpoint) = saved else { panic!("it is one") };
                let file = folder.path().join("a.checkpoint.npz");
                checkpoint.save(&file).unwrap();
                let saved = Saved::load_for(&file, baker.scene()).unwrap();
                let resumed = run(&baker, baker.resume(&saved).unwrap());
                assert!(resumed == whole, "{way}, {projection:?}: other bits");
            }
        }
    }
}

#[test]
fn light_that_was_gathered_is_not_continued_by_shots() {
    let scene = room();
    let shoot = settings(Projection::Point);
    let gather = Settings { schedule: ScheduleKind::Gather, ..shoot.clone() };
    let (gathers, state) = solved(&scene, &gather);
    let saved = Saved::Checkpoint(Box::new(gathers.checkpoint(&state)));
    let error = Baker::new(scene, shoot).resume(&saved).unwrap_err().to_string();
    assert!(error.contains("schedule gather, not shoot"), "{error}");
}

#[test]
fn shooting_finds_the_light_that_gathering_finds() {
    let scene = room();
    for projection in [Projection::Point, Projection::Area, Projection::LeastSquares] {
        let shoot = Settings { remainder: 1e-4, ..settings(projection) };
        let gather = Settings { schedule: ScheduleKind::Gather, ..shoot.clone() };
        let ([shot, gathered], baker) = {
            let (baker, shot) = solved(&scene, &shoot);
            ([shot, solved(&scene, &gather).1], baker)
        };
        let off = difference(&shot.total(), &gathered.total());
        assert!(off < 2e-4, "{projection:?}: {off:e}");
        // The ambient term stands for what is unshot.
        assert!(shot.tail.is_some() && baker.remainder(&shot).unwrap() < 1e-4);
    }
}

/// Solves with rays of their own find the same light but for their noise, which falls with the square root of their number.
#[test]
fn gathering_and_shooting_with_other_rays_agree_within_their_noise() {
    const SEEDS: u64 = 5;
    for name in ["cornell-box", "atrium"] {
        let scene = built(lumel::open(name, &OpenOptions::default()).unwrap().builder);
        let light = |schedule, rays, seed| {
            let settings = Settings {
                projection: Projection::Point,
                sampler: SamplerKind::Random,
                remainder: 1e-4,
                direct_samples: rays,
                indirect_samples: rays,
                seed,
                ..settings(Projection::Point)
            };
            solved(&scene, &Settings { schedule, ..settings }).1.total()
        };
        let difference = |rays, seed| -> Vec<DVec3> {
            let gathered = light(ScheduleKind::Gather, rays, seed);
            let shot = light(ScheduleKind::Shoot, rays, seed + 100);
            let pairs = gathered.values().iter().zip(shot.values());
            pairs.map(|(gathered, shot)| shot.as_dvec3() - gathered.as_dvec3()).collect()
        };
        let square = |light: &[DVec3]| rms(light.iter().map(|v| v.length()));
        let few: Vec<Vec<DVec3>> = (0..SEEDS).map(|seed| difference(8, seed)).collect();
        // No part of the mesh is brighter in the one than in the other: in standard errors, differences of means of five
        // follow Student's t with four degrees of freedom, whose root mean square is 1.4.
        const PARTS: usize = 12;
        let standard_errors = |part: usize| {
            let mean = |off: &Vec<DVec3>| {
                let mine = off.chunks(off.len().div_ceil(PARTS)).nth(part).unwrap();
                mine.iter().map(|v| v.y).sum::<f64>() / mine.len() as f64
            };
            let off = Estimate::new(few.iter().map(mean));
            off.mean / off.error
        };
        let off = rms((0..PARTS).map(standard_errors));
        assert!(off < 3.0, "{name}: parts are {off} standard errors off");
        // A bias at vertices would not fall.
        let [few, many] = [square(&few[0]), square(&difference(32, 50))];
        println!(
            "{name}: {off:.2} standard errors, {few:.4} with 8 rays, {many:.4} with 32, {:.3} of it",
            many / few
        );
        assert!((many / few - 0.5).abs() < 0.05, "{name}: {few} {many}");
    }
}

#[test]
fn the_ambient_term_brings_what_is_shown_closer_to_the_end() {
    let scene = room();
    let baker = Baker::new(Arc::clone(&scene), settings(Projection::Area));
    let states = Mutex::new(Vec::new());
    struct States<'a>(&'a Mutex<Vec<SolveState>>);
    impl Observer for States<'_> {
        fn step_done(&self, step: Step, state: &SolveState) {
            if matches!(step, Step::Shot(_) | Step::Bounce(_)) {
                self.0.lock().unwrap().push(state.clone());
            }
        }
    }
    let mut end = SolveState::new();
    baker.run(&mut end, &Control::default(), &States(&states)).unwrap();
    let gather = Settings { schedule: ScheduleKind::Gather, ..baker.settings().clone() };
    let gathers = Baker::new(scene, gather);
    gathers.run(&mut SolveState::new(), &Control::default(), &States(&states)).unwrap();
    let end = end.total();
    let with_ambient = |state: &SolveState| {
        let ambient = baker.ambient(state);
        Field::from_values(state.total().values().iter().map(|value| *value + ambient).collect())
    };
    for state in states.into_inner().unwrap() {
        let [without, with] = [difference(&state.total(), &end), difference(&with_ambient(&state), &end)];
        // What is less than the remainder is as good as noise.
        assert!(with < 0.8 * without || with < 0.01, "{with} with it, {without} without");
    }
}

#[test]
fn layers_of_light_that_was_shot_add_up_to_all_light() {
    let scene = room();
    for projection in [Projection::Point, Projection::LeastSquares] {
        for (way, settings) in ways(projection) {
            let settings = Settings { layers: Layers::Lights, remainder: 0.05, ..settings };
            let (_, state) = solved(&scene, &settings);
            assert_eq!((state.layers.len(), state.tail.is_some()), (3, true));
            let off = difference(&Field::sum(state.node_count(), &state.layers), &state.total());
            assert!(off < 1e-6, "{way}, {projection:?}: {off:e}");
        }
    }
}

#[test]
fn a_relit_baker_that_shoots_has_the_bits_of_a_new_one_and_traces_no_hemisphere_ray() {
    let scene = room();
    let lights = scene.lights()[..1].to_vec();
    let relit = Arc::new(scene.relit(lights).unwrap());
    for projection in [Projection::Point, Projection::Area] {
        let settings = Settings { indirect_samples: 64, ..settings(projection) };
        let (old, _) = solved(&scene, &settings);
        assert!(old.has_rays_of(&settings));
        let solved = |baker: &Baker| {
            let (mut state, control) = (SolveState::new(), Control::default());
            baker.run(&mut state, &control, &Silent).unwrap();
            (state, control.rays())
        };
        let (new, all_rays) = solved(&Baker::new(Arc::clone(&relit), settings.clone()));
        let (state, rays) = solved(&old.relit(Arc::clone(&relit), settings));
        assert!(state == new && rays < all_rays, "{projection:?}: {rays} of {all_rays} rays");
    }
}

#[test]
fn a_target_error_is_reached_by_shots_as_by_bounces() {
    let scene = room();
    for projection in [Projection::Point, Projection::Area] {
        let shoot =
            Settings { target_error: "10%".parse().unwrap(), remainder: 1e-3, ..settings(projection) };
        let gather = Settings { schedule: ScheduleKind::Gather, ..shoot.clone() };
        let (baker, shot) = solved(&scene, &shoot);
        let (_, gathered) = solved(&scene, &gather);
        // The same samples, as long as the same nodes get more of them.
        let off = difference(&shot.total(), &gathered.total());
        assert!(off < 5e-3, "{projection:?}: {off}");
        let errors = shot.errors.as_ref().unwrap();
        assert_eq!(errors.accuracy.ended, gathered.errors.as_ref().unwrap().accuracy.ended);
        // A finished bake is not solved again, and what is asked to go on has the bits of a new one.
        let saved = Saved::Checkpoint(Box::new(baker.checkpoint(&shot)));
        assert!(run(&baker, baker.resume(&saved).unwrap()) == shot);
    }
}

#[test]
fn meshes_that_follow_light_can_be_shot_on() {
    let adaptive = "5%".parse().unwrap();
    let settings = Settings { adaptive, remainder: 1e-3, ..settings(Projection::LeastSquares) };
    let coarse = Baker::new(room(), settings);
    let adapted = coarse.adapted(&Control::default(), &mut |_| {}).unwrap().unwrap().baker;
    assert!(adapted.scene().vertex_count() > coarse.scene().vertex_count());
    let shot = run(&adapted, SolveState::new());
    let gather = Settings { schedule: ScheduleKind::Gather, ..adapted.settings().clone() };
    let gathered = run(&adapted.relit(Arc::clone(adapted.scene()), gather), SolveState::new());
    let off = difference(&shot.total(), &gathered.total());
    assert!(off < 5e-3, "{off:e}");
}

#[test]
fn lumels_gather_light_that_was_shot() {
    let scene = room();
    let unwrapping = UnwrapSettings { density: Density::PerMetre(8.0), ..UnwrapSettings::default() };
    let atlas = unwrap(&scene, &unwrapping, &|| Pace::Go).unwrap().atlas;
    let lumels = Lumels::new(Arc::clone(&scene), atlas);
    let light = |schedule| {
        let settings = Settings { schedule, remainder: 1e-3, ..settings(Projection::LeastSquares) };
        let (baker, state) = solved(&scene, &settings);
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        Field::from_values((0..light.len()).map(|lumel| light.irradiance(lumel)).collect())
    };
    let off = difference(&light(ScheduleKind::Shoot), &light(ScheduleKind::Gather));
    assert!(off < 2e-3, "{off:e}");
}

#[test]
fn a_solution_that_was_shot_says_that_it_has_no_single_bounces() {
    let (baker, state) = solved(&room(), &settings(Projection::Area));
    let solution = baker.solution(&state);
    assert!(solution.meta.is_shot() && solution.bounces.len() == 1);
    assert!(solution.select(&SolutionSelection::Bounce(0)).is_ok());
    let error = solution.select(&SolutionSelection::Bounce(1)).unwrap_err();
    assert!(matches!(error, SolutionError::Shot { wanted: 1 }));
    assert!(error.to_string().contains("schedule gather"), "{error}");
    // Bounces and tail add up to all light, and a file is read as the light that it holds.
    let light = baker.shot_light(&Saved::Solution(Box::new(solution.clone()))).unwrap();
    assert!(difference(&light.total(), &state.total()) < 1e-4);
    let all = baker.light_reader(&state).at_vertices(&state.total());
    assert!(solution.irradiance.iter().zip(all).all(|(a, b)| (*a - b).abs().max_element() < 1e-5));
}
