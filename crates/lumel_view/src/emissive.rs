//! Surfaces that emit light.

use glam::{DVec3, Vec3};
use lumel::Scene;
use lumel_scene::{Barycentrics, SurfacePoint, TriId};

const MIDDLE: Barycentrics = Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 };

/// The emissive surfaces of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct EmissiveMaterial {
    /// Its name.
    pub material: String,
    /// Area of both sides where both emit, m².
    pub area: f64,
    /// Power of each channel, W, by the radiance in the middle of each triangle.
    pub power: Vec3,
}

/// What emits in a scene, by material, the strongest first.
pub fn emissive_materials(scene: &Scene) -> Vec<EmissiveMaterial> {
    let mut sums = vec![(0.0, DVec3::ZERO); scene.materials().len()];
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        if scene.material(tri).emits() {
            let area = f64::from(scene.area(tri));
            let radiance = scene.emission(SurfacePoint { tri, bary: MIDDLE });
            let (areas, power) = &mut sums[scene.material_id(tri).0 as usize];
            *areas += area;
            *power += radiance.power(1.0).as_dvec3() * area;
        }
    }
    let named = scene.materials().iter().map(|material| material.name.clone()).zip(sums);
    let mut all: Vec<_> = named
        .filter(|(_, (area, _))| *area > 0.0)
        .map(|(material, (area, power))| EmissiveMaterial { material, area, power: power.as_vec3() })
        .collect();
    all.sort_by(|a, b| b.power.element_sum().total_cmp(&a.power.element_sum()));
    all
}
