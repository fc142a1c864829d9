//! Bakes whose bounces are carried on scattered points, with everything else that a bake can do.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

mod keep;

use glam::{DVec3, Vec3};
use keep::Keep;
use lumel::{
    Adaptive, Baker, BounceLimit, Control, Directional, Layers, Light, Lumels, Memory, Method, PointSpacing,
    Projection, SamplerKind, Saved, Scene, SceneBuilder, ScheduleKind, Settings, Silent, SolutionSelection,
    SolveState, SolverKind, gated,
};
use lumel_basis::{Basis, Field, FieldLighting, Lighting, PointReceivers, VertexBasis};
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::random_surface_points;
use lumel_testkit::scene::{bulb, ceiling_light, grey, scene};
use lumel_transport::{CachedTransport, CpuTransport, Job, Plan, Source, Transport, accumulate};
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use std::sync::{Arc, Mutex};

/// A room with a light, a bulb and a box that stands on the floor, its walls in a grid of `cells`.
fn room(cells: u32) -> Arc<Scene> {
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, cells, Facing::Inward, [0, 1, 0, 0, 0, 0]);
    let (min, max) = (Vec3::new(0.25, 0.3, -0.1), Vec3::new(0.6, 0.7, 0.4));
    objects.extend(cuboid(min, max, cells.div_ceil(2), Facing::Outward, [1; 6]));
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.4, 0.4, 5.0));
    let lights = vec![light, bulb(Vec3::new(0.8, 0.8, 0.6), 2.0)];
    built(scene(objects, vec![grey(0.6, 0.0), grey(0.3, 0.2)], lights))
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn settings() -> Settings {
    Settings {
        point_spacing: PointSpacing::Metres(0.06),
        bounces: BounceLimit::Count(2),
        direct_samples: 16,
        indirect_samples: 64,
        ..Settings::default()
    }
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

/// The root mean square of a difference by that of the second.
fn difference(a: &[Vec3], b: &[Vec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square = |v: DVec3| v.length_squared();
    let off: f64 = a.iter().zip(b).map(|(a, b)| square(a.as_dvec3() - b.as_dvec3())).sum();
    (off / b.iter().map(|v| square(v.as_dvec3())).sum::<f64>()).sqrt()
}

/// Mean irradiance over all surfaces.
fn mean(baker: &Baker, state: &SolveState) -> f64 {
    baker.integrals().mean(&state.total())
}

#[test]
fn bounces_on_points_are_those_on_vertices_and_direct_light_is_that_at_vertices() {
    let scene = room(14);
    for projection in [Projection::Point, Projection::LeastSquares] {
        let settings = Settings { projection, direct_samples: 64, indirect_samples: 256, ..settings() };
        let on_vertices = Settings { point_spacing: PointSpacing::Off, ..settings.clone() };
        let [points, vertices] =
            [settings, on_vertices].map(|settings| solved(&scene, &settings)).map(|(b, s)| b.solution(&s));
        // The very samples at the same places; over areas, light of emissive surfaces comes along rays of its own.
        let off = difference(&points.bounces[0], &vertices.bounces[0]);
        let bound = if projection == Projection::Point { 1e-6 } else { 0.01 };
        assert!(off < bound, "{projection:?}, direct: {off}");
        // Where light is read as the nearest function, vertices overshoot at the rim of the box.
        for bounce in [1, 2].into_iter().filter(|_| projection == Projection::Point) {
            let off = difference(&points.bounces[bounce], &vertices.bounces[bounce]);
            assert!(off < 0.06, "bounce {bounce}: {off}");
        }
        let sum = |k: usize| points.bounces.iter().fold(Vec3::ZERO, |sum, bounce| sum + bounce[k]);
        assert!(
            (0..scene.vertex_count()).all(|v| (points.irradiance[v] - sum(v)).abs().max_element() < 1e-4)
        );
    }
}

/// A room with a bulb close to its floor, whose light points that are far apart would blur.
fn room_with_a_bright_spot() -> Arc<Scene> {
    let room = cuboid(Vec3::ZERO, Vec3::ONE, 40, Facing::Inward, [0; 6]);
    built(scene(room, vec![grey(0.6, 0.0)], vec![bulb(Vec3::new(0.5, 0.5, 0.06), 2.0)]))
}

/// A few points.
fn coarse() -> Settings {
    Settings { point_spacing: PointSpacing::Metres(0.2), ..settings() }
}

#[test]
fn rays_read_direct_light_from_vertices_where_these_are_more_than_points() {
    let scene = room_with_a_bright_spot();
    let stored = Settings { projection: Projection::Point, bounces: BounceLimit::Count(1), ..coarse() };
    let traced = Settings { solver: SolverKind::Neumann, ..stored.clone() };
    for way in [&stored, &traced] {
        let (baker, state) = solved(&scene, way);
        let points = baker.basis().points().unwrap();
        let vertices = Arc::new(VertexBasis::new(Arc::clone(&scene)));
        assert!(points.node_count() < 200 && vertices.node_count() > 5000);
        // The very rays, with what they meet in another basis.
        let receivers = Arc::new(PointReceivers::at_nodes(points));
        let Settings { direct_samples, indirect_samples, sampler, seed, .. } = *way;
        let plan = Plan { direct_samples, indirect_samples, sampler, seed, ..Plan::default() };
        let measured = |transport: &dyn Transport, field: &Field| {
            let job = Job { source: Source::Field(field), bounce: 1, pass: 0, active: None };
            let found = accumulate(transport, &job, &Control::default(), None).unwrap();
            found.field.values().to_vec()
        };
        let tracer = || Arc::clone(baker.tracer());
        let (basis, places) = (Arc::clone(&vertices), Arc::clone(&receivers));
        let of_vertices = CpuTransport::new(Arc::clone(&scene), tracer(), basis, places, plan);
        let of_points = CpuTransport::new(Arc::clone(&scene), tracer(), Arc::clone(points), receivers, plan);
        let direct = state.read_direct.as_ref().unwrap();
        let expected = match way.solver {
            SolverKind::Neumann => measured(&of_vertices, direct),
            _ => measured(&CachedTransport::new(of_vertices, None), direct),
        };
        let off = difference(state.bounces[1].values(), &expected);
        assert!(off < 1e-6, "{:?}: {off}", way.solver);
        let blurred = difference(&measured(&of_points, &state.bounces[0]), &expected);
        assert!(blurred > 0.2, "points would do as well: {blurred}");
    }
    // Where points are more, they have what vertices do not.
    let (baker, state) = solved(&room(3), &Settings { bounces: BounceLimit::Count(1), ..settings() });
    assert!(baker.basis().direct().is_none() && state.read_direct.is_some());
}

#[test]
fn every_solver_schedule_and_target_reflects_direct_light_as_vertices_have_it() {
    let scene = room_with_a_bright_spot();
    let all = Settings { bounces: BounceLimit::All, remainder: 2e-3, indirect_samples: 512, ..coarse() };
    let indirect = |settings: &Settings| {
        let (baker, state) = solved(&scene, settings);
        let mean = |field: &Field| baker.integrals().mean(field);
        (mean(&state.total()) - mean(&state.bounces[0]), state, baker)
    };
    let (expected, ..) = indirect(&Settings { point_spacing: PointSpacing::Off, ..all.clone() });
    let shoot = ScheduleKind::Shoot;
    let few = Settings { memory: Memory(40_000), ..all.clone() };
    let to_error = Settings { target_error: "20%".parse().unwrap(), ..all.clone() };
    for (way, settings) in [
        ("stored", all.clone()),
        ("traced", Settings { solver: SolverKind::Neumann, ..all.clone() }),
        ("over areas", Settings { projection: Projection::Area, ..all.clone() }),
        ("few stored", few),
        ("shot", Settings { schedule: shoot, ..all.clone() }),
        ("levels", Settings { levels: 2, ..all.clone() }),
        ("levels that follow light", Settings { levels: 3, adaptive: Adaptive::Auto, ..all.clone() }),
        ("target error", to_error.clone()),
        ("shot to a target error", Settings { schedule: shoot, ..to_error }),
    ] {
        let (found, state, baker) = indirect(&settings);
        let gathers = matches!(baker.method(), Method::FinalGather { .. });
        assert_eq!(gathers, way == "few stored", "{way}: {}", baker.method());
        assert!(state.read_direct.is_some(), "{way}");
        let off = found / expected - 1.0;
        println!("{way}: {off:.4}");
        assert!(off.abs() < 0.05, "{way}: {off}");
    }
}

#[test]
fn every_solver_schedule_and_sampler_carries_light_on_points() {
    let scene = room(3);
    let all = Settings { bounces: BounceLimit::All, remainder: 2e-3, ..settings() };
    let expected =
        mean(&solved(&scene, &Settings { indirect_samples: 512, ..all.clone() }).0, &solved(&scene, &all).1);
    let few = Settings { memory: Memory(200_000), indirect_samples: 128, ..all.clone() };
    let mut ways = vec![
        ("neumann", Settings { solver: SolverKind::Neumann, ..all.clone() }),
        ("few stored", few),
        ("shot", Settings { schedule: ScheduleKind::Shoot, ..all.clone() }),
        ("levels", Settings { levels: 3, ..all.clone() }),
        ("levels, traced", Settings { levels: 2, solver: SolverKind::Neumann, ..all.clone() }),
        ("target error", Settings { target_error: "20%".parse().unwrap(), ..all.clone() }),
    ];
    for sampler in SamplerKind::ALL {
        ways.push(("sampler", Settings { sampler, ..all.clone() }));
    }
    for (way, settings) in ways {
        let (baker, state) = solved(&scene, &settings);
        let gathers = matches!(baker.method(), Method::FinalGather { .. });
        assert_eq!(gathers, way == "few stored", "{}", baker.method());
        assert_eq!(state.read_direct.is_some(), way != "target error");
        let off = mean(&baker, &state) / expected - 1.0;
        // 64 rays at each of a thousand points.
        assert!(off.abs() < 0.01, "{way}: {off}");
        let solution = baker.solution(&state);
        let points = solution.points.as_ref().unwrap();
        assert_eq!((points.len(), solution.valid.len()), (state.valid.len(), scene.vertex_count()));
        let radius = |level: u32| 0.12 * f32::from(1u8 << (settings.levels - 1 - level));
        assert!(points.radii.iter().zip(&points.levels).all(|(found, level)| *found == radius(*level)));
        assert_eq!(points.bounces.len(), state.bounces.len());
        assert!(solution.irradiance.iter().all(|e| e.is_finite() && e.min_element() >= 0.0));
    }
}

#[test]
fn a_resumed_bake_has_the_same_bits_on_any_number_of_threads() {
    let shoot = ScheduleKind::Shoot;
    // More vertices than points, too.
    let (room, fine) = (room(3), room(14));
    let few = Settings { point_spacing: PointSpacing::Metres(0.1), indirect_samples: 16, ..settings() };
    let adaptive = Adaptive::At("10%".parse().unwrap());
    let shot = Settings { schedule: shoot, bounces: BounceLimit::All, remainder: 0.1, ..settings() };
    for (scene, settings) in [
        (&room, Settings { levels: 2, ..settings() }),
        (&room, Settings { levels: 4, adaptive, ..settings() }),
        (&room, shot.clone()),
        (&fine, few.clone()),
        (&fine, Settings { projection: Projection::Point, ..few.clone() }),
        (&fine, Settings { levels: 3, adaptive, ..few.clone() }),
        (&fine, Settings { point_spacing: few.point_spacing, ..shot }),
    ] {
        let scene = scene.clone();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let baker = Baker::new(Arc::clone(&scene), settings.clone());
                let keep = Keep(&baker, Mutex::default());
                let mut state = SolveState::new();
                baker.run(&mut state, &Control::default(), &keep).unwrap();
                (keep.1.into_inner().unwrap(), state, baker)
            })
        };
        let (saved, state, baker) = on(1);
        assert!(on(3).1 == state, "bits on three threads differ");
        assert_eq!(baker.basis().direct().is_some(), Arc::ptr_eq(&scene, &fine));
        for checkpoint in &saved[..saved.len().min(4)] {
            assert!(run(&baker, baker.resume(checkpoint).unwrap()) == state, "bits of a resumed bake differ");
        }
        let solution = Saved::Solution(Box::new(baker.solution(&state)));
        if settings.schedule == ScheduleKind::Gather {
            assert!(run(&baker, baker.resume(&solution).unwrap()) == state, "bits from a solution differ");
        }
        let other = Settings { point_spacing: PointSpacing::Metres(0.07), ..settings.clone() };
        let error = Baker::new(Arc::clone(&scene), other).resume(&saved[0]).unwrap_err();
        assert!(error.to_string().contains("another basis"), "{error}");
    }
}

#[test]
fn points_that_follow_light_are_fewer_and_find_the_same_light() {
    let scene = room(2);
    let all = Settings { levels: 4, point_spacing: PointSpacing::Metres(0.025), ..settings() };
    let adaptive = |error: &str| Adaptive::At(error.parse().unwrap());
    let some = Settings { adaptive: adaptive("20%"), ..all.clone() };
    let (on_all, of_all) = solved(&scene, &all);
    let (baker, state) = solved(&scene, &some);
    let measured = state.valid.iter().filter(|valid| **valid).count();
    assert!(3 * measured < of_all.valid.len(), "{measured} of {}", of_all.valid.len());
    let indirect = |baker: &Baker, state: &SolveState| baker.power(&state.bounces[1]);
    let off = indirect(&baker, &state) / indirect(&on_all, &of_all) - 1.0;
    assert!(off.abs() < 0.01, "{off}");
    // No more than are allowed, but the two coarsest levels.
    let few = Settings { max_vertices: 10, ..some.clone() };
    let points = baker.basis().points().unwrap();
    let (_, state) = solved(&scene, &few);
    let finer = points.nodes_of_level(2).start as usize;
    assert!(
        state.valid[finer..].iter().all(|valid| !valid) && state.valid[..finer].iter().any(|valid| *valid)
    );
    // The mesh stays as it is.
    assert!(baker.adapted(&Control::default(), &mut |_| {}).unwrap().is_none());
}

#[test]
fn a_relit_baker_takes_the_points_that_its_settings_ask_for() {
    let scene = room(3);
    let baker = Baker::new(Arc::clone(&scene), settings());
    for point_spacing in [PointSpacing::Metres(0.06), PointSpacing::Points(300), PointSpacing::Off] {
        let settings = Settings { point_spacing, ..settings() };
        let relit = baker.relit(Arc::clone(&scene), settings.clone());
        let new = Baker::new(Arc::clone(&scene), settings);
        assert_eq!(relit.basis().identity(), new.basis().identity());
        assert_eq!(Arc::ptr_eq(relit.basis(), baker.basis()), point_spacing == PointSpacing::Metres(0.06));
        assert!(run(&relit, SolveState::new()) == run(&new, SolveState::new()), "{point_spacing}");
    }
}

#[test]
fn how_surfaces_are_cut_into_triangles_makes_less_than_a_percent() {
    // A wall of two triangles, and one of 242: the points are others, their light is the same.
    let settings =
        Settings { direct_samples: 64, indirect_samples: 256, bounces: BounceLimit::All, ..settings() };
    let means = [1, 11, 30].map(|cells| {
        let (baker, state) = solved(&room(cells), &settings);
        (mean(&baker, &state), baker.power(&state.bounces[1]), baker.basis().node_count())
    });
    println!("{means:?}");
    for (all, first, nodes) in means {
        assert!(
            (all / means[0].0 - 1.0).abs() < 0.01 && (first / means[0].1 - 1.0).abs() < 0.01,
            "{means:?}"
        );
        assert!((nodes as f64 / means[0].2 as f64 - 1.0).abs() < 0.05, "{means:?}");
    }
}

#[test]
fn lumels_gather_what_points_have_carried() {
    for (cells, spacing) in [(4, 0.06), (14, 0.1)] {
        lumels_gather_what_points_of_a_spacing_have_carried(&room(cells), spacing);
    }
}

fn lumels_gather_what_points_of_a_spacing_have_carried(scene: &Arc<Scene>, spacing: f32) {
    let unwrapping = UnwrapSettings { density: Density::PerMetre(8.0), ..UnwrapSettings::default() };
    let atlas = unwrap(scene, &unwrapping, &|| Pace::Go).unwrap().atlas;
    let lumels = Lumels::new(Arc::clone(scene), atlas);
    let point_spacing = PointSpacing::Metres(spacing);
    let carried = Settings { point_spacing, direct_samples: 32, indirect_samples: 128, ..settings() };
    let on_vertices = Settings { point_spacing: PointSpacing::Off, ..carried.clone() };
    let [points, vertices] = [carried, on_vertices].map(|settings| {
        let (baker, state) = solved(scene, &settings);
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        (0..light.len()).map(|lumel| light.irradiance(lumel)).collect::<Vec<_>>()
    });
    let off = difference(&points, &vertices);
    assert!(off < 0.03, "{off}");
}

#[test]
fn what_does_not_go_together_with_points_is_refused_by_name() {
    for (bad, other) in [
        (Settings { layers: Layers::Lights, ..settings() }, "layers"),
        (Settings { directional: Directional::Sh1, ..settings() }, "directional"),
    ] {
        let message = bad.validate().unwrap_err().to_string();
        assert!(message.contains("point_spacing 0.06 and") && message.contains(other), "{message}");
    }
    for (bad, other) in [
        (Settings { point_spacing: PointSpacing::Off, ..settings() }, "point_spacing"),
        (Settings { target_error: "2%".parse().unwrap(), ..settings() }, "target_error"),
        (Settings { schedule: ScheduleKind::Shoot, bounces: BounceLimit::All, ..settings() }, "schedule"),
    ] {
        let message = Settings { levels: 2, ..bad }.validate().unwrap_err().to_string();
        assert!(message.contains("levels 2 and") && message.contains(other), "{message}");
    }
    for (bad, other) in [
        (Settings { levels: 2, ..settings() }, "levels 2"),
        (Settings { levels: 3, solver: SolverKind::Neumann, ..settings() }, "solver neumann"),
    ] {
        let message = Settings { adaptive: Adaptive::Auto, ..bad }.validate().unwrap_err().to_string();
        assert!(message.contains("adaptive auto and") && message.contains(other), "{message}");
    }
    let scene = room(1);
    let tiny = PointSpacing::Metres(1e-6).need(&scene, 1).unwrap();
    let least = tiny.least_spacing.unwrap();
    assert!(tiny.points > 1_000_000_000_000 && (1e-4..1e-3).contains(&least), "{tiny:?}");
    assert_eq!(PointSpacing::Metres(1e-6).on(&scene), Some(least));
    assert_eq!(PointSpacing::Metres(0.1).need(&scene, 4).unwrap().least_spacing, None);
}

#[test]
fn a_solution_is_shown_as_its_points_have_it_with_direct_light_of_the_vertices() {
    let scene = room(3);
    let (baker, state) = solved(&scene, &Settings { levels: 2, ..settings() });
    let solution = baker.solution(&state);
    let scattered = |selection| {
        let light = solution.scattered_light(&scene, &selection).unwrap().unwrap();
        gated(light, &scene, &**baker.tracer())
    };
    let [sum, direct, bounce] =
        [SolutionSelection::Sum, SolutionSelection::Bounce(0), SolutionSelection::Bounce(1)].map(scattered);
    let [sum, direct, bounce] = [&sum, &direct, &bounce].map(|light| light.lighting(&scene).unwrap());
    let at_vertices = solution.lighting(&scene, &SolutionSelection::Bounce(0)).unwrap();
    let carried = |field| FieldLighting { basis: &**baker.basis(), field };
    let total = state.total();
    let mut between = 0.0_f32;
    for at in random_surface_points(&scene, 500, 11) {
        let read = |lighting: &dyn Lighting| lighting.irradiance(at, Vec3::Y).0;
        let same = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-4 * b.length().max(1.0), "{a} and {b}");
        same(read(&direct), read(&at_vertices));
        same(read(&bounce), read(&carried(&state.bounces[1])));
        same(read(&sum), read(&carried(&total)) - read(&carried(&state.bounces[0])) + read(&direct));
        let coarse = solution.lighting(&scene, &SolutionSelection::Bounce(1)).unwrap();
        between = between.max((read(&bounce) - read(&coarse)).length() / read(&coarse).length());
    }
    assert!(between > 0.1, "walls of few triangles hide what points know: {between}");
    assert!(solution.scattered_light(&scene, &SolutionSelection::Bounce(9)).is_err());
    assert!(solution.scattered_light(&room(4), &SolutionSelection::Sum).is_err());
}
