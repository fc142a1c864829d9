//! Light measured at points.

use crate::{ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site};
use glam::Vec3;
use lumel_sample::Frame;

/// Points at which light is measured; each is a node of its own.
///
/// Points that somebody asks for are no basis, as nothing can be read back between them; those
/// [at vertices](Self::at_vertices) measure the nodes of one.
#[derive(Clone, Debug)]
pub struct PointReceivers {
    identity: Identity,
    sites: Vec<Site>,
}

impl PointReceivers {
    /// Receivers at points with normals of any length but zero.
    ///
    /// The points are used as they are given. Put them on a surface or above it, not below.
    ///
    /// # Errors
    /// The index of the first point that is not finite or whose normal has no direction.
    pub fn new(points: impl IntoIterator<Item = (Vec3, Vec3)>) -> Result<Self, usize> {
        let site = |(i, (position, normal)): (usize, (Vec3, Vec3))| {
            let normal = normal.try_normalize().filter(|_| position.is_finite()).ok_or(i)?;
            let origin = lumel_scene::offset_along(position, normal);
            Ok(Site { origin, frame: Frame::from_normal(normal), skip: None })
        };
        let sites: Vec<Site> = points.into_iter().enumerate().map(site).collect::<Result<_, usize>>()?;
        let vectors = sites.iter().flat_map(|site| [site.origin, site.frame.normal]);
        let bytes: Vec<u8> = vectors.flat_map(|v| v.to_array().map(f32::to_le_bytes)).flatten().collect();
        Ok(Self::from_sites(Identity::new("points", [bytes.as_slice()]), sites))
    }

    /// Receivers at sites that `identity` tells from others.
    pub(crate) fn from_sites(identity: Identity, sites: Vec<Site>) -> Self {
        Self { identity, sites }
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
}
