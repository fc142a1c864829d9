//! Light on the lumels of an atlas, by direction.

use crate::{Lightmap, LumelLighting};
use glam::Vec3;
use lumel_basis::{Directional, HARMONICS, IncidentRadiance, Lighting};
use lumel_scene::{Irradiance, SurfacePoint};

/// A layer of a lightmap, and what is known of it by direction.
#[derive(Clone, Debug)]
pub struct LumelsByDirection<'a> {
    irradiance: LumelLighting<'a>,
    /// Coefficients by lumel; none where light is not known by direction.
    harmonics: Vec<&'a [Vec3]>,
}

impl Lightmap {
    /// The light of a layer, read bilinearly, as [`lighting`](Self::lighting) does, and for all light what is known of it by
    /// direction.
    ///
    /// # Panics
    /// If there is no such layer.
    pub fn by_direction(&self, layer: usize) -> LumelsByDirection<'_> {
        let of_all = self.layers.iter().filter(|_| layer == 0);
        let mut harmonics: Vec<_> =
            of_all.filter_map(|layer| Some((layer.harmonic()?, &*layer.values))).collect();
        harmonics.sort_unstable_by_key(|(harmonic, _)| *harmonic);
        let harmonics = harmonics.into_iter().map(|(_, values)| values).collect();
        LumelsByDirection { irradiance: self.lighting(layer), harmonics }
    }
}

impl LumelsByDirection<'_> {
    /// What is known of it by direction.
    pub fn kind(&self) -> Directional {
        Directional::of_channels(1 + self.harmonics.len()).unwrap_or_default()
    }
}

impl Lighting for LumelsByDirection<'_> {
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        self.irradiance.at(at)
    }

    fn incident(&self, at: SurfacePoint) -> Option<IncidentRadiance> {
        let mut coefficients = [Vec3::ZERO; HARMONICS];
        for (c, values) in coefficients.iter_mut().zip(&self.harmonics) {
            *c = LumelLighting { values, ..self.irradiance }.at(at).0;
        }
        IncidentRadiance::new(&coefficients[..self.harmonics.len().min(HARMONICS)])
    }
}
