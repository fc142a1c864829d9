//! Light as pictures and files read it.

use crate::{Basis, Field, NodeWeights};
use glam::Vec3;
use lumel_scene::{Irradiance, SurfacePoint};

/// Light on the surfaces of a scene, however it is stored.
///
/// Renderers and writers read light through this and know no vertices, lumels or nodes.
pub trait Lighting: Sync {
    /// The light that arrives at a surface point with this unit normal.
    ///
    /// The normal is that of the surface as it is to look; where only irradiance is stored it makes no difference.
    fn irradiance(&self, at: SurfacePoint, normal: Vec3) -> Irradiance;
}

/// A field in its basis.
#[derive(Clone, Copy)]
pub struct FieldLighting<'a> {
    /// The basis.
    pub basis: &'a dyn Basis,
    /// Its coefficients.
    pub field: &'a Field,
}

impl Lighting for FieldLighting<'_> {
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        self.field.at(self.basis, at, &mut NodeWeights::default())
    }
}
