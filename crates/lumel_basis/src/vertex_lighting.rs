//! Light that is stored at the vertices of a scene.

use crate::{Directional, HARMONICS, IncidentRadiance, Lighting};
use glam::Vec3;
use lumel_scene::{Irradiance, Scene, SurfacePoint};

/// Light at the vertices of a scene, linear over its triangles.
#[derive(Clone, Copy, Debug)]
pub struct VertexLighting<'a> {
    scene: &'a Scene,
    values: &'a [Vec3],
    kind: Directional,
    /// Of all vertices, those of each side by side.
    coefficients: &'a [Vec3],
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
        Ok(Self { scene, values, kind: Directional::Off, coefficients: &[] })
    }

    /// The same light with the coefficients of [`IncidentRadiance`] at every vertex, those of a vertex side by side.
    ///
    /// # Errors
    /// [`VertexCountError`] unless there are as many as `kind` has for each vertex.
    pub fn with_incident(
        self,
        kind: Directional,
        coefficients: &'a [Vec3],
    ) -> Result<Self, VertexCountError> {
        let each = kind.harmonics();
        if coefficients.len() != each * self.values.len() {
            let values = coefficients.len() / each.max(1);
            return Err(VertexCountError { values, vertices: self.values.len() });
        }
        Ok(Self { kind, coefficients, ..self })
    }
}

impl Lighting for VertexLighting<'_> {
    #[inline]
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        let corners = self.scene.triangle(at.tri);
        let weighted = corners.into_iter().zip(at.bary.weights());
        weighted.map(|(vertex, weight)| Irradiance(self.values[vertex as usize]) * weight).sum()
    }

    fn incident(&self, at: SurfacePoint) -> Option<IncidentRadiance> {
        let (each, mut sums) = (self.kind.harmonics(), [Vec3::ZERO; HARMONICS]);
        for (vertex, weight) in self.scene.triangle(at.tri).into_iter().zip(at.bary.weights()) {
            let of_vertex = &self.coefficients[vertex as usize * each..][..each];
            sums.iter_mut().zip(of_vertex).for_each(|(sum, c)| *sum += *c * weight);
        }
        IncidentRadiance::new(&sums[..each])
    }

    fn vertex_values(&self) -> Option<&[Vec3]> {
        Some(self.values)
    }
}
