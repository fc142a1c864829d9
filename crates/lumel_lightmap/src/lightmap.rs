//! Irradiance by lumel.

use crate::taps::taps;
use crate::{Dilation, Seams};
use glam::{DVec2, DVec3, Vec3};
use lumel_scene::{Irradiance, Scene, SurfacePoint};
use lumel_uv::{Atlas, Coverage};
use std::sync::Arc;

/// Light on the lumels of an atlas.
#[derive(Clone, Debug)]
pub struct Lightmap {
    /// Where the light of each surface is.
    pub atlas: Arc<Atlas>,
    /// By lumel of all pages: whether it was measured, outside geometry.
    pub valid: Vec<bool>,
    /// At least one: the first is all light.
    pub layers: Vec<LightmapLayer>,
}

/// A part of the light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightmapLayer {
    /// What it is: "irradiance", "direct", "bounce 1".
    pub name: String,
    /// Irradiance by lumel of all pages, W·m⁻², linear Rec. 709.
    pub values: Vec<Vec3>,
}

impl Lightmap {
    /// The light at a surface point, read bilinearly.
    ///
    /// # Panics
    /// If there is no such layer, or no such triangle in the atlas.
    pub fn at(&self, layer: usize, at: SurfacePoint) -> Irradiance {
        let weights = at.bary.weights().map(f64::from);
        let corners = self.atlas.corners(at.tri).map(|corner| corner.as_dvec2());
        let place: DVec2 = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight).sum();
        let values = &self.layers[layer].values;
        let read = |(lumel, weight): (usize, f64)| values[lumel].as_dvec3() * weight;
        let light: DVec3 = taps(&self.atlas, self.atlas.page(at.tri), place).into_iter().map(read).sum();
        Irradiance(light.as_vec3())
    }

    /// Closes the seams of all layers, and gives light to all lumels that were not measured.
    pub fn finish(&mut self, scene: &Scene, coverage: &Coverage) {
        let dilation = Dilation::new(&self.atlas, coverage, &self.valid);
        let seams = Seams::new(scene, &self.atlas, &dilation);
        for layer in &mut self.layers {
            seams.close(&mut layer.values);
            dilation.fill(&mut layer.values);
        }
    }
}
