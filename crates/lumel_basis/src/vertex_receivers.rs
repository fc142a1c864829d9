//! Light measured at vertices.

use crate::{Basis, ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site, VertexBasis};
use glam::DVec3;
use lumel_sample::Frame;
use lumel_scene::{Scene, TriId, offset_along};

/// How far a vertex's rays start inside its ring of triangles, as a share of the way to the ring's centre.
///
/// It puts the corners of a room inside the room: without it a corner vertex loses or leaks whole octants of its
/// hemisphere. A thousandth of a triangle is too little to shift the light.
const INSET: f64 = 1e-3;

/// Measures the nodes of a [`VertexBasis`] at their vertices.
///
/// The error falls with the square of the edge length where light is smooth. A vertex inside other geometry sees back
/// faces and is found invalid.
#[derive(Clone, Debug)]
pub struct VertexReceivers {
    identity: Identity,
    sites: Vec<Site>,
}

impl VertexReceivers {
    /// Measures the nodes of `basis` at points.
    pub fn new(basis: &VertexBasis) -> Self {
        let scene = basis.scene();
        let site = |ring: &Ring| ring.site(scene);
        Self {
            identity: basis.identity().derived("vertices"),
            sites: rings(basis).iter().map(site).collect(),
        }
    }
}

impl Receivers for VertexReceivers {
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

    fn site(&self, element: ElementId, _u: [f32; 2], towards: &mut NodeWeights) -> Site {
        towards.push(NodeId(element.0), 1.0);
        self.sites[element.index()]
    }
}

/// What the triangles around a node add up to.
#[derive(Clone, Copy)]
struct Ring {
    vertex: u32,
    area: f64,
    weighted_centroid: DVec3,
    weighted_normal: DVec3,
}

fn rings(basis: &VertexBasis) -> Vec<Ring> {
    let zero = |&vertex: &u32| Ring {
        vertex,
        area: 0.0,
        weighted_centroid: DVec3::ZERO,
        weighted_normal: DVec3::ZERO,
    };
    let mut rings: Vec<Ring> = basis.first_vertices().iter().map(zero).collect();
    let scene = basis.scene();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let [a, b, c] = scene.triangle_positions(tri).map(|p| p.as_dvec3());
        let normal = 0.5 * (b - a).cross(c - a);
        let area = normal.length();
        for node in basis.nodes_of(tri) {
            let ring = &mut rings[node.index()];
            ring.area += area;
            ring.weighted_centroid += (a + b + c) * (area / 3.0);
            ring.weighted_normal += normal;
        }
    }
    rings
}

impl Ring {
    fn site(&self, scene: &Scene) -> Site {
        let vertex = scene.positions()[self.vertex as usize].as_dvec3();
        let shading = scene.normals()[self.vertex as usize];
        let normal = self.weighted_normal.try_normalize().unwrap_or_else(|| shading.as_dvec3());
        let inward = INSET * (self.weighted_centroid / self.area.max(f64::MIN_POSITIVE) - vertex);
        // Around a convex vertex the ring's centre lies below the tangent plane, inside the solid: start on the
        // plane instead, from which no ray of the hemisphere can enter it.
        let lifted = vertex + inward + normal * (-inward.dot(normal)).max(0.0);
        let normal = normal.as_vec3();
        Site {
            origin: offset_along(lifted.as_vec3(), normal),
            frame: Frame::from_normal(normal),
            // Around a concave vertex the ring's triangles rise above the origin and are seen from it.
            skip: None,
        }
    }
}
