//! What is carried from bounce to bounce, and what is read of it.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use glam::{DVec3, Vec3};
use lumel::{
    Bake, Baker, BounceLimit, Control, Layers, Projection, Saved, Scene, Settings, SettingsPatch, Silent,
    SolveState, Tail,
};
use lumel_basis::{Basis as _, Field};
use std::sync::Arc;

fn scene() -> Arc<Scene> {
    Arc::new(lumel::open("cornell-box", &lumel::OpenOptions::default()).unwrap().builder.build().unwrap().0)
}

fn settings(projection: Projection) -> Settings {
    Settings {
        projection,
        bounces: BounceLimit::Count(2),
        tail: Tail::Geometric,
        direct_samples: 4,
        indirect_samples: 16,
        ..Settings::default()
    }
}

fn solved(scene: &Arc<Scene>, settings: Settings) -> (Baker, SolveState) {
    let (baker, mut state) = (Baker::new(Arc::clone(scene), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    (baker, state)
}

/// The largest difference over the largest value.
fn difference(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().map(|value| value.abs().max_element()).fold(0.0, f32::max);
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max) / largest
}

/// By which share the powers of two lights at all vertices differ.
fn power_differs_by(baker: &Baker, a: &[Vec3], b: &[Vec3]) -> f64 {
    let basis = baker.basis().vertices().expect("light is carried on vertices");
    let [a, b] = [a, b].map(|values| -> DVec3 {
        let of_nodes = basis.first_vertices().iter().map(|&vertex| values[vertex as usize]);
        let areas = basis.node_areas().iter().map(|&area| Vec3::splat(area));
        Field::from_values(of_nodes.collect()).weighted_sum(areas)
    });
    ((a - b) / a).abs().max_element()
}

#[test]
fn least_squares_carries_the_bits_of_area_and_reads_other_values_of_the_same_power() {
    let scene = scene();
    let (area, means) = solved(&scene, settings(Projection::Area));
    let (least_squares, state) = solved(&scene, settings(Projection::LeastSquares));
    assert!(means == state);
    for field in state.bounces.iter().chain(&state.tail) {
        let [read, carried] =
            [&least_squares, &area].map(|baker| baker.light_reader(&state).at_vertices(field));
        assert_eq!(carried, least_squares.carried_at_vertices(field));
        assert!(difference(&carried, &read) > 0.01);
        let lost = power_differs_by(&area, &carried, &read);
        assert!(lost < 1e-7, "{lost}");
    }
}

#[test]
fn a_baker_of_the_other_reading_has_all_rays() {
    let scene = scene();
    let (baker, state) = solved(&scene, settings(Projection::Area));
    let other = settings(Projection::LeastSquares);
    assert!(baker.has_rays_of(&other) && !baker.has_rays_of(&settings(Projection::Point)));
    let read = baker.relit(Arc::clone(&scene), other.clone());
    let expected = solved(&scene, other);
    assert!(read.has_rays_of(read.settings()));
    assert_eq!(read.light_at_vertices(&state), expected.0.light_at_vertices(&expected.1));
}

#[test]
fn bounces_and_layers_add_up_to_all_light_which_is_never_negative() {
    for projection in [Projection::Point, Projection::Area, Projection::LeastSquares] {
        let (baker, state) = solved(&scene(), Settings { layers: Layers::Lights, ..settings(projection) });
        let solution = baker.solution(&state);
        assert!(solution.irradiance.iter().all(|value| value.min_element() >= 0.0));
        let sum = |parts: &[&Vec<Vec3>]| -> Vec<Vec3> {
            (0..scene().vertex_count()).map(|v| parts.iter().map(|part| part[v]).sum()).collect()
        };
        let bounces: Vec<&Vec<Vec3>> = solution.bounces.iter().chain(&solution.tail).collect();
        let layers: Vec<&Vec<Vec3>> = solution.layers.iter().map(|layer| &layer.irradiance).collect();
        for (name, parts) in [("bounces", bounces), ("layers", layers)] {
            let positive: Vec<Vec3> = sum(&parts).into_iter().map(|value| value.max(Vec3::ZERO)).collect();
            let difference = difference(&solution.irradiance, &positive);
            assert!(difference < 3e-6, "{projection:?}, {name}: {difference}");
        }
        let mixed = baker.mixed(&state, |_| Vec3::ONE).unwrap();
        assert!(difference(&solution.irradiance, &mixed) < 3e-6, "{projection:?}");
    }
}

#[test]
fn least_squares_is_resumed_from_checkpoints_bit_by_bit_and_from_solutions_with_the_same_power() {
    let scene = scene();
    let whole = settings(Projection::LeastSquares);
    let (part, stopped) = solved(&scene, Settings { bounces: BounceLimit::Count(1), ..whole.clone() });
    let (baker, state) = solved(&scene, whole);
    let resumed = |saved: Saved| {
        let mut state = baker.resume(&saved).unwrap();
        assert_eq!(state.bounces.len(), 2);
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        state
    };
    assert!(resumed(Saved::Checkpoint(Box::new(part.checkpoint(&stopped)))) == state);
    let solution = || Saved::Solution(Box::new(part.solution(&stopped)));
    let light = baker.light_at_vertices(&resumed(solution()));
    // Where limits keep the nearest function from ringing, the file has light that is as strong but smoother.
    let found = difference(&baker.light_at_vertices(&state), &light);
    assert!(found < 0.05, "{found}");
    assert!(power_differs_by(&baker, &baker.light_at_vertices(&state), &light) < 1e-3);
    // Read as they are, the values of the file would be carried on.
    let area = baker.relit(scene, settings(Projection::Area));
    let mut means = area.resume(&solution()).unwrap();
    area.run(&mut means, &Control::default(), &Silent).unwrap();
    let carried = area.light_at_vertices(&state);
    let found = difference(&carried, &area.light_at_vertices(&means));
    let unread = difference(&carried, &baker.light_at_vertices(&state));
    assert!(found < 0.8 * unread, "{found} {unread}");
}

#[test]
fn a_bake_gives_what_its_file_holds() {
    let patch = SettingsPatch {
        projection: Some(Projection::LeastSquares),
        direct_samples: Some(4),
        indirect_samples: Some(16),
        ..SettingsPatch::default()
    };
    let scene = scene();
    let baked = Bake::of_scene(Arc::clone(&scene)).settings(patch).bounces(1).run().unwrap();
    let solution = baked.solution();
    let object = lumel::ObjectId(0);
    let corners = baked.light_at_corners(object, lumel::FaceSide::Front);
    let input = scene.input_mesh(object);
    let (mut found, mut expected) = (Vec::new(), Vec::new());
    for (face, light) in corners.into_iter().enumerate() {
        let vertices = input.corners(face, lumel::FaceSide::Front);
        assert_eq!(light.is_some(), vertices.is_some());
        found.extend(light.into_iter().flatten());
        expected.extend(vertices.into_iter().flatten().map(|v| solution.irradiance[v as usize]));
    }
    // All light of a file is the sum of its bounces as they are read. Conjugate gradients end where residuals are 4e-7 of the
    // largest mean; the regulariser makes up to twenty times as much of it.
    let difference = difference(&found, &expected);
    println!("{difference:.2e}");
    assert!(!found.is_empty() && difference < 3e-5, "{difference:e}");
}
