//! Reading light at the vertices of a scene.

use crate::{
    Basis, Coefficients, Directional, Field, IncidentRadiance, Lighting, NodeWeights, VertexCountError,
};
use glam::Vec3;
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};
use rayon::prelude::*;
use std::borrow::Cow;

/// Irradiance at every vertex of a scene, W·m⁻²: what is stored there, or samples at [`VertexPoints`] with the normals
/// of the vertices.
///
/// Light that is not linear over the triangles loses what lies between their vertices.
///
/// # Errors
/// [`VertexCountError`] for light that is stored at the vertices of a different scene.
pub fn irradiance_at_vertices<'a>(
    scene: &Scene,
    lighting: &'a dyn Lighting,
) -> Result<Cow<'a, [Vec3]>, VertexCountError> {
    if let Some(values) = lighting.vertex_values() {
        VertexCountError::check(values.len(), scene.vertex_count())?;
        return Ok(Cow::Borrowed(values));
    }
    let points = VertexPoints::new(scene);
    let samples = points.points().iter().zip(scene.normals());
    Ok(Cow::Owned(samples.map(|(&at, &normal)| lighting.irradiance(at, normal).0).collect()))
}

/// Light by direction at every vertex of a scene, as [`irradiance_at_vertices`] reads irradiance; `None` if it is not known
/// everywhere.
pub fn incident_at_vertices(scene: &Scene, lighting: &dyn Lighting) -> Option<Vec<IncidentRadiance>> {
    // Most light is known by direction nowhere: one point tells.
    lighting.incident(SurfacePoint { tri: TriId(0), bary: Barycentrics::CORNERS[0] })?;
    VertexPoints::new(scene).points().iter().map(|&at| lighting.incident(at)).collect()
}

/// A surface point for each vertex of a scene: where light of any kind is read for files of vertices.
///
/// Every vertex is a corner of some triangle. Where a basis is discontinuous between triangles, the first triangle
/// around a vertex decides.
#[derive(Clone, Debug)]
pub struct VertexPoints(Vec<SurfacePoint>);

impl VertexPoints {
    /// The points of a scene.
    pub fn new(scene: &Scene) -> Self {
        let unused = SurfacePoint { tri: TriId(u32::MAX), bary: Barycentrics::CORNERS[0] };
        let mut points = vec![unused; scene.vertex_count()];
        for (tri, vertices) in (0..).map(TriId).zip(scene.triangles()) {
            for (&vertex, bary) in vertices.iter().zip(Barycentrics::CORNERS) {
                let point = &mut points[vertex as usize];
                if point.tri == unused.tri {
                    *point = SurfacePoint { tri, bary };
                }
            }
        }
        Self(points)
    }

    /// The points, one per vertex.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.0
    }

    /// Irradiance of a field at every vertex, W·m⁻².
    pub fn read(&self, basis: &dyn Basis, field: &Field) -> Vec<Vec3> {
        let value = |weights: &mut NodeWeights, &at: &SurfacePoint| field.at(basis, at, weights).0;
        self.0.par_iter().map_init(NodeWeights::default, value).collect()
    }

    /// The coefficients of harmonics of a field at every vertex; `None` for a field of irradiance alone.
    pub fn read_directional(&self, basis: &dyn Basis, field: &Field) -> Option<Coefficients> {
        let kind = Directional::of_channels(field.channels()).filter(|kind| *kind != Directional::Off)?;
        let (mut weights, mut values) = (NodeWeights::default(), Vec::new());
        values.reserve_exact(self.0.len() * kind.harmonics());
        for &at in &self.0 {
            weights.clear();
            basis.weights_at(at, &mut weights);
            values.extend((1..field.channels()).map(|channel| {
                let part = |(node, weight)| field.coefficients(node)[channel] * weight;
                weights.iter().map(part).sum::<Vec3>()
            }));
        }
        Coefficients::new(kind, values)
    }

    /// The share of the weights of the nodes that a vertex is read from at which `flags` hold; a node without a flag counts as true.
    pub fn share(&self, basis: &dyn Basis, flags: &[bool]) -> Vec<f32> {
        let share = |weights: &mut NodeWeights, &at: &SurfacePoint| {
            weights.clear();
            basis.weights_at(at, weights);
            let all: f32 = weights.iter().map(|(_, weight)| weight).sum();
            let flag = |node: usize| flags.get(node).copied().unwrap_or(true);
            let held = weights.iter().filter(|(node, _)| flag(node.index())).map(|(_, weight)| weight);
            held.sum::<f32>() / all
        };
        self.0.par_iter().map_init(NodeWeights::default, share).collect()
    }

    /// Whether `flags` hold at all nodes that a vertex is read from; a node without a flag counts as true.
    pub fn all(&self, basis: &dyn Basis, flags: &[bool]) -> Vec<bool> {
        let all = |weights: &mut NodeWeights, &at: &SurfacePoint| {
            weights.clear();
            basis.weights_at(at, weights);
            let flag = |node: usize| flags.get(node).copied().unwrap_or(true);
            weights.iter().filter(|(_, weight)| *weight > 0.0).all(|(node, _)| flag(node.index()))
        };
        self.0.par_iter().map_init(NodeWeights::default, all).collect()
    }
}
