//! The light that arrives at a point from all directions.

use super::{Directional, HARMONICS, Harmonics};
use glam::Vec3;

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

    /// The coefficients of band 1 of one channel as a vector: it points to where most light comes from.
    pub(super) fn vector(&self, channel: usize) -> Vec3 {
        let [_, y, z, x, ..] = self.coefficients;
        Vec3::new(x[channel], y[channel], z[channel])
    }
}
