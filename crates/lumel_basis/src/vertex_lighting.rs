//! Light that is stored at the vertices of a scene.

use crate::{Coefficients, IncidentRadiance, Lighting};
use glam::Vec3;
use lumel_scene::{Irradiance, Scene, SurfacePoint};

/// Light at the vertices of a scene, linear over its triangles.
#[derive(Clone, Copy, Debug)]
pub struct VertexLighting<'a> {
    scene: &'a Scene,
    values: &'a [Vec3],
    coefficients: Option<&'a Coefficients>,
}

/// Light at the vertices of a different scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("light at {values} vertices does not belong to a scene with {vertices} vertices")]
pub struct VertexCountError {
    /// Number of vertices with light.
    pub values: usize,
    /// Number of vertices of the scene.
    pub vertices: usize,
}

impl VertexCountError {
    /// Checks that there are as many values as vertices.
    ///
    /// # Errors
    /// Both numbers, if they differ.
    pub fn check(values: usize, vertices: usize) -> Result<(), Self> {
        if values == vertices { Ok(()) } else { Err(Self { values, vertices }) }
    }
}

impl<'a> VertexLighting<'a> {
    /// `values` is the irradiance at every vertex of the scene, W·m⁻².
    ///
    /// # Errors
    /// [`VertexCountError`] unless there are as many values as vertices.
    pub fn new(scene: &'a Scene, values: &'a [Vec3]) -> Result<Self, VertexCountError> {
        VertexCountError::check(values.len(), scene.vertex_count())?;
        Ok(Self { scene, values, coefficients: None })
    }

    /// The same light with what is known of it by direction at every vertex.
    ///
    /// # Errors
    /// [`VertexCountError`] unless that is at as many vertices.
    pub fn with_incident(self, coefficients: Option<&'a Coefficients>) -> Result<Self, VertexCountError> {
        if let Some(coefficients) = coefficients {
            VertexCountError::check(coefficients.len(), self.values.len())?;
        }
        Ok(Self { coefficients, ..self })
    }

    /// The light at a surface point.
    #[inline]
    pub fn at(&self, at: SurfacePoint) -> Irradiance {
        let corners = self.scene.triangle(at.tri);
        let weighted = corners.into_iter().zip(at.bary.weights());
        weighted.map(|(vertex, weight)| Irradiance(self.values[vertex as usize]) * weight).sum()
    }
}

impl Lighting for VertexLighting<'_> {
    #[inline]
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        self.at(at)
    }

    fn incident(&self, at: SurfacePoint) -> Option<IncidentRadiance> {
        self.coefficients?.at(self.scene, at)
    }

    fn vertex_values(&self) -> Option<&[Vec3]> {
        Some(self.values)
    }
}
