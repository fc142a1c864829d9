//! Scenes as they are given, and on meshes of even edges.

use lumel::{Bisection, Light, MaxEdge, OpenOptions, Scene, SceneBuilder};
use lumel_scene::Sides;
use lumel_testkit::shared;
use std::sync::Arc;

use crate::sponza;

/// A scene of the folder of shared ones by its path there, or Sponza with its light by name; its edges as they are.
pub(crate) fn open(name: &str) -> Result<SceneBuilder, String> {
    let path = match name {
        "sponza" => sponza::file()?,
        _ => shared::path(name)
            .ok_or_else(|| format!("{name} is read from the folder that {} names", shared::VARIABLE))?,
    };
    let options = OpenOptions { max_edge: Some(MaxEdge::Off), ..OpenOptions::default() };
    let mut builder = lumel::open(&path, &options).map_err(|e| e.to_string())?.builder;
    if name == "sponza" {
        builder.materials.iter_mut().for_each(|material| material.sides = Sides::Both);
        builder.lights = vec![Light::Rect(sponza::light())];
    }
    Ok(builder)
}

/// The scene with edges of at most this part of its diameter.
pub(crate) fn uniform(scene: &Arc<Scene>, part: f64) -> Arc<Scene> {
    let mut mesh = Bisection::new(Arc::clone(scene));
    loop {
        let edges = |part: &lumel_scene::Part| {
            [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|k: usize| part.vertices[k]))
        };
        // A little more, so that rounding splits no diagonal once more.
        let is_long = |ends: &[u32; 2]| mesh.relative_length(*ends) > 1.001 / part;
        let long: Vec<[u32; 2]> = mesh.parts().flat_map(edges).filter(is_long).collect();
        if long.is_empty() {
            return Arc::new(scene.refined(mesh.splits()).unwrap());
        }
        assert!(mesh.split(long, usize::MAX));
    }
}
