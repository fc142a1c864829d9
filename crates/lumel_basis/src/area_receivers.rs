//! Light measured over the triangles around vertices.

use crate::{Basis, ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site, VertexBasis};
use lumel_sample::{Frame, uniform_triangle};
use lumel_scene::{SurfacePoint, TriId, offset_along};
use std::sync::Arc;

/// Measures the nodes of a [`VertexBasis`] over the support of each hat function B: `∫BE dA / ∫B dA`.
///
/// That is the least-squares projection with the mass matrix lumped to its row sums. It conserves power and needs
/// no vertex to be visible, but it is smoother than the light: its error falls with the edge length to the power
/// 1.5 only, because the average at a border is taken off-centre.
#[derive(Clone, Debug)]
pub struct AreaReceivers {
    basis: Arc<VertexBasis>,
}

impl AreaReceivers {
    /// Measures the nodes of `basis` over areas.
    pub fn new(basis: Arc<VertexBasis>) -> Self {
        Self { basis }
    }
}

impl Receivers for AreaReceivers {
    fn identity(&self) -> Identity {
        self.basis.identity().derived("areas of vertices")
    }

    fn node_count(&self) -> usize {
        self.basis.node_count()
    }

    /// The triangles, back sides included.
    fn element_count(&self) -> usize {
        self.basis.scene().triangle_count()
    }

    fn sampling(&self) -> Sampling {
        Sampling::Area
    }

    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>) {
        nodes.extend(self.basis.nodes_of(TriId(element.0)));
    }

    fn site(&self, element: ElementId, u: [f32; 2], towards: &mut NodeWeights) -> Site {
        let scene = self.basis.scene();
        let tri = TriId(element.0);
        let at = SurfacePoint { tri, bary: uniform_triangle(u).into() };
        let area = scene.area(tri);
        for (node, weight) in self.basis.nodes_of(tri).into_iter().zip(at.bary.weights()) {
            towards.push(node, weight * area);
        }
        let normal = scene.geometric_normal(tri);
        Site {
            origin: offset_along(scene.position(at), normal),
            frame: Frame::from_normal(normal),
            skip: Some(scene.traced(tri)),
        }
    }
}
