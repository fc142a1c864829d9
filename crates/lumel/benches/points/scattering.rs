//! What it takes to scatter points, against the number of triangles.

use cpu_time::ProcessTime;
use glam::{Mat3, Vec3};
use lumel::{Scene, SceneBuilder};
use lumel_accel::tracer_of;
use lumel_basis::{Basis, MeshlessBasis};
use lumel_scene::Material;
use lumel_transport::SurfaceWalks;
use std::sync::Arc;

/// Points on the finest of [`LEVELS`] levels, whatever the triangles.
const POINTS: u64 = 20_000;
const LEVELS: u32 = 3;

/// Times for each number of triangles: of a wall cut into so many, or of leaves of two triangles each, at random.
pub(crate) fn measure(arguments: &[String]) {
    let mut make: (&str, fn(u32) -> Scene) = ("wall", wall);
    for argument in arguments {
        match argument.as_str() {
            "wall" => make = ("wall", wall),
            "leaves" => make = ("leaves", leaves),
            count => {
                let (name, make) = make;
                let scene = Arc::new(make(count.parse().expect("a number of triangles")));
                let cpu = ProcessTime::now();
                let tracer = tracer_of(&scene);
                let tree = cpu.elapsed().as_secs_f64();
                let obstacles = SurfaceWalks { scene: &scene, tracer: &*tracer };
                let spacing = MeshlessBasis::spacing_for(&scene, POINTS);
                let cpu = ProcessTime::now();
                let basis = MeshlessBasis::around_obstacles(Arc::clone(&scene), spacing, LEVELS, &obstacles);
                println!(
                    "  {name:<7} {:>9} triangles: ray tracer {tree:6.2} s, {:>8} points of {LEVELS} levels {:6.2} s CPU",
                    scene.triangle_count(),
                    basis.node_count(),
                    cpu.elapsed().as_secs_f64(),
                );
            }
        }
    }
}

fn wall(triangles: u32) -> Scene {
    let side = (triangles / 2).isqrt().max(1);
    let mut builder = SceneBuilder::new("wall");
    let grey = builder.add_material(Material::default());
    let at = |i: u32| Vec3::new((i % (side + 1)) as f32, 0.0, (i / (side + 1)) as f32) / side as f32;
    let corner = |i: u32| i / side * (side + 1) + i % side;
    let faces = (0..side * side).flat_map(|i| {
        let [a, b] = [corner(i), corner(i) + side + 1];
        [[a, b, a + 1], [a + 1, b, b + 1]]
    });
    builder.add_mesh("wall", (0..(side + 1).pow(2)).map(|i| at(i).to_array()), faces, grey);
    builder.build().unwrap().0
}

fn leaves(triangles: u32) -> Scene {
    let mut builder = SceneBuilder::new("leaves");
    let grey = builder.add_material(Material::default());
    let count = triangles / 2;
    // Of the same area in all.
    let size = 1.0 / (count as f32).sqrt();
    let share = |i: u32, k: u32| {
        (f64::from(i) * [0.754_877_666, 0.569_840_29, 0.819_172_5][k as usize]).fract() as f32
    };
    let corners = (0..count).flat_map(|i| {
        let turn =
            Mat3::from_rotation_y(std::f32::consts::TAU * share(i, 1)) * Mat3::from_rotation_x(share(i, 2));
        let middle = Vec3::new(share(i, 0), share(i, 1), share(i, 2));
        [Vec3::ZERO, Vec3::Z, Vec3::X + Vec3::Z, Vec3::X].map(|at| (middle + turn * at * size).to_array())
    });
    let faces = (0..count).flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]);
    builder.add_mesh("leaves", corners, faces, grey);
    builder.build().unwrap().0
}
