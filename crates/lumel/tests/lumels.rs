//! Light on the lumels of an atlas against known answers, wherever a scene lies.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use glam::{EulerRot, Quat, Vec3};
use lumel::{
    AmbientOcclusion, Baker, BounceLimit, Checkpoint, Control, Lightmap, LightmapLayer, LumelLight,
    LumelParts, LumelState, Lumels, Memory, OpenOptions, PointReceivers, Projection, Saved, Scene,
    SceneBuilder, Settings, Silent, SolveState, Tail, TargetError, measure_points,
};
use lumel_scene::{Light, PointLight, Radiance, RectLight, Sky};
use lumel_testkit::mesh::{Facing, cuboid, quad, sphere};
use lumel_testkit::scene::{grey, placed, reordered, scene};
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use std::f32::consts::PI;
use std::sync::Arc;

fn settings() -> Settings {
    Settings { bounces: BounceLimit::All, direct_samples: 64, indirect_samples: 64, ..Settings::default() }
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn lumels(scene: &Arc<Scene>, per_metre: f32) -> Lumels {
    let settings = UnwrapSettings { density: Density::PerMetre(per_metre), ..UnwrapSettings::default() };
    Lumels::new(Arc::clone(scene), unwrap(scene, &settings, &|| Pace::Go).unwrap().atlas)
}

/// Light at the lumels of a scene as given that is carried on the vertices of its tessellation.
fn measured(
    builder: &SceneBuilder,
    max_edge: f32,
    per_metre: f32,
    settings: Settings,
) -> (Lumels, LumelLight) {
    let lumels = lumels(&built(builder.clone()), per_metre);
    let mut fine = builder.clone();
    fine.tessellate(max_edge).unwrap();
    let (baker, mut state) = (Baker::new(built(fine), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    (lumels, light)
}

fn irradiance(light: &LumelLight) -> impl Iterator<Item = Vec3> {
    (0..light.len()).map(|lumel| light.irradiance(lumel))
}

fn placements(builder: &SceneBuilder) -> [(&'static str, SceneBuilder); 3] {
    let (turn, shift) = (Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3), Vec3::new(300.0, -140.0, 80.0));
    [
        ("as given", builder.clone()),
        ("reordered", reordered(builder.clone())),
        ("turned and moved", placed(builder.clone(), turn, shift)),
    ]
}

#[test]
fn in_closed_rooms_every_lumel_has_the_known_light() {
    for (name, per_metre) in [("furnace", 20.0), ("sphere", 12.0)] {
        let builder = lumel::open(name, &OpenOptions::default()).unwrap().builder;
        for (place, builder) in placements(&builder) {
            let (_, light) =
                measured(&builder, 10.0, per_metre, Settings { tail: Tail::Geometric, ..settings() });
            assert!((0..light.len()).all(|lumel| light.is_valid(lumel)), "{name}, {place}");
            let off = irradiance(&light).map(|e| (e / 2.0 - 1.0).abs().max_element()).fold(0.0, f32::max);
            // The sphere is a polyhedron that is lit unevenly: rays have noise there.
            let most = if name == "furnace" { 0.002 } else { 0.2 };
            assert!(off < most, "{name}, {place}: {off}");
            let mean = irradiance(&light).map(|e| e.x).sum::<f32>() / light.len() as f32;
            assert!((mean / 2.0 - 1.0).abs() < 0.006, "{name}, {place}: {mean}");
        }
    }
}

/// A room of twelve triangles with a lamp and a block that stands on its floor.
fn room() -> SceneBuilder {
    let mut meshes = cuboid(Vec3::ZERO, Vec3::new(3.0, 2.0, 3.0), 1, Facing::Inward, [0; 6]);
    meshes.extend(cuboid(Vec3::new(0.7, 0.0, 0.8), Vec3::new(1.4, 1.1, 1.7), 1, Facing::Outward, [0; 6]));
    let (u, v) = (Vec3::X * 0.3, Vec3::Z * 0.3);
    let lamp = RectLight {
        center: Vec3::new(1.9, 1.999, 1.4),
        u,
        v,
        radiance: Radiance::splat(20.0),
        texture: None,
    };
    scene(meshes, vec![grey(0.6, 0.0)], vec![lamp.into()])
}

#[test]
fn lumels_of_a_coarse_room_have_the_light_that_is_measured_at_their_middles() {
    for (place, builder) in placements(&room()) {
        let settings = Settings { direct_samples: 32, indirect_samples: 128, ..settings() };
        let (lumels, light) = measured(&builder, 0.12, 12.0, settings.clone());
        let mut fine = builder.clone();
        fine.tessellate(0.12).unwrap();
        let (baker, mut state) = (Baker::new(built(fine), settings), SolveState::new());
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let area = |place: usize| lumels.coverage.shares(place).iter().map(|share| share.area).sum::<f32>();
        let whole = |&place: &usize| light.is_valid(place) && area(place) > 0.999;
        let chosen: Vec<usize> = (0..lumels.coverage.len()).filter(whole).step_by(29).collect();
        let middle = |&place: &usize| {
            let (_, [x, y]) = lumels.atlas.column_and_row(lumels.coverage.lumels()[place] as usize);
            let tri = lumels.coverage.shares(place)[0].tri;
            let piece = lumel_uv::Piece::new(&lumels.atlas, tri, [x, y]).unwrap();
            let (at, _) = piece.at([f64::from(x) + 0.5, f64::from(y) + 0.5].into());
            (at, lumels.scene.geometric_normal(tri))
        };
        let points = PointReceivers::on_surfaces(&lumels.scene, chosen.iter().map(middle)).unwrap();
        let expected = measure_points(&baker, &state, &points, &Control::default()).unwrap();
        let found: Vec<f32> = chosen.iter().map(|&place| light.irradiance(place).x).collect();
        let expected: Vec<f32> = expected.irradiance.iter().map(|e| e.x).collect();
        assert!(found.len() > 150);
        let sum = |values: &[f32]| values.iter().sum::<f32>();
        assert!(
            (sum(&found) / sum(&expected) - 1.0).abs() < 0.01,
            "{place}: {} {}",
            sum(&found),
            sum(&expected)
        );
        // Both have a noise of 2 %, and at the edges of shadows the mean over a lumel is not the light in its middle.
        let mut errors: Vec<f32> = found.iter().zip(&expected).map(|(f, e)| (f / e - 1.0).abs()).collect();
        errors.sort_by(f32::total_cmp);
        let [middle, most] = [errors.len() / 2, errors.len() * 9 / 10].map(|i| errors[i]);
        assert!(middle < 0.02 && most < 0.06, "{place}: {middle} {most}");
    }
}

#[test]
fn no_light_from_outside_reaches_the_lumels_of_a_closed_box() {
    for (place, builder) in placements(&scene(
        cuboid(Vec3::splat(-1.0), Vec3::splat(1.0), 1, Facing::Inward, [0; 6]),
        vec![grey(0.5, 0.0)],
        vec![Light::Point(PointLight {
            position: Vec3::new(0.0, 3.0, 0.0),
            intensity: Vec3::splat(100.0),
            range: f32::INFINITY,
        })],
    )) {
        let lit = SceneBuilder { sky: Sky::Uniform(Radiance::splat(5.0)), ..builder };
        let (_, light) = measured(&lit, 0.3, 14.0, settings());
        assert!((0..light.len()).all(|lumel| light.is_valid(lumel)), "{place}");
        let brightest = irradiance(&light).map(|e| e.max_element()).fold(0.0, f32::max);
        assert_eq!(brightest, 0.0, "{place}");
    }
}

#[test]
fn under_an_even_sky_coarse_balls_are_lit_as_smooth_ones_and_floors_without_end() {
    let ball = sphere(Vec3::ZERO, 1.0, 1, Facing::Outward, 0);
    let builder = SceneBuilder {
        sky: Sky::Uniform(Radiance::splat(1.0)),
        ..scene(vec![ball], vec![grey(0.5, 0.0)], vec![])
    };
    for (place, builder) in placements(&builder) {
        let direct = Settings { bounces: BounceLimit::Count(0), ..settings() };
        let (_, light) = measured(&builder, 0.5, 8.0, direct);
        for (lumel, e) in irradiance(&light).enumerate() {
            assert!((e.x / PI - 1.0).abs() < 0.02, "{place}: {lumel}: {e}");
        }
    }
}

#[test]
fn what_lies_under_a_block_is_no_light_of_the_floor() {
    let floor =
        quad([[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z)), [1; 2], 0);
    let mut meshes = vec![floor];
    meshes.extend(cuboid(Vec3::new(0.5, -0.2, 0.5), Vec3::new(1.5, 0.6, 1.5), 1, Facing::Outward, [0; 6]));
    let builder = SceneBuilder {
        sky: Sky::Uniform(Radiance::splat(1.0)),
        ..scene(meshes, vec![grey(0.5, 0.0)], vec![])
    };
    let (lumels, light) = measured(&builder, 0.1, 16.0, settings());
    let mut n_hidden = 0;
    for (place, e) in irradiance(&light).enumerate() {
        let valid = light.is_valid(place);
        let share = lumels.coverage.shares(place)[0];
        if lumels.scene.object_id(share.tri).index() != 0 {
            continue;
        }
        // Next to the block, light is still a good part of that of the open sky.
        n_hidden += usize::from(!valid);
        assert!(!valid || e.x > 0.3 * PI, "{place}: {e}");
    }
    // A square of 16 x 16 lumels, but for those at its rim.
    assert!((14 * 14..=18 * 18).contains(&n_hidden), "{n_hidden}");
}

#[test]
fn lumels_have_the_same_bits_on_any_number_of_threads_and_in_any_memory() {
    let in_memory = |memory: u64, n_threads| {
        let settings =
            Settings { memory: Memory(memory), direct_samples: 8, indirect_samples: 16, ..settings() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| {
            let lumels = lumels(&built(room()), 8.0);
            let mut fine = room();
            fine.tessellate(0.3).unwrap();
            let baker = Baker::new(built(fine), Settings { memory: Memory(1 << 30), ..settings.clone() });
            let mut state = SolveState::new();
            baker.run(&mut state, &Control::default(), &Silent).unwrap();
            let baker = baker.relit(Arc::clone(baker.scene()), settings);
            baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap()
        })
    };
    let whole = in_memory(1 << 30, 2);
    assert!(whole == in_memory(1 << 30, 1));
    assert!(whole == in_memory(100_000, 2), "in parts");
}

#[test]
fn stopped_lumels_continue_from_their_checkpoint_with_the_same_bits() {
    let settings = Settings { memory: Memory(40_000), direct_samples: 8, indirect_samples: 16, ..settings() };
    let lumels = lumels(&built(room()), 8.0);
    let mut fine = room();
    fine.tessellate(0.3).unwrap();
    let (baker, mut state) = (Baker::new(built(fine), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let whole = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    let (folder, identity) = (tempfile::tempdir().unwrap(), lumels.identity().to_string());
    let path = folder.path().join("a.checkpoint.npz");
    let (mut light, mut n_stops) = (baker.no_light_at_lumels(&state, &lumels), 0);
    loop {
        // Every third part, as if the program had been killed and started again.
        let (control, mut n_parts) = (Control::default(), 0);
        let continued = baker.continue_lumels(&state, &lumels, &mut light, &control, &mut |light| {
            n_parts += 1;
            if n_parts == 3 {
                let saved = LumelState { identity: &identity, light };
                baker.checkpoint(&state).save_with(Some(saved), &path).unwrap();
                control.cancel();
            }
        });
        if continued.is_ok() {
            break;
        }
        n_stops += 1;
        assert_eq!(Checkpoint::load_lumels(&path, "lumels of another atlas").unwrap(), None);
        light = Checkpoint::load_lumels(&path, &identity).unwrap().unwrap();
        assert!(matches!(Saved::load(&path), Ok(Saved::Checkpoint(_))));
    }
    assert!(n_stops > 1 && light == whole, "{n_stops} stops");
}

#[test]
fn more_samples_go_where_light_is_noisy_until_a_target_is_reached() {
    let (lumels, plain) = measured(&room(), 0.3, 12.0, settings());
    let samples = |light: &LumelLight| light.halves[0].samples.clone();
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    let (few, most) = (mean(&samples(&plain)), samples(&plain).into_iter().fold(0.0, f32::max));
    assert!((1.6..2.4).contains(&few) && most == 4.0, "{few} {most}");
    let mut fine = room();
    fine.tessellate(0.3).unwrap();
    let fine = built(fine);
    let (baker, mut state) = (Baker::new(Arc::clone(&fine), settings()), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let aiming = |error: &str| {
        let target_error = TargetError::At(error.parse().unwrap());
        let baker = baker.relit(Arc::clone(&fine), Settings { target_error, ..settings() });
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        (baker.accuracy_at_lumels(&lumels, &light), light)
    };
    let (accuracy, light) = aiming("4%");
    assert!(accuracy.share.unwrap() >= 0.95 && accuracy.percentile_95 <= 0.04, "{accuracy:?}");
    // What the halves say is no less than what many more samples show.
    let (_, reference) = aiming("1%");
    let floor = 0.1 * mean(&irradiance(&reference).map(|e| e.x).collect::<Vec<f32>>());
    let off = |(a, b): (Vec3, Vec3)| ((a.x - b.x) / b.x.max(floor)).abs();
    let mut errors: Vec<f32> = irradiance(&light).zip(irradiance(&reference)).map(off).collect();
    errors.sort_by(f32::total_cmp);
    let [median, worst] = [0.5, 0.95].map(|share| errors[(share * errors.len() as f32) as usize]);
    println!("median {median}, 95 % below {worst}");
    assert!(worst < 0.04 && median > 0.001, "{median} {worst}");
}

#[test]
fn within_a_ball_the_surroundings_are_as_open_as_they_should_be() {
    // A ray at an angle of cosine c ends 2 c away: over the hemisphere, c is 2/3 on average, and c² 1/2.
    let ball = sphere(Vec3::ZERO, 1.0, 3, Facing::Inward, 0);
    let builder = scene(vec![ball], vec![grey(0.5, 0.0)], vec![]);
    for (place, builder) in placements(&builder) {
        let scene = built(builder);
        let lumels = lumels(&scene, 6.0);
        for projection in [Projection::Point, Projection::LeastSquares] {
            let settings = Settings { bounces: BounceLimit::Count(0), projection, ..settings() };
            let (baker, mut state) = (Baker::new(Arc::clone(&scene), settings), SolveState::new());
            baker.run(&mut state, &Control::default(), &Silent).unwrap();
            for (distance, falloff, expected) in
                [(2.0, 1.0, 2.0 / 3.0), (2.0, 2.0, 5.0 / 6.0), (0.01, 0.0, 1.0), (f32::INFINITY, 1.0, 0.0)]
            {
                let (occlusion, control) = (AmbientOcclusion { distance, falloff }, Control::default());
                let at_vertices = baker.openness_at_vertices(occlusion, &state, &control).unwrap();
                let at_lumels = baker.openness_at_lumels(occlusion, &lumels, &control).unwrap();
                let at_lumels = at_lumels.sources[0].iter().map(|share| share.x).collect();
                for shares in [at_vertices, at_lumels] {
                    let mean = shares.iter().sum::<f32>() / shares.len() as f32;
                    // The ball is a polyhedron, a few parts in a thousand smaller.
                    assert!((mean - expected).abs() < 0.01, "{place}, {projection:?}, {occlusion:?}: {mean}");
                    let off = shares.iter().map(|share| (share - expected).abs()).fold(0.0, f32::max);
                    assert!(off < 0.1, "{place}, {projection:?}, {occlusion:?}: {off}");
                }
            }
        }
    }
}

#[test]
fn the_noise_of_openness_is_taken_off_as_that_of_light() {
    let ball = sphere(Vec3::ZERO, 1.0, 3, Facing::Inward, 0);
    let scene = built(scene(vec![ball], vec![grey(0.5, 0.0)], vec![]));
    let lumels = lumels(&scene, 12.0);
    let Lumels { scene, atlas, coverage } = &lumels;
    let settings = Settings { indirect_samples: 16, ..settings() };
    let baker = Baker::new(Arc::clone(scene), settings);
    let occlusion = AmbientOcclusion { distance: 2.0, falloff: 1.0 };
    let openness = baker.openness_at_lumels(occlusion, &lumels, &Control::default()).unwrap();
    let [noisy, calm] = [false, true].map(|denoises| {
        let lightmap = Lightmap::finished(scene, atlas, coverage, &openness, denoises, Some(&openness));
        let layer = lightmap.layers.iter().find(|layer| layer.name == LightmapLayer::OCCLUSION).unwrap();
        let off = |lumel: &u32| (layer.values[*lumel as usize].x - 2.0 / 3.0).powi(2);
        (coverage.lumels().iter().map(off).sum::<f32>() / coverage.len() as f32).sqrt()
    });
    println!("off by {noisy}, without noise by {calm}");
    assert!(noisy > 0.02 && calm < 0.5 * noisy, "{noisy} {calm}");
}

#[test]
fn rays_that_are_kept_measure_other_light_with_the_same_bits() {
    let scene = built(room());
    let lumels = lumels(&scene, 9.0);
    let settings =
        Settings { bounces: BounceLimit::Count(2), direct_samples: 8, indirect_samples: 64, ..settings() };
    let baker = Baker::new(Arc::clone(&scene), settings.clone());
    let (mut parts, mut few) = (LumelParts::default(), LumelParts::default());
    (parts.most, parts.kept_bytes) = (200, 1 << 30);
    few.kept_bytes = 1000;
    let mut saved = Vec::new();
    for shift in [0.0, 0.1] {
        let moved = |light: &Light| match *light {
            Light::Rect(rect) => Light::Rect(RectLight { center: rect.center + Vec3::X * shift, ..rect }),
            light => light,
        };
        let relit = Arc::new(scene.relit(scene.lights().iter().map(moved).collect()).unwrap());
        let (baker, mut state) = (baker.relit(relit, settings.clone()), SolveState::new());
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let whole = Control::default();
        let expected = baker.light_at_lumels(&state, &lumels, &whole).unwrap();
        for parts in [&mut parts, &mut few] {
            let (control, mut light) = (Control::default(), baker.no_light_at_lumels(&state, &lumels));
            baker.continue_lumel_parts(&state, &lumels, &mut light, parts, &control, &mut |_| {}).unwrap();
            assert!(light == expected, "{shift}");
            saved.push(whole.rays() - control.rays());
        }
    }
    // A ray takes 8 bytes, and every lumel has some.
    let kept = parts.bytes() / 8;
    assert!(saved[..2] == [0, 0] && saved[3] == 0 && few.bytes() == 0, "{saved:?}");
    assert!(saved[2] >= kept && kept > 8 * lumels.coverage.len() as u64, "{saved:?} {kept}");
}
