//! Reading fields at the vertices of a scene.

use crate::{Basis, Field, NodeWeights};
use glam::Vec3;
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};

/// A surface point for each vertex of a scene: where fields of any basis are read for files of vertices.
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
        let mut weights = NodeWeights::default();
        self.0.iter().map(|&at| field.at(basis, at, &mut weights).0).collect()
    }

    /// Whether `flags` hold at all nodes that a vertex is read from; a node without a flag counts as true.
    pub fn all(&self, basis: &dyn Basis, flags: &[bool]) -> Vec<bool> {
        let mut weights = NodeWeights::default();
        let mut all = |&at: &SurfacePoint| {
            weights.clear();
            basis.weights_at(at, &mut weights);
            let flag = |node: usize| flags.get(node).copied().unwrap_or(true);
            weights.iter().filter(|(_, weight)| *weight > 0.0).all(|(node, _)| flag(node.index()))
        };
        self.0.iter().map(&mut all).collect()
    }
}
