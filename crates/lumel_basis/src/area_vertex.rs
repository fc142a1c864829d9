//! One coefficient per vertex, measured over the triangles around it.

use crate::{Basis, ElementId, Field, Measure, NodeId, NodeWeights, Receivers, Site, VertexBasis};
use lumel_sample::{Frame, uniform_triangle};
use lumel_scene::{SurfacePoint, TriId, offset_along};

/// The nodes of a [`VertexBasis`], measured over the support of each hat function B: `∫BE dA / ∫B dA`.
///
/// That is the least-squares projection with the mass matrix lumped to its row sums. It conserves power and needs
/// no vertex to be visible, but it is smoother than the light: its error falls with the edge length to the power
/// 1.5 only, because the average at a border is taken off-centre.
#[derive(Clone, Debug)]
pub struct AreaVertexBasis(VertexBasis);

impl AreaVertexBasis {
    /// Measures the nodes of `basis` over areas.
    pub fn new(basis: VertexBasis) -> Self {
        Self(basis)
    }
}

impl Receivers for AreaVertexBasis {
    fn node_count(&self) -> usize {
        self.0.node_count()
    }

    /// The triangles, back sides included.
    fn element_count(&self) -> usize {
        self.0.scene().triangle_count()
    }

    fn measure(&self) -> Measure {
        Measure::OverArea
    }

    fn receiver(&self, e: ElementId, u: [f32; 2], counts_towards: &mut NodeWeights) -> Site {
        let scene = self.0.scene();
        let tri = TriId(e.0);
        let at = SurfacePoint { tri, bary: uniform_triangle(u).into() };
        let area = scene.area(tri);
        for (node, weight) in self.0.nodes_of(tri).into_iter().zip(at.bary.weights()) {
            counts_towards.push(node, weight * area);
        }
        let normal = scene.geometric_normal(tri);
        Site {
            origin: offset_along(scene.position(at), normal),
            frame: Frame::from_normal(normal),
            skip: Some(scene.traced(tri)),
        }
    }
}

impl Basis for AreaVertexBasis {
    #[inline]
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        self.0.weights_at(at, weights);
    }

    fn corner_nodes(&self, tri: TriId) -> Option<[NodeId; 3]> {
        self.0.corner_nodes(tri)
    }

    fn node_areas(&self) -> Vec<f32> {
        self.0.node_areas()
    }

    fn fill(&self, field: &mut Field, known: &[bool]) {
        self.0.fill(field, known);
    }

    fn node_of_vertex(&self) -> &[NodeId] {
        self.0.node_of_vertex()
    }
}
