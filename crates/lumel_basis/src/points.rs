//! Light measured at points.

use crate::{Basis, ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site};
use glam::{DVec3, Vec3};
use lumel_sample::Frame;
use lumel_scene::{Scene, SurfacePoint, TriId};
use std::fmt;
use std::sync::Arc;

/// Points at which light is measured; each is a node of its own.
///
/// Points that somebody asks for are no basis, as nothing can be read back between them; those
/// [at vertices](Self::at_vertices) and [at nodes](Self::at_nodes) measure those of one.
#[derive(Clone, Debug)]
pub struct PointReceivers {
    identity: Identity,
    sites: Vec<Site>,
    /// If they are the nodes of a basis.
    surroundings: Option<Surroundings>,
}

/// What is around points that are the nodes of a basis.
#[derive(Clone)]
pub(crate) struct Surroundings {
    pub(crate) basis: Arc<dyn Basis>,
    /// [`Receivers::reach`] of each.
    pub(crate) reaches: Vec<f32>,
    /// A triangle that each lies on.
    pub(crate) surfaces: Vec<TriId>,
}

impl fmt::Debug for Surroundings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Surroundings").field("basis", &self.basis.identity()).finish_non_exhaustive()
    }
}

impl PointReceivers {
    /// Receivers at points in world space with normals of any length but zero.
    ///
    /// Put the points on a surface or above it, not below: all that is allowed for is the
    /// [rounding](Scene::ray_origin_at) of their coordinates.
    ///
    /// # Errors
    /// The index of the first point that is not finite or whose normal has no direction.
    pub fn new<P: Into<DVec3>>(
        scene: &Scene,
        points: impl IntoIterator<Item = (P, Vec3)>,
    ) -> Result<Self, usize> {
        Self::with_origins(points, |position, normal| scene.ray_origin_at(position.into(), normal))
    }

    /// Receivers at points of a scene's surfaces with normals of any length but zero.
    ///
    /// # Errors
    /// The index of the first point whose normal has no direction.
    pub fn on_surfaces(
        scene: &Scene,
        points: impl IntoIterator<Item = (SurfacePoint, Vec3)>,
    ) -> Result<Self, usize> {
        Self::with_origins(points, |at, _| scene.ray_origin(at))
    }

    fn with_origins<P>(
        points: impl IntoIterator<Item = (P, Vec3)>,
        origin: impl Fn(P, Vec3) -> Vec3,
    ) -> Result<Self, usize> {
        let site = |(i, (point, normal)): (usize, (P, Vec3))| {
            let normal = normal.try_normalize().ok_or(i)?;
            let origin = Some(origin(point, normal)).filter(|origin| origin.is_finite()).ok_or(i)?;
            Ok(Site { origin, frame: Frame::from_normal(normal), skip: None })
        };
        let sites: Vec<Site> = points.into_iter().enumerate().map(site).collect::<Result<_, usize>>()?;
        let vectors = sites.iter().flat_map(|site| [site.origin, site.frame.normal]);
        let bytes: Vec<u8> = vectors.flat_map(|v| v.to_array().map(f32::to_le_bytes)).flatten().collect();
        Ok(Self::from_sites(Identity::new("points", [bytes.as_slice()]), sites, None))
    }

    /// Receivers at sites that `identity` tells from others.
    pub(crate) fn from_sites(
        identity: Identity,
        sites: Vec<Site>,
        surroundings: Option<Surroundings>,
    ) -> Self {
        Self { identity, sites, surroundings }
    }
}

impl Receivers for PointReceivers {
    fn identity(&self) -> Identity {
        self.identity
    }

    fn node_count(&self) -> usize {
        self.sites.len()
    }

    fn element_count(&self) -> usize {
        self.sites.len()
    }

    fn sampling(&self) -> Sampling {
        Sampling::Point
    }

    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>) {
        nodes.push(NodeId(element.0));
    }

    fn site(&self, element: ElementId, _: [f32; 2]) -> Site {
        self.sites[element.index()]
    }

    fn towards(&self, element: ElementId, _: [f32; 2], nodes: &mut NodeWeights) {
        nodes.push(NodeId(element.0), 1.0);
    }

    fn reach(&self, element: ElementId) -> f32 {
        self.surroundings.as_ref().map_or(0.0, |around| around.reaches[element.index()])
    }

    fn surface(&self, element: ElementId) -> Option<TriId> {
        self.surroundings.as_ref().map(|around| around.surfaces[element.index()])
    }

    fn beside(&self, element: ElementId, origins: &mut Vec<Vec3>) {
        let Some(Surroundings { basis, .. }) = &self.surroundings else { return };
        let beside = basis.adjacency().neighbours(NodeId(element.0));
        origins.extend(beside.map(|(neighbour, _)| self.sites[neighbour.index()].origin));
    }
}
