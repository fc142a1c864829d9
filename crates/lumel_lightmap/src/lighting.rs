//! Lumels as pictures and files read them.

use crate::Filter;
use crate::taps::taps_of;
use glam::{DVec2, DVec3, Vec3};
use lumel_basis::Lighting;
use lumel_scene::{Irradiance, SurfacePoint};
use lumel_uv::Atlas;

/// Light on lumels, read between them.
///
/// The atlas is that of the scene that is read, or a [refined](Atlas::refined) one if its triangles were split.
#[derive(Clone, Copy, Debug)]
pub struct LumelLighting<'a> {
    /// Where the light of each triangle is.
    pub atlas: &'a Atlas,
    /// Irradiance by lumel of all pages, W·m⁻².
    pub values: &'a [Vec3],
    /// How it is read.
    pub filter: Filter,
}

impl LumelLighting<'_> {
    /// The light at a surface point.
    ///
    /// # Panics
    /// If there are fewer values than lumels, or no such triangle in the atlas.
    pub fn at(&self, at: SurfacePoint) -> Irradiance {
        let weights = at.bary.weights().map(f64::from);
        let corners = self.atlas.corners(at.tri).map(|corner| corner.as_dvec2());
        let place: DVec2 = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight).sum();
        let read = |(lumel, weight): (usize, f64)| self.values[lumel].as_dvec3() * weight;
        let taps = taps_of(self.filter, self.atlas, self.atlas.page(at.tri), place);
        Irradiance(taps.into_iter().map(read).sum::<DVec3>().as_vec3())
    }
}

impl Lighting for LumelLighting<'_> {
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        self.at(at)
    }
}
