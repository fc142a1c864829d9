//! The scenes that rays are traced in.

use glam::Vec3;
use lumel::{Light, MaxEdge, OpenOptions, RectLight, Scene};
use std::path::PathBuf;
use std::sync::Arc;

#[path = "../common/sponza.rs"]
mod sponza;

/// A scene and what is measured in it.
pub(crate) struct TestScene {
    pub(crate) name: &'static str,
    pub(crate) scene: Arc<Scene>,
    /// Distance of receivers in tiles, metres.
    pub(crate) pitch: f32,
    /// Lights that shadow rays go to.
    pub(crate) lights: Vec<(&'static str, RectLight)>,
}

/// The names of all scenes.
pub(crate) const NAMES: [&str; 3] = ["cornell-box", "atrium", "sponza"];

/// Opens a scene; says why when there is none.
pub(crate) fn open(name: &'static str) -> Result<TestScene, String> {
    let (from, max_edge, pitch) = match name {
        // 40,064 triangles. The box is 0.56 m wide: its pitch is to it what 4 cm are to a room of 8 m.
        "cornell-box" => (PathBuf::from(name), Some(0.015), 0.0028),
        "sponza" => (sponza::file()?, None, 0.04),
        other => (PathBuf::from(other), None, 0.04),
    };
    let opened = lumel::open(
        &from,
        &OpenOptions {
            max_edge: Some(max_edge.map_or(MaxEdge::Off, MaxEdge::Length)),
            ..OpenOptions::default()
        },
    );
    let scene = opened.map_err(|e| e.to_string())?.builder.build().map_err(|e| e.to_string())?.0;
    let own = scene
        .lights()
        .iter()
        .find_map(|light| if let Light::Rect(rect) = light { Some(*rect) } else { None });
    let light = own.unwrap_or_else(sponza::light);
    let scene = scene.relit(vec![Light::Rect(light)]).map_err(|e| e.to_string())?;
    let wider = |light: RectLight| RectLight { u: light.u * 4.0, v: light.v * 4.0, ..light };
    let small = light_in_the_middle(&scene);
    let lights = vec![
        ("its light", light),
        ("its light, 4 times as wide", wider(light)),
        ("a small light in the middle", small),
        ("a large light in the middle", wider(small)),
    ];
    Ok(TestScene { name, scene: Arc::new(scene), pitch, lights })
}

/// A square that faces down, above the middle of a scene, a twenty-fifth as wide as the scene is long.
fn light_in_the_middle(scene: &Scene) -> RectLight {
    let bounds = scene.bounds();
    let extent = bounds.max - bounds.min;
    let half_size = 0.02 * extent.max_element();
    RectLight {
        center: bounds.center() + Vec3::Y * (0.3 * extent.y),
        u: Vec3::X * half_size,
        v: Vec3::NEG_Z * half_size,
        ..sponza::light()
    }
}
