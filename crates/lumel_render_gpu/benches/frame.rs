//! What a picture costs: CPU time of the whole process per frame, software rasterizer included, and time passed.
//!
//! `cargo bench -p lumel_render_gpu --bench frame`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use cpu_time::ProcessTime;
use glam::{Vec2, Vec3};
use lumel_basis::{Coefficients, Directional, Shading, VertexLighting, spherical_harmonics};
use lumel_render_cpu::{Relief, Ripple, Rippled, Scale, ToneMapper};
use lumel_render_gpu::{Frame, Gpu, Lit, Look, Renderer, Samples};
use lumel_scene::{
    Camera, Encoding, Material, MaterialId, Radiance, Scene, Texture, TextureId, TextureRef, UvTransform,
};
use lumel_testkit::mesh::{Facing, quad, sphere};
use lumel_testkit::scene::scene;
use std::sync::Arc;
use std::time::Instant;

const SIZE: [u32; 2] = [1280, 720];

/// Some systems count CPU time in steps of 16 ms: so many frames are measured together.
const FRAMES: u32 = 12;

/// The result is the median of this many measurements.
const REPEATS: usize = 9;

fn main() {
    let renderer = Renderer::new(Arc::new(Gpu::headless().unwrap()));
    println!("{}, {} x {} pixels", renderer.gpu().name(), SIZE[0], SIZE[1]);
    let tone = |tone| Look::Radiance { stops: 0.0, tone, white: ToneMapper::DEFAULT_WHITE };
    for (name, room) in [("plain", room(None)), ("textured", room(Some(checks())))] {
        println!("{name} room, {} triangles", room.triangle_count());
        let show = |name, look| measure(&renderer, &room, name, (look, None));
        show("radiance, agx", tone(ToneMapper::Agx));
        show("radiance, aces", tone(ToneMapper::Aces));
        show("false colours", Look::FalseColor { range: [0.1, 8.0], scale: Scale::Log });
        show("normals", Look::Normals);
        show("plain", Look::Plain);
    }
    let cornell = lumel_builtin::scene("cornell-box", 0).unwrap().build().unwrap().0;
    println!("waves over the Cornell box, {} triangles, radiance, agx", cornell.triangle_count());
    measure(&renderer, &cornell, "none", (tone(ToneMapper::Agx), None));
    for shading in Shading::ALL {
        let name = shading.to_string();
        measure(&renderer, &cornell, &name, (tone(ToneMapper::Agx), Some(shading)));
    }
}

/// Where there is a shading, waves run over all surfaces.
fn measure(renderer: &Renderer, scene: &Scene, name: &str, (look, shading): (Look, Option<Shading>)) {
    let model = renderer.upload(scene).unwrap();
    let light = renderer.light(&model);
    let values: Vec<Vec3> = scene.positions().iter().map(|p| Vec3::splat(1.0 + p.y)).collect();
    let kind = Directional::Sh2;
    let from_above = |n: &Vec3| spherical_harmonics((*n + 0.7 * Vec3::Y).normalize_or_zero());
    let harmonics = scene.normals().iter().flat_map(|n| from_above(n).map(Vec3::splat)).collect();
    let incident = Coefficients::new(kind, harmonics).filter(|_| shading.is_some());
    let lighting = VertexLighting::new(scene, &values).unwrap();
    renderer.set_light(&light, scene, &lighting.with_incident(incident.as_ref()).unwrap()).unwrap();
    let materials: Vec<MaterialId> = (0..scene.materials().len() as u32).map(MaterialId).collect();
    let length = 0.01 * scene.bounds().diagonal();
    for samples in [Samples::One, Samples::Four] {
        let target = renderer.target(SIZE, samples).unwrap();
        let draw = |frame: u32| {
            let yaw = frame as f32 * 0.01;
            let eye = Vec3::new(0.0, 1.0, 3.6);
            let ahead = Vec3::new(yaw.sin(), 0.0, -yaw.cos());
            let turning = Camera::looking_at("c", eye, eye + ahead, 45_f32.to_radians());
            let camera = scene.cameras().first().unwrap_or(&turning);
            let ripple = Ripple { length, slope: 0.35, phase: yaw };
            let (light, sky) = (Lit::One((&light).into()), Radiance::ZERO);
            let frame = Frame {
                model: &model,
                camera,
                light,
                rect_lights: &[],
                look,
                relief: Relief { shading: shading.unwrap_or_default(), ..Relief::default() },
                ripple: shading.map(|_| Rippled { ripple, materials: &materials }),
                wireframe: false,
                grid: false,
                overlay: None,
                sky,
                backdrop: None,
            };
            renderer.draw(&target, &frame);
            renderer.gpu().device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        };
        draw(0);
        let mut results: Vec<[f64; 2]> = (0..REPEATS)
            .map(|_| {
                let (start, cpu) = (Instant::now(), ProcessTime::now());
                (0..FRAMES).for_each(draw);
                [cpu.elapsed(), start.elapsed()].map(|time| 1e3 * time.as_secs_f64() / f64::from(FRAMES))
            })
            .collect();
        results.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [cpu, wall] = results[REPEATS / 2];
        println!("  {name:<16} {} x   {cpu:6.1} ms CPU   {wall:6.1} ms", samples.count());
    }
}

/// The Cornell box and a ball, finely divided.
fn room(texture: Option<Texture>) -> Scene {
    let wall = |a: [f32; 3], u: [f32; 3], v: [f32; 3], material| {
        let [a, u, v] = [a, u, v].map(Vec3::from);
        quad([a, a + u, a + u + v, a + v], [100, 100], material)
    };
    let map = texture.is_some().then(|| {
        let transform = UvTransform { scale: Vec2::splat(2.0), ..UvTransform::default() };
        TextureRef { texture: TextureId(0), transform }
    });
    let paint = |r, g, b| Material { albedo_texture: map, ..Material::diffuse("paint", Vec3::new(r, g, b)) };
    let objects = vec![
        wall([-1.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0], 0),
        wall([-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0),
        wall([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], 0),
        wall([-1.0, 0.0, 1.0], [0.0, 0.0, -2.0], [0.0, 2.0, 0.0], 1),
        wall([1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0], 2),
        sphere(Vec3::new(-0.35, 0.4, -0.2), 0.4, 5, Facing::Outward, 0),
    ];
    let materials = vec![paint(0.73, 0.73, 0.73), paint(0.63, 0.06, 0.05), paint(0.14, 0.45, 0.09)];
    let mut builder = scene(objects, materials, vec![]);
    builder.textures.extend(texture);
    builder.build().unwrap().0
}

/// 512 x 512 texels.
fn checks() -> Texture {
    let texel = |i: u32| if (i % 512 / 32 + i / 512 / 32).is_multiple_of(2) { [200; 4] } else { [90; 4] };
    Texture::from_bytes("checks", 512, 512, (0..512 * 512).map(texel).collect(), Encoding::Srgb).unwrap()
}
