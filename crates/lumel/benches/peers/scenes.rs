//! The scenes that renderers are compared in.

use crate::places::Places;
use glam::Vec3;
use lumel::{Light, MaxEdge, OpenOptions, Scene};
use lumel_scene::{Sides, Smoothing};

#[path = "../common/sponza.rs"]
mod sponza;

/// How finely a scene is tessellated.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Detail {
    /// As it is in its file, but without smooth normals, whose shadows renderers treat in ways of their own.
    Given,
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
                (_, Detail::Given) => MaxEdge::Off,
                (Places::Nodes, Detail::Usual) => MaxEdge::Length(3.0),
                (Places::Nodes, Detail::Fine) => MaxEdge::Length(0.25),
                // What lies between vertices counts.
                (Places::Surfaces, Detail::Usual) => MaxEdge::Length(1.0),
                (Places::Surfaces, Detail::Fine) => MaxEdge::Length(0.5),
            });
            (sponza::file().unwrap(), OpenOptions { max_edge, ..OpenOptions::default() })
        }
        _ => panic!("there is no scene {name} to compare renderers in"),
    };
    let mut scene = lumel::open(&file, &options).unwrap().builder;
    if matches!(detail, Detail::Given) {
        for object in &mut scene.objects {
            object.normals.clear();
            object.faces.iter_mut().for_each(|face| face.smoothing = Smoothing::Flat);
        }
    }
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
