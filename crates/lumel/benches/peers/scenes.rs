//! The scenes that renderers are compared in.

use crate::places::Places;
use glam::Vec3;
use lumel::{Light, MaxEdge, OpenOptions, Scene};
use lumel_scene::Sides;

#[path = "../common/sponza.rs"]
mod sponza;

/// How finely a scene is tessellated.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Detail {
    /// As it is baked.
    Usual,
    /// Edges much shorter.
    Fine,
}

/// The Cornell box, or Marko Dabrovic's Sponza with the light of Aalto University's course.
///
/// Every material has one albedo, the mean of its texture, so that all renderers see the same; and a front only.
pub(crate) fn open(name: &str, places: Places, detail: Detail) -> Scene {
    let fine = matches!(detail, Detail::Fine);
    let (file, options) = match name {
        "cornell-box" => {
            (name.into(), OpenOptions { subdivide: fine.then_some(1), ..OpenOptions::default() })
        }
        "sponza" => {
            let max_edge = Some(match (places, detail) {
                (Places::Nodes, Detail::Usual) => 3.0,
                (Places::Nodes, Detail::Fine) => 0.25,
                // What lies between vertices counts.
                (Places::Surfaces, Detail::Usual) => 1.0,
                (Places::Surfaces, Detail::Fine) => 0.5,
            });
            (
                sponza::file().unwrap(),
                OpenOptions {
                    max_edge: Some(max_edge.map_or(MaxEdge::Off, MaxEdge::Length)),
                    ..OpenOptions::default()
                },
            )
        }
        _ => panic!("there is no scene {name} to compare renderers in"),
    };
    let mut scene = lumel::open(&file.to_string_lossy(), &options).unwrap().builder;
    let textures = &scene.textures;
    for material in &mut scene.materials {
        if let Some(texture) = material.albedo_texture.take() {
            material.albedo *= textures[texture.texture.index()].mean();
        }
        material.albedo = material.albedo.min(Vec3::splat(MAX_ALBEDO));
        material.normal_texture = None;
        material.sides = Sides::Front;
    }
    if scene.lights.is_empty() {
        scene.lights = vec![Light::Rect(sponza::light())];
    }
    scene.build().unwrap().0
}

/// lumel takes no surface to reflect more.
const MAX_ALBEDO: f32 = 0.98;
