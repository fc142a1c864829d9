//! Light through surfaces, against known answers.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use glam::{Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Control, EmitterSampling, Light, Material, Projection, SceneBuilder, SeeThrough,
    Settings, Silent, SolveState, SolverKind, Tail, measure_points,
};
use lumel_accel::InstructionSet;
use lumel_basis::PointReceivers;
use lumel_scene::{
    AlphaMode, Encoding, ObjectMesh, PointLight, Radiance, RectLight, Texture, TextureId, TextureRef,
    Transparency, TriId,
};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{grey, scene, two_sided};
use std::sync::Arc;

/// Under the lamp, from its form factor.
const UNDER_LAMP: f32 = 2.308_37;

fn settings(bounces: u32) -> Settings {
    Settings {
        bounces: BounceLimit::Count(bounces),
        direct_samples: 256,
        indirect_samples: 1024,
        tail: Tail::Off,
        ..Settings::default()
    }
}

/// A square of two triangles that share a diagonal, facing +y.
fn card(y: f32, half: f32, material: u32) -> ObjectMesh {
    let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    quad(corners.map(|[x, z]| Vec3::new(x * half, y, z * half)), [1, 1], material)
}

fn with(transparency: Transparency) -> Material {
    Material { transparency, ..two_sided(grey(0.0, 0.0)) }
}

/// One square metre of radiance 10, 2 m above the floor.
fn lamp() -> RectLight {
    RectLight::new([0.0, 2.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [10.0; 3])
}

/// Cards of this material over a floor, without light.
fn over_floor(cards: Vec<ObjectMesh>, material: Material) -> SceneBuilder {
    // Wide enough for a square of a metre to be little of all surfaces.
    let floor = card(0.0, 3.0, 0);
    scene([vec![floor], cards].concat(), vec![grey(0.5, 0.0), material], vec![])
}

/// The irradiance in the middle of the floor.
fn in_the_middle(builder: SceneBuilder, settings: Settings) -> Vec3 {
    let scene = Arc::new(builder.build().unwrap().0);
    let points = PointReceivers::new(&scene, [(Vec3::ZERO, Vec3::Y)]).unwrap();
    let (baker, mut state) = (Baker::new(scene, settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    measure_points(&baker, &state, &points, &Control::default()).unwrap().irradiance[0]
}

/// The share of light that cards let through to the middle of the floor, by every kind of light.
#[track_caller]
fn assert_passes(name: &str, builder: &SceneBuilder, expected: Vec3) {
    let lit = |light: Light| SceneBuilder { lights: vec![light], ..builder.clone() };
    let mut emissive = builder.clone();
    let mut square = card(2.0, 0.5, emissive.materials.len() as u32);
    square.faces.iter_mut().for_each(|face| face.vertices.swap(0, 1));
    emissive.objects.push(square);
    emissive.materials.push(Material { emission: Radiance::splat(10.0), ..grey(0.0, 0.0) });
    let bulb = PointLight { position: Vec3::Y * 2.0, intensity: Vec3::splat(4.0), range: f32::INFINITY };
    for (light, builder, unblocked, tolerance) in [
        ("rectangle", lit(Light::Rect(lamp())), UNDER_LAMP, 1e-3),
        // Rays start a little above the floor.
        ("bulb", lit(Light::Point(bulb)), 1.0, 1e-4),
        ("emissive square", emissive, UNDER_LAMP, 1e-3),
    ] {
        let share = in_the_middle(builder, settings(0)) / unblocked;
        assert!((share - expected).abs().max_element() < tolerance, "{name}, {light}: {share}");
    }
}

#[test]
fn cards_let_through_what_their_alpha_leaves() {
    let half = || with(Transparency::blend(0.5));
    let share = Vec3::splat;
    assert_passes("one card", &over_floor(vec![card(1.0, 1.0, 1)], half()), share(0.5));
    let two = vec![card(1.0, 1.0, 1), card(0.5, 1.0, 1)];
    assert_passes("two in a row", &over_floor(two, half()), share(0.25));
    assert_passes("given twice", &over_floor(vec![card(1.0, 1.0, 1); 2], half()), share(0.5));
    let mut turned = card(0.0, 1.5, 1);
    let turn = |p: &mut Vec3| *p = Quat::from_rotation_x(0.6) * *p + Vec3::Y;
    turned.positions.iter_mut().for_each(turn);
    assert_passes("turned", &over_floor(vec![turned], half()), share(0.5));
    let mut by_vertex = card(1.0, 1.0, 1);
    by_vertex.alphas = vec![0.25; 4];
    assert_passes("at vertices", &over_floor(vec![by_vertex], with(Transparency::blend(1.0))), share(0.75));
    let one_sided = Material { sides: lumel_scene::Sides::Front, ..half() };
    assert_passes("one side", &over_floor(vec![card(1.0, 1.0, 1)], one_sided), share(0.5));
    let glass = Transparency { transmission: Vec3::new(0.9, 0.5, 0.0), ..Transparency::default() };
    assert_passes("glass", &over_floor(vec![card(1.0, 1.0, 1)], with(glass)), glass.transmission);
    assert_passes("below the cutoff", &over_floor(vec![card(1.0, 1.0, 1)], with(mask(0.4))), share(1.0));
}

#[test]
fn a_mask_of_half_the_texels_passes_half() {
    let texels = (0..64 * 64).map(|i| [0, 0, 0, if (i + i / 64) % 2 == 0 { 255 } else { 0 }]).collect();
    let mask = Transparency {
        mode: AlphaMode::Mask { cutoff: 0.5 },
        texture: Some(TextureRef::plain(TextureId(0))),
        ..Transparency::default()
    };
    let mut builder = over_floor(vec![card(1.0, 1.0, 1)], with(mask));
    builder.textures = vec![Texture::from_bytes("checker", 64, 64, texels, Encoding::Srgb).unwrap()];
    builder.lights = vec![Light::Rect(lamp())];
    let share = in_the_middle(builder, settings(0)) / UNDER_LAMP;
    // Bilinear look-up cuts the corners of the squares off; 256 binary samples in 8 sets.
    assert!((share.x - 0.5).abs() < 0.06, "{share}");
}

#[test]
fn sky_and_what_cards_reflect_reach_the_floor() {
    let bake = |albedo: f32, bounces| {
        let material = Material { albedo: Vec3::splat(albedo), ..with(Transparency::blend(0.5)) };
        let floor = quad(
            [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, z]| Vec3::new(x, 0.0, z) * 40.0),
            [20, 20],
            0,
        );
        let cover = quad(
            [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]
                .map(|[x, z]| Vec3::new(x * 40.0, 1.0, z * 40.0)),
            [20, 20],
            1,
        );
        let mut builder = scene(vec![floor, cover], vec![grey(0.5, 0.0), material], vec![]);
        builder.sky = Radiance::splat(1.0).into();
        in_the_middle(builder, settings(bounces)).x / std::f32::consts::PI
    };
    // Half of the sky; between infinite planes, light goes up with 0.5 and comes back with 0.5 times 0.8.
    let (direct, all) = (bake(0.8, 0), bake(0.8, 6));
    assert!((direct - 0.5).abs() < 0.03, "{direct}");
    assert!((all / direct - 1.0 / (1.0 - 0.5 * 0.5 * 0.8)).abs() < 0.03, "{all} {direct}");
}

/// A room of one metre with a wall across its middle.
fn divided(walls: Material, partition: Material) -> SceneBuilder {
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 6, Facing::Inward, [0; 6]);
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    objects.push(quad(corners.map(|[x, z]| Vec3::new(x, 0.5, z)), [6, 6], 1));
    scene(objects, vec![walls, partition], vec![])
}

#[test]
fn what_is_half_there_emits_and_reflects_half_in_a_furnace() {
    let partition = Material { transparency: Transparency::blend(0.5), ..two_sided(grey(0.5, 1.0)) };
    let scene = Arc::new(divided(grey(0.5, 1.0), partition).build().unwrap().0);
    for emitters in [EmitterSampling::Rays, EmitterSampling::Lights] {
        let settings = Settings { emitters, projection: Projection::Area, ..settings(20) };
        let (baker, mut state) = (Baker::new(Arc::clone(&scene), settings), SolveState::new());
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let light = baker.light_at_vertices(&state);
        let mean = light.iter().map(|e| e.x).sum::<f32>() / light.len() as f32;
        // Radiosity 1 emitted, half of it reflected again and again.
        // Points on lights at the edges of the room are few: an opaque wall gives 1.980.
        assert!((mean - 2.0).abs() < 0.03, "{emitters:?}: {mean}");
    }
}

/// The power that all surfaces absorb.
fn absorbed(baker: &Baker, state: &SolveState) -> f64 {
    let (scene, light) = (baker.scene(), baker.light_at_vertices(state));
    let of_triangle = |tri: TriId| {
        let at = lumel_scene::SurfacePoint { tri, ..Default::default() };
        let absorbs =
            (1.0 - scene.albedo(at).0.x) * if scene.is_transparent(tri) { scene.opacity(at) } else { 1.0 };
        let mean = scene.triangle(tri).map(|v| light[v as usize].x).iter().sum::<f32>() / 3.0;
        f64::from(absorbs * mean * scene.area(tri))
    };
    (0..scene.triangle_count() as u32).map(|tri| of_triangle(TriId(tri))).sum()
}

#[test]
fn a_closed_room_absorbs_what_its_light_emits_whatever_divides_it() {
    let glass = Transparency { transmission: Vec3::splat(0.6), ..Transparency::default() };
    for (name, albedo, transparency) in [
        ("opaque", 0.6, Transparency::default()),
        ("half", 0.6, Transparency::blend(0.5)),
        ("glass", 0.3, glass),
    ] {
        let partition = Material { transparency, ..two_sided(grey(albedo, 0.0)) };
        let mut builder = divided(grey(0.5, 0.0), partition);
        builder.lights =
            vec![RectLight::new([0.5, 0.9, 0.5], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2], [1.0; 3]).into()];
        for solver in [SolverKind::Cached, SolverKind::Neumann] {
            let settings = Settings { solver, direct_samples: 32, indirect_samples: 64, ..settings(12) };
            let scene = Arc::new(builder.clone().build().unwrap().0);
            let (baker, mut state) = (Baker::new(scene, settings), SolveState::new());
            baker.run(&mut state, &Control::default(), &Silent).unwrap();
            let share = absorbed(&baker, &state) / (std::f64::consts::PI * 0.16);
            // Of a glass that lets 0.6 through and reflects 0.3, rays that end there see what is reflected of the rest.
            assert!((share - 1.0).abs() < 0.02, "{name}, {solver:?}: {share}");
        }
    }
}

/// The light of a floor, and of a card above it if there is one.
fn over_floor_baked(card_of: Option<(Transparency, Vec<f32>)>) -> Vec<Vec3> {
    let material = |transparency| Material { transparency, ..two_sided(grey(0.3, 0.0)) };
    let mut builder = match card_of {
        Some((transparency, alphas)) => {
            over_floor(vec![ObjectMesh { alphas, ..card(0.5, 0.5, 1) }], material(transparency))
        }
        None => over_floor(vec![], material(Transparency::default())),
    };
    builder.lights = vec![Light::Rect(lamp())];
    builder.sky = Radiance::splat(0.5).into();
    let settings = Settings { direct_samples: 16, indirect_samples: 64, ..settings(2) };
    let (baker, mut state) = (Baker::new(Arc::new(builder.build().unwrap().0), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    baker.light_at_vertices(&state)
}

fn mask(alpha: f32) -> Transparency {
    Transparency { mode: AlphaMode::Mask { cutoff: 0.5 }, alpha, ..Transparency::default() }
}

#[test]
fn what_is_not_there_is_as_if_it_had_never_been() {
    let absent = over_floor_baked(None);
    assert_eq!(over_floor_baked(Some((Transparency::blend(0.0), vec![]))), absent);
    assert_eq!(over_floor_baked(Some((Transparency::blend(1.0), vec![0.0; 4]))), absent);
    assert_eq!(over_floor_baked(Some((mask(0.4), vec![]))), absent);
    assert_ne!(over_floor_baked(Some((mask(0.6), vec![])))[..4], absent[..]);
}

#[test]
fn what_is_all_there_is_opaque() {
    let opaque = over_floor_baked(Some((Transparency::default(), vec![])));
    assert_eq!(over_floor_baked(Some((Transparency::default(), vec![0.2; 4]))), opaque);
    assert_eq!(over_floor_baked(Some((Transparency::blend(1.0), vec![]))), opaque);
    assert_eq!(over_floor_baked(Some((mask(0.5), vec![1.0; 4]))), opaque);
    assert_ne!(over_floor_baked(Some((Transparency::blend(0.9), vec![]))), opaque);
}

#[test]
fn bakes_through_glass_have_the_same_bits_on_any_threads_and_instructions() {
    let partition = Material { transparency: Transparency::blend(0.3), ..two_sided(grey(0.6, 0.0)) };
    let mut builder = divided(grey(0.5, 0.0), partition);
    builder.lights = vec![RectLight::new([0.5, 0.9, 0.5], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2], [1.0; 3]).into()];
    let scene = Arc::new(builder.build().unwrap().0);
    let bake = |threads: usize, instructions: InstructionSet, solver| {
        let settings = Settings { solver, direct_samples: 16, indirect_samples: 64, ..settings(2) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let tracer = SeeThrough::build(&scene).with_instructions(instructions).unwrap();
            let baker = Baker::with_tracer(Arc::clone(&scene), Arc::new(tracer), settings);
            let mut state = SolveState::new();
            baker.run(&mut state, &Control::default(), &Silent).unwrap();
            baker.light_at_vertices(&state)
        })
    };
    for solver in [SolverKind::Cached, SolverKind::Neumann] {
        let reference = bake(1, InstructionSet::Portable, solver);
        for set in InstructionSet::available() {
            assert_eq!(bake(2, set, solver), reference, "{set}, {solver:?}");
        }
    }
}
