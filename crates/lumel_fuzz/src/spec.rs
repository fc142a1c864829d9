//! Lights, skies and cameras as text.

use crate::scene::build;
use lumel::{SceneBuilder, spec};

/// The text of `--light`, and as a second reader of the same words, of `--camera`.
pub(crate) fn light(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    match spec::light(text) {
        Ok(spec) => {
            // All that is accepted suits a scene.
            let light = spec.light().expect("a light that was accepted");
            let builder = SceneBuilder { lights: vec![light], ..room() };
            builder.clone().build().expect("a light that was accepted");
            build(builder);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    if let Err(error) = spec::sky(text) {
        assert!(!error.to_string().is_empty());
    }
    match spec::camera(text) {
        Ok(camera) => assert!(camera.fov_deg > 0.0 && camera.camera().position.is_finite()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// One triangle.
fn room() -> SceneBuilder {
    let face = lumel_scene::Face {
        vertices: [0, 1, 2],
        material: lumel_scene::MaterialId(0),
        smoothing: lumel_scene::Smoothing::Flat,
    };
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Into::into).to_vec();
    let mesh = lumel_scene::ObjectMesh { positions, faces: vec![face], ..Default::default() };
    SceneBuilder {
        objects: vec![mesh],
        materials: vec![lumel_scene::Material::default()],
        ..SceneBuilder::default()
    }
}
