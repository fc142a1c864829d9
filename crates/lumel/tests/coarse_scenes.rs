//! Scenes of few triangles, tessellated to suit them, against light that is measured at random points.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{EulerRot, Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Control, ErrorCause, ErrorEstimate, LightSampling, Preset, Scene, SceneBuilder,
    Settings, Silent, SolveState,
};
use lumel_basis::{Field, PointReceivers, VertexLighting};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{ceiling_light, grey, placed, reordered, scene};
use lumel_testkit::{Reference, SurfaceError};
use lumel_transport::{CpuTransport, Plan, Transport};
use std::sync::Arc;

/// A room of 12 triangles with a block of 12, lit from the ceiling.
fn room() -> SceneBuilder {
    let mut meshes = cuboid(Vec3::ZERO, Vec3::splat(2.0), 1, Facing::Inward, [0; 6]);
    meshes.extend(cuboid(Vec3::new(0.7, 0.5, 0.0), Vec3::new(1.3, 1.2, 0.6), 1, Facing::Outward, [0; 6]));
    let light = lumel::Light::Rect(ceiling_light(Vec3::new(1.0, 1.0, 1.98), 0.5, 0.5, 20.0));
    scene(meshes, vec![grey(0.5, 0.0)], vec![light])
}

fn error(builder: SceneBuilder, settings: &Settings) -> (SurfaceError, Arc<Scene>) {
    let (error, _, scene) = errors(builder, settings);
    (error, scene)
}

/// The error as it is and as it is estimated, if there are vertices to estimate it at.
fn errors(builder: SceneBuilder, settings: &Settings) -> (SurfaceError, Option<ErrorEstimate>, Arc<Scene>) {
    let scene = Arc::new(builder.build().unwrap().0);
    let baker = Baker::new(Arc::clone(&scene), settings.clone());
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let values = baker.light_at_vertices(&state);
    let plan = Plan { direct_samples: 256, indirect_samples: 256, seed: 1, ..Plan::default() };
    let towards = |points: PointReceivers| -> Box<dyn Transport> {
        let (scene, tracer) = (Arc::clone(baker.scene()), Arc::clone(baker.tracer()));
        Box::new(CpuTransport::new(scene, tracer, Arc::clone(baker.basis()), Arc::new(points), plan))
    };
    // What the last bounce reflects is not in the light.
    let reflecting = Field::sum(state.valid.len(), &state.bounces[..state.bounces.len() - 1]);
    let reference = Reference::measured(&scene, 600, 3, towards, Some(&reflecting), 4);
    println!("noise of the reference {:.4}", reference.noise());
    let error = reference.error_of(&VertexLighting::new(&scene, &values).unwrap());
    (error, baker.error_estimate(&baker.solution(&state)), scene)
}

#[test]
fn a_room_of_few_triangles_is_right_over_its_surface() {
    let settings =
        Settings { bounces: BounceLimit::Count(3), direct_samples: 32, ..Preset::Draft.settings() };
    let turn = Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3);
    let turned = reordered(placed(room(), turn, Vec3::new(20.0, -14.0, 8.0)));
    let mut counts = Vec::new();
    for (place, mut builder) in [("as given", room()), ("turned, moved, reordered", turned)] {
        let (as_it_is, _) = error(builder.clone(), &settings);
        let (edge, _) = builder.tessellate_to_suit(Preset::Medium.vertex_budget());
        let (error, scene) = error(builder, &settings);
        println!("{place}: {edge:?}, {} vertices: {error:?}, before {as_it_is:?}", scene.vertex_count());
        assert!(as_it_is.trimmed > 0.1, "{place}: {as_it_is:?}");
        assert!(error.trimmed < 0.03 && error.bias.abs() < 0.01, "{place}: {error:?}");
        counts.push(scene.vertex_count());
    }
    assert_eq!(counts[0], counts[1], "turning and order change nothing");
}

#[test]
fn estimates_of_the_error_are_about_right_and_name_its_cause() {
    let cases = [
        ("few shadow rays", 0.05, 2, 512, ErrorCause::DirectNoise),
        ("few hemisphere rays", 0.05, 64, 8, ErrorCause::IndirectNoise),
        ("few vertices", 0.3, 64, 512, ErrorCause::CoarseMesh),
    ];
    for (what, max_edge, direct_samples, indirect_samples, cause) in cases {
        let mut builder = room();
        builder.tessellate(max_edge).unwrap();
        let settings = Settings {
            bounces: BounceLimit::Count(3),
            direct_samples,
            indirect_samples,
            // Without closed forms, light varies wherever one stands.
            light_sampling: LightSampling::Area,
            ..Preset::Draft.settings()
        };
        let (error, estimate, _) = errors(builder, &settings);
        let estimate = estimate.unwrap();
        println!("{what}: {estimate:?} for {error:?}");
        let ratio = estimate.error / error.rms;
        assert!((0.5..2.0).contains(&ratio), "{what}: {estimate:?} for {error:?}");
        assert_eq!(estimate.cause, cause, "{what}");
    }
}

/// Most light may fall where nobody looks: on a plate outside, under a lamp of its own.
#[test]
fn bright_light_outside_does_not_hide_the_error_in_a_room() {
    let settings = Settings {
        bounces: BounceLimit::Count(3),
        direct_samples: 64,
        indirect_samples: 8,
        ..Preset::Draft.settings()
    };
    let of = |mut builder: SceneBuilder| {
        builder.tessellate(0.1).unwrap();
        let (_, estimate, _) = errors(builder, &settings);
        estimate.unwrap()
    };
    let alone = of(room());
    let mut with_plate = room();
    // Smaller than all surfaces of the room.
    let corners = [[-9.0, 0.0], [-5.0, 0.0], [-5.0, 4.0], [-9.0, 4.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    with_plate.objects.push(quad(corners, [1; 2], 0));
    with_plate.lights.push(lumel::Light::Rect(ceiling_light(Vec3::new(-7.0, 2.0, 4.0), 2.0, 2.0, 1e3)));
    let both = of(with_plate);
    println!("{alone:?} alone, {both:?} with a bright plate");
    assert!(both.error < 0.3 * alone.error, "{both:?} hides {alone:?}");
    let ratio = both.in_darker_half.unwrap() / alone.in_darker_half.unwrap();
    assert!((0.5..2.0).contains(&ratio), "{both:?} for {alone:?}");
}
