//! Rays that are traced once: every bounce on the same rows.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{DVec3, Vec3};
use lumel::{
    Baker, BounceLimit, Bvh, Control, Light, Memory, Method, OpenOptions, Projection, RayTracer, Scene,
    Settings, Silent, SolveState, SolverKind,
};
use lumel_accel::InstructionSet;
use lumel_basis::{Field, PointReceivers, VertexBasis};
use lumel_transport::{CachedTransport, CpuTransport, Job, Rows, Source, Transport, accumulate};
use std::sync::Arc;

fn scene(name: &str) -> Arc<Scene> {
    Arc::new(lumel::open(name, &OpenOptions::default()).unwrap().builder.build().unwrap().0)
}

fn settings() -> Settings {
    Settings {
        projection: Projection::Point,
        bounces: BounceLimit::Count(4),
        direct_samples: 16,
        indirect_samples: 64,
        ..Settings::default()
    }
}

fn solved(baker: &Baker) -> (SolveState, u64) {
    let (mut state, control) = (SolveState::new(), Control::default());
    baker.run(&mut state, &control, &Silent).unwrap();
    (state, control.rays())
}

/// Root mean square of a difference over that of the first.
fn relative(a: &Field, b: &Field) -> f64 {
    let square = |v: DVec3| v.length_squared();
    let pairs = || a.values().iter().zip(b.values()).map(|(a, b)| (a.as_dvec3(), b.as_dvec3()));
    let difference: f64 = pairs().map(|(a, b)| square(a - b)).sum();
    (difference / pairs().map(|(a, _)| square(a)).sum::<f64>()).sqrt()
}

struct Operators {
    plain: CpuTransport<VertexBasis, PointReceivers>,
    cached: CachedTransport<VertexBasis, PointReceivers>,
    basis: Arc<VertexBasis>,
}

fn operators(name: &str, settings: &Settings) -> Operators {
    let scene = scene(name);
    let tracer: Arc<dyn RayTracer> = Arc::new(Bvh::build(&scene));
    let basis = Arc::new(VertexBasis::new(Arc::clone(&scene)));
    let receivers = Arc::new(PointReceivers::at_vertices(&basis));
    let plain = || {
        CpuTransport::new(
            Arc::clone(&scene),
            Arc::clone(&tracer),
            Arc::clone(&basis),
            Arc::clone(&receivers),
            settings.plan(),
        )
    };
    Operators { plain: plain(), cached: CachedTransport::new(plain(), None), basis }
}

fn applied(transport: &dyn Transport, source: Source<'_>, bounce: u32) -> Field {
    let job = Job { source, bounce, pass: 0, active: None };
    accumulate(transport, &job, &Control::default(), None).unwrap().field
}

#[test]
fn bounces_on_stored_rows_are_those_of_the_neumann_series_with_the_same_rays() {
    // Barycentrics come in steps of 1/65535. Over 32 rays that averages to far less where surfaces have one colour; a
    // texture can change much within such a step, and its albedo comes in as many.
    for (name, tolerance) in [("cornell-box", 1e-6), ("atrium", 1e-5)] {
        let settings = Settings { indirect_samples: 32, ..settings() };
        let Operators { plain, cached, .. } = operators(name, &settings);
        let direct = applied(&plain, Source::Emitters(None), 0);
        let (mut by_rays, mut by_rows) = (direct.clone(), direct.clone());
        let (mut sum_of_rays, mut sum_of_rows) = (direct.clone(), direct);
        for bounce in 1..=4 {
            // The rows are the rays of bounce 1, in all bounces.
            by_rays = applied(&plain, Source::Field(&by_rays), 1);
            by_rows = applied(&cached, Source::Field(&by_rows), bounce);
            sum_of_rays = Field::sum(by_rays.node_count(), [&sum_of_rays, &by_rays]);
            sum_of_rows = Field::sum(by_rows.node_count(), [&sum_of_rows, &by_rows]);
        }
        let difference = relative(&sum_of_rays, &sum_of_rows);
        println!("{name}: {difference:.2e}");
        assert!(difference < tolerance, "{name}: {difference:e}");
    }
}

#[test]
fn each_bounce_agrees_with_a_fresh_gather_of_the_one_before() {
    let (baker, scene) = {
        let scene = scene("cornell-box");
        (Baker::new(Arc::clone(&scene), settings()), scene)
    };
    let (state, _) = solved(&baker);
    let Operators { plain, .. } = operators("cornell-box", &settings());
    for k in 1..state.bounces.len() {
        // Two fresh sets of rays tell how large their noise is, the rows must not differ more.
        let gather = |pass| {
            let job = Job {
                source: Source::Field(&state.bounces[k - 1]),
                bounce: 1,
                pass,
                active: Some(state.valid.as_slice()),
            };
            accumulate(&plain, &job, &Control::default(), None).unwrap().field
        };
        let (a, b) = (gather(11), gather(12));
        let valid = |i: &usize| state.valid[*i];
        let mean = |field: &Field| {
            let sum: DVec3 =
                (0..field.node_count()).filter(valid).map(|i| field.values()[i].as_dvec3()).sum();
            sum / scene.vertex_count() as f64
        };
        let spread = |x: &Field, y: &Field| {
            let squares = (0..x.node_count())
                .filter(valid)
                .map(|i| (x.values()[i] - y.values()[i]).as_dvec3().length_squared());
            squares.sum::<f64>()
        };
        let fresh = spread(&a, &b);
        let rows = spread(&state.bounces[k], &a);
        // Sums over ten thousand independent differences: both are known to two percent.
        assert!((rows / fresh - 1.0).abs() < 0.1, "bounce {k}: {rows} against {fresh}");
        let sigma = (fresh / 2.0).sqrt() / scene.vertex_count() as f64;
        let difference = (mean(&state.bounces[k]) - mean(&a)).length();
        assert!(difference < 4.0 * 2f64.sqrt() * sigma, "bounce {k}: {difference} against {sigma}");
    }
}

#[test]
fn the_furnace_is_exact_to_rounding() {
    for projection in [Projection::Point, Projection::Area] {
        let scene = scene("furnace");
        let settings = Settings { projection, bounces: BounceLimit::Count(8), ..settings() };
        let (state, _) = solved(&Baker::new(scene, settings));
        // Each bounce is the one before times the albedo.
        for pair in state.bounces.windows(2) {
            let ratios: Vec<Vec3> = pair[0]
                .values()
                .iter()
                .zip(pair[1].values())
                .map(|(before, after)| *after / *before)
                .collect();
            let first = ratios[0];
            let worst = ratios.iter().map(|r| (*r - first).abs().max_element()).fold(0.0, f32::max);
            assert!(worst < 2e-6 && first.is_finite(), "{projection:?}: {worst}");
        }
    }
}

fn moved(scene: &Scene) -> Arc<Scene> {
    let mut lights = scene.lights().to_vec();
    for light in &mut lights {
        if let Light::Rect(rect) = light {
            rect.center += Vec3::new(0.1, -0.1, 0.0);
        }
    }
    Arc::new(scene.relit(lights).unwrap())
}

#[test]
fn a_moved_light_needs_no_new_hemisphere_ray() {
    let scene = scene("cornell-box");
    let old = Baker::new(Arc::clone(&scene), settings());
    let (_, first) = solved(&old);
    assert!(old.has_rays_of(&Settings { direct_samples: 3, bounces: BounceLimit::All, ..settings() }));
    assert!(!old.has_rays_of(&Settings { seed: 9, ..settings() }));
    assert!(!Baker::new(Arc::clone(&scene), settings()).has_rays_of(&settings()));
    let relit = moved(&scene);
    let (kept, again) = solved(&old.relit(Arc::clone(&relit), settings()));
    let (new, all) = solved(&Baker::new(relit, settings()));
    assert_eq!(kept, new);
    let hemispheres = 64 * VertexBasis::new(Arc::clone(&scene)).scene().vertex_count() as u64;
    println!("rays: {first} first, {again} after the light moved, {all} by a new baker");
    // Merged vertices are fewer than vertices.
    assert!(again < all && (all - again) * 10 > hemispheres * 9 && (all - again) <= hemispheres);
}

#[test]
fn bits_do_not_depend_on_threads_or_on_where_a_solve_was_stopped() {
    let scene = scene("cornell-box");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solved(&Baker::new(Arc::clone(&scene), settings())).0)
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let baker = Baker::new(Arc::clone(&scene), settings());
    let mut state = one.clone();
    state.bounces.truncate(2);
    let resumed = baker.resume_solution(&baker.solution(&state)).unwrap();
    let mut resumed = resumed;
    baker.run(&mut resumed, &Control::default(), &Silent).unwrap();
    assert_eq!(resumed, one);
}

#[test]
fn bits_do_not_depend_on_the_instruction_set() {
    let scene = scene("cornell-box");
    let tree = Bvh::build(&scene);
    for solver in [SolverKind::Cached, SolverKind::Neumann] {
        let with = |set| {
            let tracer = Arc::new(tree.clone().with_instructions(set).unwrap());
            let settings = Settings { solver, indirect_samples: 16, ..settings() };
            solved(&Baker::with_tracer(Arc::clone(&scene), tracer, settings)).0
        };
        let portable = with(InstructionSet::Portable);
        for set in InstructionSet::available() {
            assert!(with(set) == portable, "{set}, {solver:?}");
        }
    }
}

#[test]
fn memory_is_what_was_announced() {
    for (name, textured) in [("cornell-box", false), ("atrium", true)] {
        let Operators { cached, basis, .. } =
            operators(name, &Settings { indirect_samples: 16, ..settings() });
        assert_eq!(cached.rows().bytes(), 0);
        applied(&cached, Source::Field(&Field::zeros(cached.shape().nodes)), 1);
        let rows = Rows::bytes_for(16 * cached.shape().elements as u64, false);
        assert_eq!(cached.rows().bytes(), rows);
        assert_eq!(basis.scene().has_varying_albedo(), textured);
        assert_eq!(cached.memory(), Rows::bytes_for(16 * cached.shape().elements as u64, textured));
    }
}

#[test]
fn with_little_memory_few_rays_are_stored_and_a_final_gather_smooths_them() {
    let scene = scene("cornell-box");
    let settings = |memory, indirect_samples, seed| Settings {
        memory: Memory(memory),
        indirect_samples,
        seed,
        bounces: BounceLimit::Count(4),
        projection: Projection::Point,
        direct_samples: 256,
        ..Settings::default()
    };
    let total = |settings: Settings| {
        let baker = Baker::new(Arc::clone(&scene), settings);
        let (state, _) = solved(&baker);
        (state.total(), baker.method(), state)
    };
    let reference = total(settings(u64::MAX, 2048, 1)).0;
    let (full, method, _) = total(settings(u64::MAX, 256, 2));
    assert!(matches!(method, Method::Cached { .. }), "{method:?}");
    let n_vertices = solved(&Baker::new(Arc::clone(&scene), settings(u64::MAX, 1, 2))).0.valid.len();
    let eighth = Rows::bytes_for(32 * n_vertices as u64, false);
    let (gathered, method, state) = total(settings(eighth, 256, 2));
    assert_eq!(method, Method::FinalGather { stored: 32, memory: Memory(eighth) });
    let few = Field::sum(full.node_count(), &state.bounces);
    let [full, gathered, few] = [full, gathered, few].map(|field| relative(&reference, &field));
    println!("all rays {full:.2e}, final gather {gathered:.2e}, its stored rays alone {few:.2e}");
    assert!(gathered < 0.6 * few && gathered < 2.5 * full, "{full} {gathered} {few}");
    // Nothing fits: the plain series.
    assert_eq!(total(settings(100, 256, 2)).1, Method::Neumann);
    // It goes on from a saved solution with the same bits.
    let baker = Baker::new(Arc::clone(&scene), settings(eighth, 256, 2));
    let mut resumed = baker.resume_solution(&baker.solution(&state)).unwrap();
    baker.run(&mut resumed, &Control::default(), &Silent).unwrap();
    assert_eq!(resumed, state);
    // With memory for all rays the bounces would be others.
    let enough = Baker::new(Arc::clone(&scene), settings(u64::MAX, 256, 2));
    let error = enough.resume_solution(&baker.solution(&state)).unwrap_err().to_string();
    assert!(error.contains("memory"), "{error}");
    // More than enough is the same.
    let more = Baker::new(scene, settings(u64::MAX - 1, 256, 2));
    let solution = enough.solution(&solved(&enough).0);
    assert!(more.resume_solution(&solution).is_ok());
}

#[test]
fn the_plain_series_has_rays_of_its_own_for_every_bounce() {
    let scene = scene("cornell-box");
    let plain = Baker::new(Arc::clone(&scene), Settings { solver: SolverKind::Neumann, ..settings() });
    let cached = Baker::new(Arc::clone(&scene), settings());
    let ((by_rays, many), (by_rows, few)) = (solved(&plain), solved(&cached));
    // The first bounce has the same rays, later ones do not; what they bring is the same light.
    assert!(relative(&by_rays.bounces[1], &by_rows.bounces[1]) < 1e-5);
    let later = relative(&by_rays.bounces[2], &by_rows.bounces[2]);
    assert!(later > 1e-3 && later < 0.1, "{later}");
    assert!(many > 2 * few, "{many} rays against {few}");
}
