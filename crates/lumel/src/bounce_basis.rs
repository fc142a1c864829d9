//! What bounces are carried on.

use lumel_basis::{Adjacency, Basis, Hierarchy, Identity, MeshlessBasis, NodeId, NodeWeights, VertexBasis};
use lumel_scene::SurfacePoint;
use std::sync::Arc;

/// The basis that a solve carries light in from bounce to bounce.
#[derive(Clone, Debug)]
pub enum BounceBasis {
    /// Piecewise linear functions on the vertices.
    Vertices(Arc<VertexBasis>),
    /// Kernels around scattered points.
    Points {
        /// The points.
        points: Arc<MeshlessBasis>,
        /// What holds direct light, where there are more vertices than points.
        direct: Option<Arc<VertexBasis>>,
    },
}

impl BounceBasis {
    /// The vertices, where light is carried on these.
    pub fn vertices(&self) -> Option<&Arc<VertexBasis>> {
        match self {
            Self::Vertices(basis) => Some(basis),
            Self::Points { .. } => None,
        }
    }

    /// The points, where light is carried on these.
    pub fn points(&self) -> Option<&Arc<MeshlessBasis>> {
        match self {
            Self::Vertices(_) => None,
            Self::Points { points, .. } => Some(points),
        }
    }

    fn any(&self) -> &dyn Basis {
        match self {
            Self::Vertices(basis) => &**basis,
            Self::Points { points, .. } => &**points,
        }
    }
}

impl Basis for BounceBasis {
    fn identity(&self) -> Identity {
        let identity = self.any().identity();
        match self.direct() {
            None => identity,
            Some(direct) => {
                let parts = [identity, direct.identity()];
                Identity::new("direct light apart", parts.iter().map(|part| &part.as_bytes()[..]))
            }
        }
    }

    fn node_count(&self) -> usize {
        self.any().node_count()
    }

    #[inline]
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        // Asked for by every ray: without a call where light is at vertices.
        match self {
            Self::Vertices(basis) => basis.weights_at(at, weights),
            Self::Points { points, .. } => points.weights_at(at, weights),
        }
    }

    fn corner_nodes(&self) -> Option<&[[NodeId; 3]]> {
        self.any().corner_nodes()
    }

    fn node_areas(&self) -> &[f32] {
        self.any().node_areas()
    }

    fn adjacency(&self) -> &Adjacency {
        self.any().adjacency()
    }

    fn hierarchy(&self) -> Option<&dyn Hierarchy> {
        self.any().hierarchy()
    }

    fn direct(&self) -> Option<&dyn Basis> {
        match self {
            Self::Vertices(_) | Self::Points { direct: None, .. } => None,
            Self::Points { direct: Some(direct), .. } => Some(&**direct),
        }
    }

    fn resolution(&self) -> f32 {
        self.any().resolution()
    }
}
