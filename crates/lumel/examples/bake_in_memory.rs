//! From arrays to irradiance, and the same room under another light.
//!
//! `cargo run --release -p lumel --example bake_in_memory`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example is a program")]

use lumel::{Bake, FaceSide, Light, Material, Preset, RectLight, SceneBuilder, SpotLight, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A stage of 4 × 3 × 4 m, whose surfaces face inwards, and a wall that stands in it.
    let mut scene = SceneBuilder::new("room");
    let white = scene.add_material(Material::diffuse("white", [0.8, 0.8, 0.8]));
    let red = scene.add_material(Material::diffuse("red", [0.7, 0.1, 0.1]).two_sided());
    let floor = scene.add_mesh("floor", grid([4.0, 4.0], |x, z| [x, 0.0, 4.0 - z]), cells(), white);
    scene.add_mesh("ceiling", grid([4.0, 4.0], |x, z| [x, 3.0, z]), cells(), white);
    scene.add_mesh("back", grid([4.0, 3.0], |x, y| [x, y, 0.0]), cells(), white);
    let wall = scene.add_mesh("wall", grid([2.0, 2.0], |x, y| [1.0 + x, y, 2.0]), cells(), red);
    scene.add_light(RectLight::new([2.0, 2.9, 3.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [9.0, 9.0, 9.0]));

    let baked = Bake::new(scene)
        .preset(Preset::Draft)
        .bounces(3)
        .on_progress(|step, share| eprint!("\r{step:?}: {:3.0} %   ", 100.0 * share))
        .run()?;
    eprintln!();

    // Light in the order of the vertices that were given; a two-sided wall has light on both sides.
    let mean = |mesh, side| {
        let light: Vec<Vec3> = baked.light_at_vertices(mesh, side).into_iter().flatten().collect();
        light.iter().sum::<Vec3>() / light.len() as f32
    };
    println!("floor                {:.3} W/m²", mean(floor, FaceSide::Front));
    println!("wall, towards light  {:.3} W/m²", mean(wall, FaceSide::Front));
    println!("wall, away from it   {:.3} W/m²", mean(wall, FaceSide::Back));

    // Another light: no hemisphere ray is traced again.
    let point = lumel::PointLight {
        position: Vec3::new(2.0, 2.5, 1.0),
        intensity: Vec3::splat(5.0),
        range: f32::INFINITY,
    };
    let spot = SpotLight { point, direction: Vec3::NEG_Y, cos_inner: 0.9, cos_outer: 0.7 };
    let relit = baked.relit(vec![Light::Spot(spot)])?;
    let light = relit.light_at_vertices(floor, FaceSide::Front);
    println!(
        "floor under a spot   {:.3} W/m² at most",
        light.into_iter().flatten().map(|e| e.y).fold(0.0, f32::max)
    );

    let folder = tempfile::tempdir()?;
    relit.save(folder.path().join("room.npz"))?;
    Ok(())
}

/// Cells along each side of a grid.
const N: u32 = 16;

/// The vertices of a grid over a rectangle, row by row.
fn grid(size: [f32; 2], place: impl Fn(f32, f32) -> [f32; 3]) -> Vec<[f32; 3]> {
    let along = |i: u32, k: usize| size[k] * i as f32 / N as f32;
    (0..=N).flat_map(|j| (0..=N).map(move |i| (i, j))).map(|(i, j)| place(along(i, 0), along(j, 1))).collect()
}

/// Its triangles, which face the side from which the first axis turns counter-clockwise to the second.
fn cells() -> Vec<[u32; 3]> {
    let at = |i: u32, j: u32| j * (N + 1) + i;
    let cell = |(i, j): (u32, u32)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..N).flat_map(|j| (0..N).map(move |i| (i, j))).flat_map(cell).collect()
}
