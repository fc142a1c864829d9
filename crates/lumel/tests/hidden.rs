//! What nobody can see darkens nothing, what is merely in the shade of a one-sided surface is measured as it is, and what is
//! given twice counts once.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{EulerRot, Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Control, EmitterSampling, Preset, Projection, SceneBuilder, Settings, Silent,
    SolveState,
};
use lumel_basis::{PointReceivers, VertexLighting};
use lumel_scene::{MaterialId, ObjectMesh, Radiance};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{grey, placed, scene};
use lumel_testkit::{Reference, SurfaceError};
use lumel_transport::{CpuTransport, Plan, Transport};
use std::f32::consts::PI;
use std::sync::Arc;

const PROJECTIONS: [Projection; 2] = [Projection::Point, Projection::LeastSquares];

/// Not at all, and about all three axes.
fn turns() -> [Quat; 2] {
    [Quat::IDENTITY, Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3)]
}

/// A square of a width at a height that faces up, of so many cells.
fn square(width: f32, height: f32, cells: u32) -> ObjectMesh {
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    quad(corners.map(|[x, y]| Vec3::new(x * width, y * width, height)), [cells; 2], 0)
}

/// The same from the other side, of another material.
fn turned_down(mut mesh: ObjectMesh, material: u32) -> ObjectMesh {
    for face in &mut mesh.faces {
        face.vertices.swap(0, 1);
        face.material = MaterialId(material);
    }
    mesh.normals.iter_mut().for_each(|normal| *normal = -*normal);
    mesh
}

/// Under a sky with a radiance of 1.
fn outdoors(objects: Vec<ObjectMesh>) -> SceneBuilder {
    SceneBuilder { sky: Radiance::splat(1.0).into(), ..scene(objects, vec![grey(0.5, 0.0)], vec![]) }
}

/// Direct light at all vertices.
fn solved(builder: SceneBuilder, projection: Projection) -> (Baker, Vec<Vec3>) {
    let settings = Settings {
        projection,
        bounces: BounceLimit::Count(0),
        indirect_samples: 256,
        ..Preset::Medium.settings()
    };
    let baker = Baker::new(Arc::new(builder.build().unwrap().0), settings);
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let light = baker.light_at_vertices(&state);
    (baker, light)
}

/// The share of the hemisphere above the middle of a square that it hides, seen from a distance of 1; `half` its edges.
fn hidden_by_square(half: f32) -> f32 {
    let slant = half / (1.0 + half * half).sqrt();
    4.0 * slant * slant.atan() / PI
}

#[test]
fn a_floor_under_a_one_sided_awning_is_in_its_shade_whichever_side_is_lit() {
    for (half, height) in [(1.25, 1.0), (1.25, 0.5)] {
        let expected = PI * (1.0 - hidden_by_square(half / height));
        for turn in turns() {
            for lit_below in [false, true] {
                let awning = square(2.0 * half, height, 4);
                let awning = if lit_below { turned_down(awning, 0) } else { awning };
                let builder = placed(outdoors(vec![square(6.0, 0.0, 24), awning]), turn, Vec3::ONE);
                for projection in PROJECTIONS {
                    let (baker, light) = solved(builder.clone(), projection);
                    let positions = baker.scene().positions();
                    let middle = positions.iter().position(|p| (*p - Vec3::ONE).length() < 1e-3).unwrap();
                    let error = light[middle].x - expected;
                    println!("{height} {lit_below} {projection:?}: {expected} {error}");
                    // 256 rays whose mean square is at most π E: four standard errors, and what hat functions blur.
                    let noise = 4.0 * (PI * expected / 256.0).sqrt();
                    assert!(error.abs() < noise.min(0.06), "{height} {lit_below} {projection:?}: {error}");
                }
            }
        }
    }
}

/// A box on a coarse floor, so many metres above it, with or without its underside; its triangles come last.
fn box_on_floor(gap: f32, has_bottom: bool) -> SceneBuilder {
    let mut objects = vec![square(6.0, 0.0, 13)];
    let mut sides =
        cuboid(Vec3::new(-1.0, -1.0, gap), Vec3::new(1.0, 1.0, 1.0 + gap), 4, Facing::Outward, [0; 6]);
    let bottom = sides.remove(4);
    objects.extend(sides);
    objects.extend(Some(bottom).filter(|_| has_bottom));
    outdoors(objects)
}

#[test]
fn what_stands_on_a_floor_or_just_above_it_or_is_sunk_into_it_makes_no_dark_fringe() {
    let plan = Plan { direct_samples: 1024, indirect_samples: 1024, seed: 1, ..Plan::default() };
    for turn in turns() {
        let built = |gap, has_bottom| placed(box_on_floor(gap, has_bottom), turn, Vec3::ONE);
        let (baker, _) = solved(built(0.0, false), Projection::Point);
        let towards = |points: PointReceivers| -> Box<dyn Transport> {
            let (scene, tracer) = (Arc::clone(baker.scene()), Arc::clone(baker.tracer()));
            Box::new(CpuTransport::new(scene, tracer, Arc::clone(baker.basis()), Arc::new(points), plan))
        };
        let exact = Reference::measured(baker.scene(), 2000, 3, towards, None, 2);
        for (what, gap, has_bottom) in [
            ("on the floor", 0.0, true),
            ("without bottom", 0.0, false),
            ("a hair above it", 1e-4, true),
            ("a finger above it", 1e-2, true),
            ("sunk", -0.02, true),
            ("sunk, without bottom", -0.02, false),
        ] {
            for projection in PROJECTIONS {
                let (baker, light) = solved(built(gap, has_bottom), projection);
                let error: SurfaceError =
                    exact.error_of(&VertexLighting::new(baker.scene(), &light).unwrap());
                println!("{what}, {projection:?}: {error:?}");
                assert!(
                    error.bias.abs() < 0.005 && error.trimmed < 0.016,
                    "{what}, {projection:?}: {error:?}"
                );
            }
        }
    }
}

/// A glowing room from inside and from outside, in this order or the other, the same triangles or other halves of its walls.
fn doubled_room(outside_first: bool, other_halves: bool) -> SceneBuilder {
    let side = |facing| cuboid(-Vec3::ONE, Vec3::ONE, 4, facing, [0; 6]);
    let (mut inside, mut outside) = (side(Facing::Inward), side(Facing::Outward));
    if other_halves {
        for pair in outside.iter_mut().flat_map(|wall| wall.faces.chunks_exact_mut(2)) {
            let [[p, q, r], [.., s]] = [pair[0].vertices, pair[1].vertices];
            (pair[0].vertices, pair[1].vertices) = ([q, r, s], [s, p, q]);
        }
    }
    if outside_first {
        std::mem::swap(&mut inside, &mut outside);
    }
    inside.extend(outside);
    scene(inside, vec![grey(0.5, 1.0)], vec![])
}

#[test]
fn a_room_whose_walls_are_doubled_glows_as_one_whose_walls_are_not() {
    for turn in turns() {
        for (outside_first, other_halves) in [(false, false), (true, false), (false, true), (true, true)] {
            let builder = placed(doubled_room(outside_first, other_halves), turn, Vec3::ONE);
            let mut builder = builder;
            builder.unify_diagonals();
            let (scene, warnings) = builder.build().unwrap();
            assert_eq!(warnings.len(), 1);
            for projection in PROJECTIONS {
                let emitters = EmitterSampling::Rays;
                let settings =
                    Settings { projection, emitters, bounces: BounceLimit::All, ..Preset::Draft.settings() };
                let baker = Baker::new(Arc::new(scene.clone()), settings);
                let mut state = SolveState::new();
                baker.run(&mut state, &Control::default(), &Silent).unwrap();
                let light = baker.light_at_vertices(&state);
                let vertices = baker.scene().positions().iter().zip(baker.scene().normals());
                for (e, (position, normal)) in light.iter().zip(vertices) {
                    let faces_in = (*position - Vec3::ONE).dot(*normal) < 0.0;
                    // 1 / (1 − ρ) inside, to the remainder of the series; nothing shines from outside.
                    let expected = if faces_in { 2.0 } else { 0.0 };
                    assert!(
                        (e.x - expected).abs() < 3e-3,
                        "{outside_first} {other_halves} {projection:?}: {e}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_lamp_counts_once_however_often_and_with_whatever_it_is_given() {
    let lamp =
        |name: &str, material| ObjectMesh { name: name.into(), ..turned_down(square(0.5, 1.0, 1), material) };
    let lit = |lamps: Vec<ObjectMesh>| {
        let mut builder = outdoors(vec![square(2.0, 0.0, 8)]);
        builder.sky = Radiance::splat(0.0).into();
        builder.materials = vec![grey(0.5, 0.0), grey(0.0, 10.0)];
        builder.objects.extend(lamps);
        solved(builder, Projection::LeastSquares).1[..81].to_vec()
    };
    let once = lit(vec![lamp("lamp", 1)]);
    assert!(once.iter().all(|e| e.x > 0.01));
    for lamps in [
        vec![lamp("lamp", 1), lamp("lamp", 1)],
        vec![lamp("lamp", 1), lamp("ceiling", 0)],
        vec![lamp("ceiling", 0), lamp("lamp", 1)],
    ] {
        assert_eq!(lit(lamps), once);
    }
}
