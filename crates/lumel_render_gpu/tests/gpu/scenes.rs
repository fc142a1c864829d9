//! Scenes to draw.

use crate::common::Subject;
use glam::{EulerRot, Quat, Vec2, Vec3};
use lumel::{Baker, BounceLimit, Control, Settings, Silent, SolveState};
use lumel_scene::{
    Camera, Encoding, Light, Material, MaterialId, NormalMap, ObjectMesh, Radiance, RectLight, Scene,
    SceneBuilder, Sides, Texture, TextureId, TextureRef, UvTransform, Wrap,
};
use lumel_testkit::mesh::{Facing, quad, sphere};
use lumel_testkit::scene::placed;
use std::sync::{Arc, LazyLock};

/// The Cornell box, baked with few samples.
pub(crate) fn cornell() -> &'static Subject {
    static SUBJECT: LazyLock<Subject> = LazyLock::new(|| {
        let (scene, _) = lumel_builtin::scene("cornell-box", 0).unwrap().build().unwrap();
        let camera = scene.cameras()[0].clone();
        let settings = Settings {
            bounces: BounceLimit::Count(1),
            direct_samples: 4,
            indirect_samples: 4,
            ..Settings::default()
        };
        let baker = Baker::new(Arc::new(scene.clone()), settings);
        let mut state = SolveState::new();
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let light = baker.solution(&state).irradiance;
        Subject { scene, light, camera }
    });
    &SUBJECT
}

/// The Cornell box without its back wall, far away and turned about all axes.
pub(crate) fn far_open_box() -> Subject {
    let (turn, shift) = (Quat::from_euler(EulerRot::XYZ, 0.4, -0.9, 0.3), Vec3::new(40.0, -25.0, 30.0));
    let mut builder = lumel_builtin::scene("cornell-box", 0).unwrap();
    builder.objects.retain(|object| object.name != "back wall");
    let camera = builder.cameras[0].clone();
    let camera = Camera {
        position: turn * camera.position + shift,
        forward: turn * camera.forward,
        up: turn * camera.up,
        ..camera
    };
    let (scene, _) = placed(builder, turn, shift).build().unwrap();
    let light = shine(&scene);
    Subject { scene, light, camera }
}

/// The wall of leather, so near that its texels are larger than pixels.
pub(crate) fn leather() -> Subject {
    let (scene, _) = lumel_builtin::scene("cornell-leather", 0).unwrap().build().unwrap();
    let target = Vec3::new(0.3, 0.3, 0.5592);
    let camera = Camera::looking_at("near", target - Vec3::new(0.006, 0.003, 0.015), target, 0.9);
    let light = shine(&scene);
    Subject { scene, light, camera }
}

/// Light of all colours that changes over the scene: no solution, but easy to make.
pub(crate) fn shine(scene: &Scene) -> Vec<Vec3> {
    let size = scene.bounds().diagonal();
    let wave = |p: Vec3| {
        1.2 + Vec3::new((7.0 * p.x / size).sin(), (9.0 * p.y / size).cos(), (8.0 * p.z / size).sin())
    };
    let at = |(p, n): (&Vec3, &Vec3)| wave(*p) * (1.5 + n.dot(Vec3::new(0.3, 0.8, 0.5)));
    scene.positions().iter().zip(scene.normals()).map(at).collect()
}

/// All that a scene can have: textures of every kind, wrapped, mirrored and turned, on both sides; tints; emissive and
/// normal-mapped faces; rectangle lights with and without an image; a sky.
pub(crate) fn everything() -> Subject {
    let mut builder = SceneBuilder { name: "everything".to_owned(), ..SceneBuilder::default() };
    builder.sky = Radiance(Vec3::new(0.3, 0.5, 0.9)).into();
    builder.textures = textures();
    let map = |index: u32, transform| Some(TextureRef { texture: TextureId(index), transform });
    let mirrored = UvTransform { offset: Vec2::new(0.2, 0.7), rotation: 0.5, scale: Vec2::new(-1.5, 0.8) };
    let both = Material {
        albedo_texture: map(0, mirrored),
        normal_texture: map(2, mirrored).map(NormalMap::new),
        sides: Sides::Both,
        ..Material::diffuse("both", Vec3::new(0.9, 0.8, 0.7))
    };
    let emissive = Material {
        emission: Radiance(Vec3::new(0.5, 0.4, 0.3)),
        emission_texture: map(1, UvTransform { scale: Vec2::splat(1.7), ..UvTransform::default() }),
        ..Material::diffuse("emissive", Vec3::splat(0.2))
    };
    let grey = Material::diffuse("grey", Vec3::splat(0.7));
    let bumps = map(2, UvTransform::default()).map(|image| NormalMap { image, scale: Vec2::new(0.8, -0.6) });
    let bumpy = Material { normal_texture: bumps, ..grey.clone() };
    builder.materials = vec![both, emissive, grey, bumpy];
    builder.objects = objects();
    let rect_light = |center, texture| {
        Light::Rect(RectLight {
            center,
            u: Vec3::new(0.35, 0.0, 0.1),
            v: Vec3::new(0.0, 0.3, 0.0),
            radiance: Radiance(Vec3::new(2.0, 1.5, 1.0)),
            texture,
        })
    };
    // The last shows its back.
    let away = RectLight {
        center: Vec3::new(0.0, 1.2, 0.5),
        u: Vec3::X * -0.3,
        v: Vec3::Y * 0.2,
        radiance: Radiance::splat(3.0),
        texture: None,
    };
    builder.lights = vec![
        rect_light(Vec3::new(-1.0, 1.3, -0.5), None),
        rect_light(Vec3::new(1.0, 1.3, -0.5), Some(TextureId(0))),
        Light::Rect(away),
    ];
    let (scene, warnings) = builder.build().unwrap();
    assert!(warnings.is_empty(), "{:?}", warnings.iter().next());
    let light = shine(&scene);
    let up = Vec3::new(0.2, 1.0, 0.1);
    let camera =
        Camera { up, ..Camera::looking_at("c", Vec3::new(0.4, 0.8, 3.2), Vec3::new(0.0, 0.3, 0.0), 0.9) };
    Subject { scene, light, camera }
}

fn objects() -> Vec<ObjectMesh> {
    let square = |center: Vec3, u: Vec3, v: Vec3, material| {
        quad([center - u - v, center + u - v, center + u + v, center - u + v], [3, 3], material)
    };
    let mut floor = square(Vec3::ZERO, Vec3::X * 2.0, Vec3::Z * -2.0, 2);
    floor.tints = floor.positions.iter().map(|p| Vec3::new(0.5 + 0.2 * p.x, 0.8, 0.5 - 0.2 * p.z)).collect();
    let front = square(Vec3::new(-1.2, 0.5, 0.6), Vec3::new(0.5, 0.0, -0.2), Vec3::Y * 0.45, 0);
    // Seen from behind.
    let back = square(Vec3::new(0.1, 0.5, 0.4), Vec3::new(-0.5, 0.0, -0.1), Vec3::Y * 0.45, 0);
    // One looks through it.
    let through = square(Vec3::new(0.7, 0.4, 1.2), Vec3::X * -0.2, Vec3::Y * 0.2, 2);
    let glow = square(Vec3::new(1.3, 0.5, 0.6), Vec3::new(0.5, 0.0, 0.2), Vec3::Y * 0.45, 1);
    let mut ball = sphere(Vec3::new(0.6, 0.9, -1.0), 0.4, 3, Facing::Outward, 3);
    ball.normals = ball.positions.iter().map(|p| *p - Vec3::new(0.6, 0.9, -1.0)).collect();
    ball.uvs = ball.positions.iter().map(|p| Vec2::new(2.0 * p.x, -3.0 * p.y)).collect();
    ball.faces.iter_mut().for_each(|face| face.material = MaterialId(3));
    vec![floor, front, back, through, glow, ball]
}

/// Small ones, so that their texels are larger than pixels: sRGB, floats, normals.
fn textures() -> Vec<Texture> {
    let rgba = |i: u32| [(i * 37 % 256) as u8, (i * 91 % 256) as u8, (255 - i * 53 % 256) as u8, 255];
    let mut paint = Texture::from_bytes("paint", 6, 5, (0..30).map(rgba).collect(), Encoding::Srgb).unwrap();
    (paint.wrap_u, paint.wrap_v) = (Wrap::Mirror, Wrap::Repeat);
    let rgb = |i: u16| [f32::from(i % 5), f32::from(i % 3) * 0.5, 3.0 - f32::from(i % 4)];
    let mut glow = Texture::from_floats("glow", 4, 4, (0..16).map(rgb).collect()).unwrap();
    (glow.wrap_u, glow.wrap_v) = (Wrap::Clamp, Wrap::Mirror);
    let bumps = |i: u32| [(128 + 90 * (i % 3)) as u8, (30 + 70 * (i % 4)) as u8, 230, 255];
    let normals = Texture::from_bytes("bumps", 4, 4, (0..16).map(bumps).collect(), Encoding::Linear).unwrap();
    vec![paint, glow, normals]
}
