//! Irradiance at points that need not be vertices, with its standard error.
//!
//! `cargo run --release -p lumel --example measure_points`

#![allow(clippy::print_stdout, reason = "an example is a program")]

use lumel::{Bake, OpenOptions, PointReceivers, Preset, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let opened = lumel::open("cornell-box", &OpenOptions::default())?;
    let baked = Bake::new(opened.builder).preset(Preset::Draft).run()?;
    // A line over the floor, from wall to wall.
    let points = (1..8).map(|i| (Vec3::new(0.07 * i as f32, 0.0, 0.28), Vec3::Y));
    let points =
        PointReceivers::new(baked.baker().scene(), points).map_err(|i| format!("point {i} has no normal"))?;
    let measured = baked.measure(&points)?;
    for (i, (all, error)) in measured.irradiance.iter().zip(&measured.standard_error).enumerate() {
        let direct = measured.bounces[0][i];
        println!("{all:.4} ± {:.4} W/m², {direct:.4} of it direct", error.y);
    }
    Ok(())
}
