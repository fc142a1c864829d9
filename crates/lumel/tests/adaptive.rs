//! Meshes that follow light: how good and how small they are, and that a bake of one is a bake like any other.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::Vec3;
use lumel::{
    Adapted, Adaptive, Baker, BounceLimit, Control, FaceSide, Layers, Light, Lighting, ObjectId, Preset,
    Projection, RefinementEnd, Refining, Saved, Scene, SceneBuilder, Settings, Silent, SolveError,
    SolveState, VertexLighting,
};
use lumel_basis::{Field, PointReceivers};
use lumel_scene::SurfacePoint;
use lumel_testkit::Reference;
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_transport::{CpuTransport, Plan, Transport};
use std::sync::Arc;

/// A room of 12 triangles with a block of 12, lit by a small light.
fn room() -> Arc<Scene> {
    let mut meshes = cuboid(Vec3::ZERO, Vec3::splat(2.0), 1, Facing::Inward, [0; 6]);
    meshes.extend(cuboid(Vec3::new(0.7, 0.5, 0.0), Vec3::new(1.3, 1.2, 0.6), 1, Facing::Outward, [1; 6]));
    let light = Light::Rect(ceiling_light(Vec3::new(1.0, 1.0, 1.98), 0.2, 0.2, 100.0));
    let builder: SceneBuilder = scene(meshes, vec![grey(0.5, 0.0), grey(0.7, 0.0)], vec![light]);
    Arc::new(builder.build().unwrap().0)
}

fn settings(error: &str) -> Settings {
    Settings {
        adaptive: Adaptive::At(error.parse().unwrap()),
        bounces: BounceLimit::Count(2),
        direct_samples: 16,
        indirect_samples: 32,
        ..Preset::Draft.settings()
    }
}

fn adapted(scene: &Arc<Scene>, settings: Settings) -> Adapted {
    let baker = Baker::new(Arc::clone(scene), settings);
    baker.adapted(&Control::default(), &mut |_| {}).unwrap().unwrap()
}

fn solved(baker: &Baker) -> SolveState {
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

#[test]
fn a_room_of_few_triangles_is_right_within_a_percent_on_a_mesh_of_less_than_20_000_vertices() {
    let scene = room();
    let settings = Settings {
        bounces: BounceLimit::Count(3),
        direct_samples: 64,
        indirect_samples: 256,
        ..settings("2%")
    };
    let Adapted { baker, ended } = adapted(&scene, settings.clone());
    assert_eq!(ended, RefinementEnd::Reached);
    let state = solved(&baker);
    let values = baker.light_at_vertices(&state);
    let fine = baker.scene();
    // Its bounces are carried by a uniform mesh, so that the reference knows nothing of the mesh it is compared with.
    let uniform = {
        let mut mesh = lumel::Bisection::new(Arc::clone(&scene));
        loop {
            let edges = |part: &lumel_scene::Part| {
                [[0, 1], [1, 2], [2, 0]].map(|e| e.map(|k: usize| part.vertices[k]))
            };
            let long: Vec<[u32; 2]> = mesh
                .parts()
                .flat_map(edges)
                .filter(|&ends| mesh.relative_length(ends) > 1.0 / 60.0)
                .collect();
            if long.is_empty() {
                break;
            }
            assert!(mesh.split(long, usize::MAX));
        }
        let scene = Arc::new(scene.refined(mesh.splits()).unwrap());
        Baker::new(
            scene,
            Settings { bounces: BounceLimit::Count(2), adaptive: Adaptive::Off, seed: 5, ..settings },
        )
    };
    let carried = solved(&uniform);
    let reflecting = Field::sum(carried.valid.len(), &carried.bounces);
    let plan = Plan { direct_samples: 256, indirect_samples: 512, seed: 1, ..Plan::default() };
    let towards = |points: PointReceivers| -> Box<dyn Transport> {
        let (scene, tracer) = (Arc::clone(uniform.scene()), Arc::clone(uniform.tracer()));
        Box::new(CpuTransport::new(scene, tracer, Arc::clone(uniform.basis()), Arc::new(points), plan))
    };
    let reference = Reference::measured(&scene, 1500, 3, towards, Some(&reflecting), 4);
    let lighting = VertexLighting::new(fine, &values).unwrap();
    let error = reference
        .error_of(&|at: SurfacePoint, normal: Vec3| lighting.irradiance(fine.refined_point(at), normal));
    println!(
        "{} vertices, uniform {}: {error:?}; noise of the reference {:.4}",
        fine.vertex_count(),
        uniform.scene().vertex_count(),
        reference.noise()
    );
    assert!(error.trimmed < 0.01 && error.bias.abs() < 5e-3, "{error:?}");
    assert!(fine.vertex_count() < 20_000, "{}", fine.vertex_count());
}

#[test]
fn light_on_a_refined_mesh_is_that_of_a_fresh_solve_on_it_bit_by_bit() {
    let scene = room();
    for projection in [Projection::LeastSquares, Projection::Point] {
        let settings = Settings { projection, ..settings("5%") };
        let Adapted { baker, .. } = adapted(&scene, settings.clone());
        let control = Control::default();
        let mut state = SolveState::new();
        baker.run(&mut state, &control, &Silent).unwrap();
        let splits = baker.scene().refinement().unwrap().splits();
        let again = Arc::new(scene.refined(splits).unwrap());
        let fresh = Baker::new(again, settings);
        let (fresh_control, mut fresh_state) = (Control::default(), SolveState::new());
        fresh.run(&mut fresh_state, &fresh_control, &Silent).unwrap();
        assert!(state == fresh_state, "{projection:?}: bits differ");
        println!("{projection:?}: {} rays, {} fresh", control.rays(), fresh_control.rays());
        // Most hemisphere rays were stored while the mesh was refined.
        assert!(control.rays() < fresh_control.rays(), "{projection:?}");
    }
}

#[test]
fn meshes_and_their_light_have_the_same_bits_on_any_number_of_threads_and_when_resumed() {
    let scene = room();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let Adapted { baker, .. } = adapted(&scene, settings("8%"));
            let state = solved(&baker);
            (baker, state)
        })
    };
    let (baker, state) = run(1);
    let (other, other_state) = run(3);
    let splits = |baker: &Baker| baker.scene().refinement().unwrap().splits().to_vec();
    assert_eq!(splits(&baker), splits(&other));
    assert!(state == other_state, "bits differ");
    // After direct light, from a file alone.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint.npz");
    let begun = SolveState { bounces: state.bounces[..1].to_vec(), tail: None, ..state.clone() };
    baker.checkpoint(&begun).save(&path).unwrap();
    let again = Arc::new(scene.refined(&Saved::load_splits(&path).unwrap()).unwrap());
    let resumed = Baker::new(Arc::clone(&again), settings("8%"));
    let mut resumed_state = resumed.resume(&Saved::load_for(&path, &again).unwrap()).unwrap();
    resumed.run(&mut resumed_state, &Control::default(), &Silent).unwrap();
    assert!(resumed_state == state, "bits differ");
}

#[test]
fn a_refinement_goes_on_from_each_of_its_steps_with_the_bits_of_one_that_was_not_interrupted() {
    let scene = room();
    let folder = tempfile::tempdir().unwrap();
    for settings in [settings("8%"), Settings { max_vertices: 1500, ..settings("2%") }] {
        let baker = Baker::new(Arc::clone(&scene), settings.clone());
        let mut steps = Vec::new();
        let mut keep = |refining: &Refining<'_>| {
            assert_eq!(refining.irradiance().len(), refining.mesh().vertex_count());
            assert_eq!(refining.indicator().len(), refining.mesh().vertex_count());
            steps.extend(refining.state());
        };
        let whole = baker.adapted(&Control::default(), &mut keep).unwrap().unwrap();
        let light = solved(&whole.baker);
        println!("{} steps", steps.len());
        assert!(steps.len() > 1);
        for (i, step) in steps.into_iter().enumerate() {
            let path = folder.path().join("a.checkpoint.npz");
            baker.checkpoint_of_refinement(step.clone()).save(&path).unwrap();
            let saved = Saved::load_for(&path, &scene).unwrap();
            let read = baker.resume_refinement(&saved).unwrap().unwrap();
            assert!(read == step, "step {i} is not what was saved");
            let control = Control::default();
            let resumed = baker.adapted_from(Some(&read), &control, &mut |_| {}).unwrap().unwrap();
            assert_eq!(resumed.ended, whole.ended);
            let splits = |adapted: &Adapted| adapted.baker.scene().refinement().unwrap().splits().to_vec();
            assert!(splits(&resumed) == splits(&whole), "step {i}: splits differ");
            if i % 3 == 0 {
                assert!(solved(&resumed.baker) == light, "step {i}: bits differ");
            }
        }
        // Other settings would have split other edges.
        let other = baker.relit(Arc::clone(&scene), Settings { seed: 9, ..settings });
        let saved = Saved::load(&folder.path().join("a.checkpoint.npz")).unwrap();
        assert!(other.resume_refinement(&saved).unwrap_err().to_string().contains("seed"));
        assert!(matches!(other.resume(&saved), Err(lumel::ResumeError::Settings { .. })));
    }
}

#[test]
fn target_errors_layers_and_other_lights_work_on_refined_meshes() {
    let scene = room();
    let to_error = Settings { target_error: "30%".parse().unwrap(), ..settings("8%") };
    let Adapted { baker, .. } = adapted(&scene, to_error);
    assert!(solved(&baker).errors.is_some_and(|errors| errors.accuracy.share > 0.9));
    let in_layers = Settings { layers: Layers::Lights, ..settings("8%") };
    let Adapted { baker, .. } = adapted(&scene, in_layers.clone());
    let state = solved(&baker);
    let layers = Field::sum(state.valid.len(), &state.layers);
    let pairs = layers.values().iter().zip(state.total().values().to_vec());
    assert!(!state.layers.is_empty() && pairs.clone().all(|(a, b)| (*a - b).length() <= 1e-5 * b.length()));
    // Under another light the mesh stays, and so do the rays.
    let mut lights = scene.lights().to_vec();
    if let Light::Rect(light) = &mut lights[0] {
        light.center.x += 0.2;
    }
    let relit = baker.relit(Arc::new(baker.scene().relit(lights).unwrap()), in_layers);
    assert!(relit.has_rays_of(baker.settings()));
    assert_eq!(relit.scene().vertex_count(), baker.scene().vertex_count());
    assert!(solved(&relit).total() != state.total());
}

#[test]
fn a_mesh_is_refined_anew_from_its_original_and_stops_when_it_is_told_to() {
    let scene = room();
    let Adapted { baker, .. } = adapted(&scene, settings("8%"));
    let again = baker.adapted(&Control::default(), &mut |_| {}).unwrap().unwrap();
    assert_eq!(again.baker.scene().geometry_hash(), baker.scene().geometry_hash());
    assert!(
        baker
            .relit(Arc::clone(baker.scene()), Settings::default())
            .adapted(&Control::default(), &mut |_| {})
            .unwrap()
            .is_none()
    );
    let control = Control::default();
    let mut rounds = 0;
    let stopped = Baker::new(Arc::clone(&scene), settings("1%")).adapted(&control, &mut |refining| {
        assert!(refining.mesh().vertex_count() > 100);
        rounds += 1;
        if rounds == 2 {
            control.cancel();
        }
    });
    assert!(matches!(stopped, Err(SolveError::Cancelled)));
    let few = adapted(&scene, Settings { max_vertices: 1500, ..settings("1%") });
    assert_eq!(few.ended, RefinementEnd::Vertices);
    assert!(few.baker.scene().vertex_count() <= 1500);
}

#[test]
fn given_vertices_get_their_light_from_a_few_lines() {
    let meshes = cuboid(Vec3::ZERO, Vec3::splat(2.0), 1, Facing::Inward, [0; 6]);
    let light = Light::Rect(ceiling_light(Vec3::new(1.0, 1.0, 1.98), 0.5, 0.5, 10.0));
    let builder = scene(meshes, vec![grey(0.5, 0.0)], vec![light]);
    let baked =
        lumel::Bake::new(builder).preset(Preset::Draft).adaptive("10%".parse().unwrap()).run().unwrap();
    let floor = baked.light_at_vertices(ObjectId(4), FaceSide::Front);
    assert_eq!(floor.len(), 4);
    assert!(floor.iter().all(|light| light.is_some_and(|light| light.x > 0.0)), "{floor:?}");
    assert!(baked.solution().splits.len() > 100);
    assert_eq!(baked.light_at_corners(ObjectId(4), FaceSide::Front).len(), 2);
}
