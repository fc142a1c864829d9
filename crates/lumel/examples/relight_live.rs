//! Lighting that follows a light: rays are traced once, then every frame is direct light and products with stored rows.
//!
//! `cargo run --release -p lumel --example relight_live`

#![allow(clippy::print_stdout, reason = "an example is a program")]

use lumel::{Baker, BounceLimit, Control, Light, OpenOptions, Preset, Settings, Silent, SolveState, Vec3};
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let opened = lumel::open("cornell-box", &OpenOptions::default())?;
    let scene = Arc::new(opened.builder.build()?.0);
    let settings = Settings { bounces: BounceLimit::Count(3), ..Preset::Draft.settings() };
    let mut baker = Baker::new(Arc::clone(&scene), settings.clone());
    for frame in 0..4 {
        let mut lights = scene.lights().to_vec();
        if let Some(Light::Rect(light)) = lights.first_mut() {
            light.center += Vec3::X * 0.03 * frame as f32;
        }
        let begun = Instant::now();
        baker = baker.relit(Arc::new(scene.relit(lights)?), settings.clone());
        let (mut state, control) = (SolveState::new(), Control::default());
        baker.run(&mut state, &control, &Silent)?;
        let first = baker.light_at_vertices(&state)[0];
        println!(
            "frame {frame}: {:4.0} ms, {:7} rays, {:.3} W/m² at the first vertex",
            begun.elapsed().as_secs_f64() * 1e3,
            control.rays(),
            first.y
        );
    }
    Ok(())
}
