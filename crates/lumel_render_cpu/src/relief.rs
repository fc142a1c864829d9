//! Which normals are shown, and how light on them is found.

use crate::names::named;
use glam::{Vec2, Vec3};
use lumel_basis::{Lighting, Shading};
use lumel_scene::{Irradiance, Scene, SurfacePoint};

/// Whether normal maps are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalMaps {
    /// Surfaces are as smooth as their meshes.
    Off,
    /// As files have them: green points up.
    #[default]
    Up,
    /// For files whose green points down.
    Down,
}

named!(NormalMaps, "normal maps", Off = "off", Up = "up", Down = "down");

/// Which normals are shown, and how irradiance on them is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Relief {
    /// Whether normal maps are shown.
    pub maps: NormalMaps,
    /// How light that is known by direction lights tilted normals. Other light does not depend on them.
    pub shading: Shading,
}

impl Relief {
    /// The normal of a surface point with its normal map, if it has one that is shown.
    fn mapped(&self, scene: &Scene, at: SurfacePoint) -> Option<Vec3> {
        let scale = match self.maps {
            NormalMaps::Off => return None,
            NormalMaps::Up => Vec2::ONE,
            NormalMaps::Down => Vec2::new(1.0, -1.0),
        };
        scene.mapped_normal(at, scale)
    }

    /// The unit normal that is shown.
    pub(crate) fn normal(&self, scene: &Scene, at: SurfacePoint) -> Vec3 {
        self.mapped(scene, at).unwrap_or_else(|| scene.shading_normal(at))
    }

    /// The light that arrives at a surface point.
    pub(crate) fn irradiance(&self, scene: &Scene, lighting: &dyn Lighting, at: SurfacePoint) -> Irradiance {
        let flat = scene.shading_normal(at);
        let Some(normal) = self.mapped(scene, at) else { return lighting.irradiance(at, flat) };
        match lighting.incident(at) {
            Some(light) => self.shading.shade(lighting.irradiance(at, flat), &light, flat, normal),
            None => lighting.irradiance(at, normal),
        }
    }
}
