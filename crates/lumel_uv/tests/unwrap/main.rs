//! What holds for the atlas of any scene.

#![allow(clippy::unwrap_used, reason = "helpers of tests are no tests to Clippy")]

mod coverage;
mod given;
mod laws;
mod meshes;
mod settings;

use lumel_scene::{Scene, SceneBuilder};
use lumel_uv::{Density, Pace, UnwrapSettings, Unwrapped, unwrap};

/// A budget that keeps tests quick.
fn settings() -> UnwrapSettings {
    UnwrapSettings { density: Density::Budget(1 << 16), page_size: 512, ..UnwrapSettings::default() }
}

fn built(builder: SceneBuilder) -> Scene {
    builder.build().unwrap().0
}

fn unwrapped(scene: &Scene, settings: &UnwrapSettings) -> Unwrapped {
    unwrap(scene, settings, &|| Pace::Go).unwrap()
}
