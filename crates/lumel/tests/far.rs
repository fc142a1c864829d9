//! The same light wherever a scene stands, however it is turned and whatever its size.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use glam::{DQuat, DVec3, EulerRot};
use lumel::{
    Bake, Baker, BounceLimit, Control, EmitterSampling, MaxEdge, OpenOptions, PointReceivers, Projection,
    SceneBuilder, Settings, Silent, Solution, SolveState, Tail,
};
use lumel_scene::{Radiance, SceneError, Sides, TriId, origin_for};
use std::f32::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

const OFFSETS: [f64; 5] = [0.0, 1e2, 1e3, 1e4, 1e5];

const PROJECTIONS: [Projection; 3] = [Projection::Point, Projection::Area, Projection::LeastSquares];

/// Not at all, and about all three axes.
fn turns() -> [DQuat; 2] {
    [DQuat::IDENTITY, DQuat::from_euler(EulerRot::XYZ, 0.4, 0.7, 1.1)]
}

/// A box from inside as an OBJ file, its faces in material `name`.
fn room(name: &str, half: DVec3, place: impl Fn(DVec3) -> DVec3) -> String {
    let mut text = format!("o {name}\nusemtl {name}\n");
    for k in 0..8 {
        let sign = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let DVec3 { x, y, z } = place(half * DVec3::new(sign(2), sign(1), sign(0)));
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
        writeln!(text, "f {} {} {} {}", a - 9, b - 9, c - 9, d - 9).unwrap();
    }
    text
}

/// What a file with these objects holds; the material `glow` emits a radiance of 1, and all have an albedo of 1/2.
fn opened(objects: &str, max_edge: Option<f64>) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("a.obj");
    std::fs::write(&path, format!("mtllib a.mtl\n{objects}")).unwrap();
    let materials = "newmtl glow\nKd 0.5 0.5 0.5\nKe 1 1 1\nnewmtl grey\nKd 0.5 0.5 0.5\n";
    std::fs::write(folder.path().join("a.mtl"), materials).unwrap();
    let options = OpenOptions {
        max_edge: Some(max_edge.map_or(MaxEdge::Off, |edge| MaxEdge::Length(edge as f32))),
        ..OpenOptions::default()
    };
    let opened = lumel::open(&path, &options).unwrap();
    assert!(opened.warnings.is_empty(), "{:?}", opened.warnings);
    opened.builder
}

/// All light at the vertices, W·m⁻². Rays find emitters: in a furnace they leave no variance.
fn baked(builder: SceneBuilder, projection: Projection, bounces: BounceLimit) -> (Baker, Vec<f32>) {
    let emitters = EmitterSampling::Rays;
    let tail = Tail::Geometric;
    baked_with(
        builder,
        Settings { projection, bounces, emitters, tail, indirect_samples: 32, ..Settings::default() },
    )
}

fn baked_with(builder: SceneBuilder, settings: Settings) -> (Baker, Vec<f32>) {
    let (scene, warnings) = builder.build().unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let baker = Baker::new(Arc::new(scene), settings);
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let light = baker.light_at_vertices(&state).iter().map(|e| e.x).collect();
    (baker, light)
}

/// Checks that the walls of a closed box that glows see nothing but walls that glow.
fn assert_glows(what: &str, light: &[f32]) {
    for (vertex, e) in light.iter().enumerate() {
        // A closed furnace: π Lₑ / (1 − ρ) without any variance, all of its bounces but a geometric tail.
        assert!((e / TAU - 1.0).abs() < 1e-3, "{what}, vertex {vertex}: {e}");
    }
}

#[test]
fn a_glowing_box_and_a_closed_room_are_the_same_anywhere() {
    for (n, turn) in turns().into_iter().enumerate() {
        for scale in [1e-3, 1.0, 1e3] {
            for offset in OFFSETS {
                let what = format!("turn {n}, scale {scale}, {offset} m away");
                let place = |p: DVec3| turn * (p * scale) + offset * DVec3::new(1.0, -0.9, 1.1);
                for projection in PROJECTIONS {
                    let what = format!("{what}, {projection:?}");
                    let glowing = opened(&room("glow", DVec3::ONE, place), Some(scale));
                    assert_glows(&what, &baked(glowing, projection, BounceLimit::All).1);
                    let mut closed = opened(&room("grey", DVec3::ONE, place), Some(scale));
                    closed.sky = lumel::Sky::Uniform(Radiance::splat(1.0));
                    let (_, light) = baked(closed, projection, BounceLimit::Count(0));
                    assert!(light.iter().all(|e| *e == 0.0), "{what}: the sky leaks in");
                }
            }
        }
    }
}

#[test]
fn thin_boxes_boxes_far_along_one_axis_and_boxes_of_kilometres_glow_alike() {
    let thin = DVec3::new(0.5, 5e-5, 0.5);
    let cases = [
        ("0.1 mm thick", thin, DVec3::new(0.3, 0.2, 0.1), 0.5),
        ("0.1 mm thick, a kilometre away", thin, DVec3::new(1e3, 0.2, 0.1), 0.5),
        ("50 km away along one axis", DVec3::ONE, DVec3::Y * 5e4, 1.0),
        ("10 km wide", DVec3::splat(5e3), DVec3::ONE, 5e3),
        ("just not far", DVec3::ONE, DVec3::X * 13.8, 1.0),
    ];
    for (n, turn) in turns().into_iter().enumerate() {
        for (what, half, shift, max_edge) in cases {
            for projection in PROJECTIONS {
                let builder = opened(&room("glow", half, |p| turn * p + shift), Some(max_edge));
                let (_, light) = baked(builder, projection, BounceLimit::All);
                assert_glows(&format!("{what}, turn {n}, {projection:?}"), &light);
            }
        }
    }
}

#[test]
fn a_small_box_in_a_large_landscape_glows_as_one_alone() {
    let land =
        "o land\nusemtl grey\nv -500 -9 -500\nv 500 -9 -500\nv 500 -9 500\nv -500 -9 500\nf -4 -1 -2 -3\n";
    let in_box = |(baker, light): (Baker, Vec<f32>)| -> Vec<f32> {
        let scene = baker.scene();
        let emissive =
            (0..scene.triangle_count() as u32).map(TriId).filter(|&tri| scene.material(tri).emits());
        emissive.flat_map(|tri| scene.triangle(tri)).map(|vertex| light[vertex as usize]).collect()
    };
    for (n, turn) in turns().into_iter().enumerate() {
        let place = |p: DVec3| turn * p + DVec3::new(437.3, 2.1, -312.7);
        let builder = opened(&format!("{land}{}", room("glow", DVec3::splat(0.005), place)), None);
        for projection in PROJECTIONS {
            let light = in_box(baked(builder.clone(), projection, BounceLimit::All));
            assert_eq!(light.len(), 36);
            assert_glows(&format!("turn {n}, {projection:?}"), &light);
        }
        let (projection, bounces) = (Projection::Point, BounceLimit::Count(0));
        let emitters = EmitterSampling::Lights;
        let light =
            in_box(baked_with(builder, Settings { projection, bounces, emitters, ..Settings::default() }));
        let mean = light.iter().sum::<f32>() / light.len() as f32;
        // Shadow rays to a dozen triangles vary by a tenth at each of eight corners, which have three nodes each.
        assert!((mean / (0.5 * TAU) - 1.0).abs() < 0.06, "turn {n}: {mean} from walls as lights");
    }
}

#[test]
fn two_sheets_a_ten_thousandth_of_the_scene_apart_stay_apart() {
    for turn in turns() {
        for offset in OFFSETS {
            let place =
                |x: f64, y: f64, z: f64| turn * DVec3::new(x, y, z) + offset * DVec3::new(1.0, 0.9, 1.1);
            let mut text = String::new();
            // Both face up; the upper one is wider and leaves the lower one in the dark.
            for (half, height) in [(0.5, 0.0), (0.6, 1e-4)] {
                text += "o sheet\nusemtl grey\n";
                for (x, z) in [(-half, -half), (-half, half), (half, half), (half, -half)] {
                    let DVec3 { x, y, z } = place(x, height, z);
                    writeln!(text, "v {x} {y} {z}").unwrap();
                }
                text += "f -4 -3 -2 -1\n";
            }
            for projection in PROJECTIONS {
                let mut builder = opened(&text, None);
                builder.sky = lumel::Sky::Uniform(Radiance::splat(1.0));
                builder.materials.iter_mut().for_each(|material| material.sides = Sides::Both);
                let (_, light) = baked(builder, projection, BounceLimit::Count(0));
                let [inside, outside] = [&light[..4], &light[4..12]];
                assert!(inside.iter().all(|e| *e < 1e-3), "{offset} m, {projection:?}: {inside:?}");
                let sky = TAU / 2.0;
                assert!(
                    outside.iter().all(|e| (e / sky - 1.0).abs() < 1e-3),
                    "{offset} m, {projection:?}: {outside:?}"
                );
            }
        }
    }
}

/// The scene elsewhere, as an importer places it: in double precision.
fn placed(mut builder: SceneBuilder, turn: DQuat, shift: DVec3) -> SceneBuilder {
    let place = |p: glam::Vec3| turn * p.as_dvec3() + shift;
    builder.origin = origin_for(builder.objects.iter().flat_map(|o| &o.positions).map(|p| place(*p)));
    let origin = builder.origin;
    let turn_only = |v: glam::Vec3| (turn * v.as_dvec3()).as_vec3();
    for position in builder.objects.iter_mut().flat_map(|o| &mut o.positions) {
        *position = (place(*position) - origin).as_vec3();
    }
    for light in &mut builder.lights {
        if let lumel::Light::Rect(rect) = light {
            rect.center = (place(rect.center) - origin).as_vec3();
            (rect.u, rect.v) = (turn_only(rect.u), turn_only(rect.v));
        }
    }
    builder
}

#[test]
fn the_cornell_box_has_the_same_light_anywhere() {
    let cornell = || lumel::open("cornell-box", &OpenOptions::default()).unwrap().builder;
    let mean = |builder: SceneBuilder, projection| {
        let (_, light) = baked(builder, projection, BounceLimit::Count(1));
        light.iter().map(|e| f64::from(*e)).sum::<f64>() / light.len() as f64
    };
    for projection in [Projection::Point, Projection::LeastSquares] {
        let here = mean(cornell(), projection);
        for (n, turn) in turns().into_iter().enumerate() {
            // Moved, the samples are the same. Turned, they are others: with 32 rays, another seed changes the mean by 0.35 %,
            // of which this is three standard deviations of a difference.
            let allowed = if n == 0 { 1e-4 } else { 0.015 };
            for offset in [1e3, 1e5] {
                let there = mean(placed(cornell(), turn, DVec3::new(1.0, 1.1, -0.9) * offset), projection);
                let what = format!("turn {n}, {projection:?}, {offset} m");
                assert!((there / here - 1.0).abs() < allowed, "{what}: {there} for {here}");
            }
        }
    }
}

#[test]
fn what_numbers_cannot_hold_is_refused_or_doubted_by_name() {
    // Single precision resolves 8 mm here: enough for a room of metres, doubtful for one of decimetres, and hopeless for
    // one of centimetres.
    let room = |half: f32| {
        let mut builder = opened(&room("grey", DVec3::ONE, |p| p), None);
        let place = |p: &mut glam::Vec3| *p = *p * half + 1e5;
        builder.objects.iter_mut().flat_map(|object| &mut object.positions).for_each(place);
        builder.build()
    };
    let (scene, warnings) = room(1.0).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert!((scene.origin() - 1e5).length() < 10.0);
    let (_, warnings) = room(0.05).unwrap();
    let text = warnings.iter().next().unwrap().to_string();
    for part in ["object \"grey\"", "6.0e-3 m", "doubtful", "near the origin"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let refused = room(0.006).unwrap_err();
    assert!(matches!(&refused, SceneError::Unresolved { object, .. } if object == "grey"), "{refused}");
    for part in ["object \"grey\"", "near the origin"] {
        assert!(refused.to_string().contains(part), "{part} in {refused}");
    }
}

#[test]
fn files_and_points_are_in_world_space() {
    let turn = turns()[1];
    let place = |p: DVec3| turn * p + DVec3::new(1e5, 2e4, -3e5) + 0.3;
    let baked = Bake::new(opened(&room("glow", DVec3::ONE, place), None)).all_bounces().run().unwrap();
    let (scene, folder) = (Arc::clone(baked.baker().scene()), tempfile::tempdir().unwrap());
    assert!(scene.positions().iter().all(|p| p.length() < 10.0), "the scene is near its origin");
    let is_corner = |world: DVec3| {
        let corner = turn.inverse() * (world - place(DVec3::ZERO));
        (corner.abs() - 1.0).abs().max_element() < 1e-6
    };
    for name in ["a.obj", "a.ply", "a.glb"] {
        let path = folder.path().join(name);
        baked.save(&path).unwrap();
        let as_it_is = OpenOptions { max_edge: Some(MaxEdge::Off), ..OpenOptions::default() };
        let again = lumel::open(&path, &as_it_is).unwrap().builder;
        let again = again.build().unwrap().0;
        assert!(again.world_positions().all(is_corner), "{name}");
    }
    baked.solution().save(&folder.path().join("a.npz")).unwrap();
    let solution = Solution::load(&folder.path().join("a.npz")).unwrap();
    assert!(solution.positions.iter().all(|position| is_corner(*position)));
    assert_eq!(solution.positions, scene.world_positions().collect::<Vec<_>>());
    // Inside of a furnace, light is the same in all directions.
    let inside = PointReceivers::new(&scene, [(place(DVec3::splat(0.5)), glam::Vec3::Y)]).unwrap();
    assert_glows("a point inside", &[baked.measure(&inside).unwrap().irradiance[0].x]);
}

#[test]
fn lights_and_views_of_projects_are_in_world_space() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.obj"), room("grey", DVec3::ONE, |p| p + 1e6)).unwrap();
    let path = folder.path().join("a.lumel.toml");
    let text = "scene = \"a.obj\"\n\n[[light]]\ncenter = [1000000.0, 1000000.99, 1000000.1]\nu = [0.1, 0.0, 0.0]\n\
                v = [0.0, 0.0, 0.1]\nradiance = [1.0, 1.0, 1.0]\n\n[[camera]]\nname = \"door\"\n\
                position = [1000000.0, 1000000.0, 1000000.9]\ntarget = [1000000.0, 1000000.0, 999999.0]\n\
                up = [0.0, 1.0, 0.0]\nfov_deg = 60.0\n";
    std::fs::write(&path, text).unwrap();
    let opened = lumel::open(&path, &OpenOptions::default()).unwrap();
    let origin = opened.builder.origin;
    let lumel::Light::Rect(light) = opened.builder.lights[0] else { panic!("another light") };
    let expected = (DVec3::new(1e6, 1_000_000.99, 1_000_000.1) - origin).as_vec3();
    assert!((light.center - expected).length() < 1e-6, "{} for {expected}", light.center);
    let camera = &opened.builder.cameras[0];
    assert!((camera.forward - glam::Vec3::new(0.0, 0.0, -1.9)).length() < 1e-6);
    let copy = folder.path().join("b.lumel.toml");
    opened.project.unwrap().moved(origin).write(&copy).unwrap();
    let again = lumel::open(&copy, &OpenOptions::default()).unwrap();
    assert_eq!(again.builder.lights, opened.builder.lights);
}
