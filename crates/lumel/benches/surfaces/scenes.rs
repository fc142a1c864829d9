//! The scenes in which light over surfaces is measured.

use crate::place::Place;
use glam::Vec3;
use lumel::{Light, MaxEdge, OpenOptions, RectLight, Scene};
use lumel_scene::{Radiance, Sides};
use lumel_testkit::shared;
use std::path::PathBuf;

#[path = "../common/sponza.rs"]
mod sponza;

/// A scene, and how finely it is tessellated.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    from: Source,
    /// Longest edge, metres.
    max_edge: Option<f32>,
    /// Longest edge of the mesh on which the bounces of the reference are solved, metres.
    reference_edge: Option<f32>,
}

#[derive(Clone, Copy)]
enum Source {
    BuiltIn(&'static str),
    /// A file of the shared folder, which has lights.
    Shared(&'static str),
    Sponza,
    Bathroom,
}

/// All scenes, from the fastest on.
pub(crate) const CASES: [Case; 6] = [
    Case {
        name: "coarse-box",
        from: Source::Shared("scenes/cornell-variants/CornellBox-Original.obj"),
        max_edge: Some(0.5),
        reference_edge: Some(0.05),
    },
    Case {
        name: "cornell-box",
        from: Source::BuiltIn("cornell-box"),
        max_edge: None,
        reference_edge: Some(0.01),
    },
    Case { name: "atrium", from: Source::BuiltIn("atrium"), max_edge: None, reference_edge: Some(0.25) },
    Case { name: "sponza-2m", from: Source::Sponza, max_edge: Some(2.0), reference_edge: Some(0.5) },
    Case { name: "sponza-0.5m", from: Source::Sponza, max_edge: Some(0.5), reference_edge: None },
    Case { name: "bathroom", from: Source::Bathroom, max_edge: Some(0.2), reference_edge: None },
];

impl Case {
    /// The scene as it is measured, with what traces rays in it; why there is none.
    pub(crate) fn open(&self) -> Result<Place, String> {
        build(self.from, self.max_edge).map(Place::new)
    }

    /// The mesh of the reference; `None` if it is that of the scene.
    pub(crate) fn open_reference(&self) -> Result<Option<Place>, String> {
        self.reference_edge.map(|edge| build(self.from, Some(edge)).map(Place::new)).transpose()
    }
}

fn build(from: Source, max_edge: Option<f32>) -> Result<Scene, String> {
    let path = match from {
        Source::BuiltIn(name) => name.into(),
        Source::Shared(file) => shared_file(file)?,
        Source::Sponza => sponza::file()?,
        Source::Bathroom => shared_file("scenes/bathroom/bathroom.glb")?,
    };
    let options = OpenOptions {
        max_edge: Some(max_edge.map_or(MaxEdge::Off, MaxEdge::Length)),
        ..OpenOptions::default()
    };
    let mut builder = lumel::open(&path, &options).map_err(|e| e.to_string())?.builder;
    match from {
        Source::BuiltIn(_) | Source::Shared(_) => {}
        Source::Sponza => {
            builder.materials.iter_mut().for_each(|material| material.sides = Sides::Both);
            builder.lights = vec![Light::Rect(sponza::light())];
        }
        Source::Bathroom => builder.lights = vec![Light::Rect(bathroom_light())],
    }
    builder.build().map(|(scene, _)| scene).map_err(|e| e.to_string())
}

fn shared_file(file: &str) -> Result<PathBuf, String> {
    let path = shared::path(file);
    path.ok_or_else(|| format!("{file} is read from the folder that {} names", shared::VARIABLE))
}

/// A square below the ceiling: the bulbs of the scene shine behind glass, which lumel takes to be opaque.
fn bathroom_light() -> RectLight {
    RectLight {
        center: Vec3::new(-0.1, 2.5, -1.27),
        u: Vec3::X * 0.3,
        v: Vec3::NEG_Z * 0.3,
        radiance: Radiance(Vec3::splat(10.0)),
        texture: None,
    }
}
