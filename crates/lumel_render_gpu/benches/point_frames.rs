//! What light at scattered points costs per frame: by pixels, levels, points and triangles, beside light at vertices.
//!
//! `cargo bench -p lumel_render_gpu --bench point_frames`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use cpu_time::ProcessTime;
use glam::Vec3;
use lumel_basis::{Basis, Field, MeshlessBasis, PointCloud, VertexLighting};
use lumel_render_cpu::{Relief, ToneMapper};
use lumel_render_gpu::{Frame, Gpu, Lit, Look, Renderer, Samples, Values};
use lumel_scene::{Camera, Material, Radiance, Scene};
use lumel_testkit::mesh::{Facing, cuboid, sphere};
use lumel_testkit::scene::scene;
use std::sync::Arc;
use std::time::Instant;

/// Some systems count CPU time in steps of 16 ms: so many frames are measured together.
const FRAMES: u32 = 2;

/// The result is the median of this many measurements.
const REPEATS: usize = 3;

fn main() {
    let renderer = Renderer::new(Arc::new(Gpu::headless().unwrap()));
    println!("{}", renderer.gpu().name());
    let show = |cells: u32, points: u64, levels: u32, size: [u32; 2]| {
        let room = Arc::new(room(cells));
        measure(&renderer, &room, (points, levels), size);
    };
    for size in [[640, 360], [1280, 720]] {
        for levels in 1..=4 {
            show(40, 20_000, levels, size);
        }
    }
    for points in [2_000, 200_000] {
        show(40, points, 3, [1280, 720]);
    }
    for cells in [4, 400] {
        show(cells, 20_000, 3, [1280, 720]);
    }
}

/// A room with a ball in it, its walls in a grid of `cells`.
fn room(cells: u32) -> Scene {
    let mut objects = cuboid(Vec3::ZERO, Vec3::new(2.0, 2.0, 3.0), cells, Facing::Inward, [0; 6]).to_vec();
    let depth = cells.ilog2() - 1;
    objects.push(sphere(Vec3::new(1.2, 0.5, 1.0), 0.5, depth, Facing::Outward, 0));
    scene(objects, vec![Material::diffuse("paint", Vec3::splat(0.6))], vec![]).build().unwrap().0
}

fn measure(renderer: &Renderer, scene: &Arc<Scene>, (points, levels): (u64, u32), size: [u32; 2]) {
    let spacing = MeshlessBasis::spacing_for(scene, points);
    let basis = MeshlessBasis::with_levels(Arc::clone(scene), spacing, levels);
    let bright = |p: Vec3| 1.0 + 0.5 * (5.0 * p).map(f32::sin);
    let mut field = Field::from_values(basis.points().iter().map(|point| bright(point.position)).collect());
    basis.hierarchy().inspect(|hierarchy| hierarchy.analyze(&mut field, None));
    let (model, cloud) = (renderer.upload(scene).unwrap(), PointCloud::of(&basis));
    let (light, buffer) = (renderer.light(&model), renderer.points(&cloud).unwrap());
    let values: Vec<Vec3> = scene.positions().iter().map(|p| bright(*p)).collect();
    let none = vec![Vec3::ZERO; values.len()];
    renderer.set_points(&buffer, field.values());
    let [triangles, points] = [scene.triangle_count(), cloud.points().len()];
    print!("{} x {}, {triangles:>7} triangles, {points:>6} points on {levels} levels:", size[0], size[1]);
    for samples in [Samples::One, Samples::Four] {
        let at_points = Values::Points { points: &buffer, finest: u32::MAX, vertices: &light };
        for (name, shown, values) in
            [("vertices", Values::Vertices(&light), &values), ("points", at_points, &none)]
        {
            renderer.set_light(&light, scene, &VertexLighting::new(scene, values).unwrap()).unwrap();
            let [cpu, wall] = milliseconds(renderer, (&model, shown), size, samples);
            print!("  {name} {} x {cpu:6.1} ms CPU {wall:6.1} ms", samples.count());
        }
    }
    println!();
}

/// CPU time and time passed of a frame.
fn milliseconds(
    renderer: &Renderer,
    (model, shown): (&lumel_render_gpu::Model, Values<'_>),
    size: [u32; 2],
    samples: Samples,
) -> [f64; 2] {
    let target = renderer.target(size, samples).unwrap();
    let draw = |frame: u32| {
        let yaw = frame as f32 * 0.01;
        let eye = Vec3::new(1.0, 1.0, 2.9);
        let ahead = Vec3::new(yaw.sin(), 0.0, -yaw.cos());
        let frame = Frame {
            model,
            camera: &Camera::looking_at("c", eye, eye + ahead, 60_f32.to_radians()),
            light: Lit::One(shown),
            rect_lights: &[],
            look: Look::Radiance {
                stops: 0.0,
                tone: ToneMapper::default(),
                white: ToneMapper::DEFAULT_WHITE,
            },
            relief: Relief::default(),
            ripple: None,
            wireframe: false,
            grid: false,
            overlay: None,
            sky: Radiance::ZERO,
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
    results[REPEATS / 2]
}
