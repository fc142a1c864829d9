//! Light as pictures and files read it.

use crate::{Basis, Directional, Field, HARMONICS, IncidentRadiance, NodeWeights};
use glam::Vec3;
use lumel_scene::{Irradiance, SurfacePoint};

/// Light on the surfaces of a scene, however it is stored.
///
/// Renderers and writers read light through this and know no vertices, lumels or nodes. A closure
/// `Fn(SurfacePoint, Vec3) -> Irradiance` is one, [`VertexLighting`](crate::VertexLighting) is what solutions and
/// files hold, and [`FieldLighting`] reads a field of any basis.
pub trait Lighting: Sync {
    /// The light that arrives on the lit side of a surface point with this unit normal.
    ///
    /// Triangles are those of the scene, back sides included. The normal is the one that is shown, from vertex normals
    /// and normal maps; where only irradiance is stored it makes no difference.
    fn irradiance(&self, at: SurfacePoint, normal: Vec3) -> Irradiance;

    /// The light that arrives at a surface point by direction, where it is known.
    ///
    /// What is drawn reads irradiance for tilted normals from it, by a [`Shading`](crate::Shading).
    fn incident(&self, at: SurfacePoint) -> Option<IncidentRadiance> {
        let _ = at;
        None
    }

    /// Irradiance at each vertex of the scene, W·m⁻², for light that is stored there and linear over the triangles.
    ///
    /// A fast path: [`irradiance_at_vertices`](crate::irradiance_at_vertices) samples all other light.
    fn vertex_values(&self) -> Option<&[Vec3]> {
        None
    }
}

impl<F: Fn(SurfacePoint, Vec3) -> Irradiance + Sync> Lighting for F {
    fn irradiance(&self, at: SurfacePoint, normal: Vec3) -> Irradiance {
        self(at, normal)
    }
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

    fn incident(&self, at: SurfacePoint) -> Option<IncidentRadiance> {
        let kind = Directional::of_channels(self.field.channels())?;
        let (mut weights, mut sums) = (NodeWeights::default(), [Vec3::ZERO; HARMONICS]);
        self.basis.weights_at(at, &mut weights);
        for (node, weight) in weights.iter() {
            let coefficients = &self.field.coefficients(node)[1..];
            sums.iter_mut().zip(coefficients).for_each(|(sum, c)| *sum += *c * weight);
        }
        IncidentRadiance::new(&sums[..kind.harmonics()])
    }
}
