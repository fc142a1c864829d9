//! The light of each single light, on the same rays: dimming them afterwards needs no solve.
//!
//! `cargo run --release -p lumel --example layers`

#![allow(clippy::print_stdout, reason = "an example is a program")]

use lumel::{Bake, OpenOptions, PointLight, Preset, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = lumel::open("cornell-box", &OpenOptions::default())?.builder;
    let bulb =
        PointLight { position: Vec3::new(0.1, 0.1, 0.05), intensity: Vec3::splat(0.5), range: f32::INFINITY };
    scene.add_named_light("bulb", bulb);
    let baked = Bake::new(scene).preset(Preset::Draft).layers().run()?;
    for layer in baked.solution().layers {
        println!("{:8} {:8.4} W/m²", layer.name, mean(&layer.irradiance));
    }
    println!("{:8} {:8.4} W/m²", "all", mean(&baked.solution().irradiance));
    let share = |name: &str| Vec3::splat(if name == "ceiling" { 0.5 } else { 1.0 });
    if let Some(dimmed) = baked.baker().mixed(baked.state(), share) {
        println!("{:8} {:8.4} W/m²", "dimmed", mean(&dimmed));
    }
    Ok(())
}

/// The mean over all vertices, of the green channel.
fn mean(light: &[Vec3]) -> f32 {
    light.iter().map(|e| e.y).sum::<f32>() / light.len() as f32
}
