//! The light that arrives at a point from all directions.

use super::{Directional, HARMONICS, Harmonics};
use glam::Vec3;
use lumel_scene::luminance;

/// Coefficients `c_lm = ∫ L Y_lm dω` of the radiance that arrives at a point, in world space, W·m⁻².
///
/// The hemisphere is that above the surface; what lies below is dark. [`Shading`](super::Shading) reads irradiance for
/// normals that are tilted from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncidentRadiance {
    /// Zero in bands that are not known.
    coefficients: Harmonics<Vec3>,
    kind: Directional,
}

impl IncidentRadiance {
    /// From four or nine coefficients, in the order of [`Harmonics`]; `None` for any other number of them.
    pub fn new(coefficients: &[Vec3]) -> Option<Self> {
        let kind = Directional::of_channels(coefficients.len() + 1).filter(|kind| kind.harmonics() > 0)?;
        let mut all = [Vec3::ZERO; HARMONICS];
        all[..coefficients.len()].copy_from_slice(coefficients);
        Some(Self { coefficients: all, kind })
    }

    /// What is known: [`Directional::Sh1`] or [`Directional::Sh2`].
    pub fn kind(&self) -> Directional {
        self.kind
    }

    /// All coefficients; those of bands that are not known are zero.
    pub fn coefficients(&self) -> &Harmonics<Vec3> {
        &self.coefficients
    }

    /// Where most light comes from, by luminance: a vector as long as the share of the light that comes from one direction,
    /// 1 for all of it and ½ for an even sky; zero where there is no light.
    pub fn dominant(&self) -> Vec3 {
        let [c00, y, z, x, ..] = self.coefficients.map(luminance);
        // A direction has √3 times as much in band 1 as in band 0.
        let dominant = Vec3::new(x, y, z) / (3_f32.sqrt() * c00);
        if c00 > 0.0 { dominant } else { Vec3::ZERO }
    }

    /// The coefficients of band 1 of one channel as a vector: it points to where most light comes from.
    pub(super) fn vector(&self, channel: usize) -> Vec3 {
        let [_, y, z, x, ..] = self.coefficients;
        Vec3::new(x[channel], y[channel], z[channel])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spherical_harmonics;

    #[test]
    fn most_light_comes_from_where_it_does() {
        let direction = Vec3::new(0.36, -0.48, 0.8);
        let beam: Vec<Vec3> =
            spherical_harmonics(direction)[..4].iter().map(|y| Vec3::splat(2.0 * y)).collect();
        let dominant = IncidentRadiance::new(&beam).map(|light| light.dominant());
        assert!(dominant.is_some_and(|dominant| (dominant - direction).length() < 1e-6), "{dominant:?}");
        let sky = [1.772_453_9, 0.0, 1.534_990_1, 0.0].map(Vec3::splat);
        let dominant = IncidentRadiance::new(&sky).map(|light| light.dominant());
        assert!(dominant.is_some_and(|dominant| (dominant - 0.5 * Vec3::Z).length() < 1e-6), "{dominant:?}");
        assert_eq!(IncidentRadiance::new(&[Vec3::ZERO; 9]).map(|light| light.dominant()), Some(Vec3::ZERO));
    }
}
