//! Light measured at vertices.

use crate::area_receivers::reach_over;
use crate::points::Surroundings;
use crate::{Basis, PointReceivers, Site, VertexBasis};
use glam::DVec3;
use lumel_sample::Frame;
use lumel_scene::{Margins, Scene, TriId};
use std::sync::Arc;

/// How far a vertex's rays start inside its ring of triangles, as a share of the way to the ring's centre.
///
/// It puts the corners of a room inside the room: without it a corner vertex loses or leaks whole octants of its
/// hemisphere. A thousandth of a triangle is too little to shift the light.
const INSET: f64 = 1e-3;

/// They start at least this many [clearances](Margins::clearance) from the edges of the ring: beyond the rounding of the walls
/// that rise there.
const LEAST_INSET: f64 = 4.0;

/// But at most this share of the way: of triangles that are hardly wider than rounding, more would leave the ring.
const MOST_INSET: f64 = 0.25;

impl PointReceivers {
    /// Measures the nodes of a [`VertexBasis`] at their vertices.
    ///
    /// The error falls with the square of the edge length where light is smooth. A vertex inside other geometry sees
    /// back faces and is found invalid.
    pub fn at_vertices(basis: &Arc<VertexBasis>) -> Self {
        let rings = rings(basis);
        let sites = rings.iter().map(|ring| ring.site(basis.scene())).collect();
        let reaches = rings.iter().map(Ring::reach).collect();
        let surfaces = rings.iter().map(|ring| ring.last).collect();
        let surroundings = Surroundings { basis: basis.clone(), reaches, surfaces };
        Self::from_sites(basis.identity().derived("vertices"), sites, Some(surroundings))
    }
}

/// What the triangles around a node add up to.
#[derive(Clone, Copy)]
struct Ring {
    vertex: u32,
    triangles: u32,
    /// One of them.
    last: TriId,
    area: f64,
    /// The largest offset and clearance of its triangles, metres.
    offset: f64,
    clearance: f64,
    /// The least height of its triangles, metres.
    height: f64,
    weighted_centroid: DVec3,
    weighted_normal: DVec3,
}

fn rings(basis: &VertexBasis) -> Vec<Ring> {
    let zero = |&vertex: &u32| Ring {
        vertex,
        triangles: 0,
        last: TriId(0),
        area: 0.0,
        offset: 0.0,
        clearance: 0.0,
        height: f64::INFINITY,
        weighted_centroid: DVec3::ZERO,
        weighted_normal: DVec3::ZERO,
    };
    let mut rings: Vec<Ring> = basis.first_vertices().iter().map(zero).collect();
    let scene = basis.scene();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let [a, b, c] = scene.triangle_positions(tri).map(|p| p.as_dvec3());
        let normal = 0.5 * (b - a).cross(c - a);
        let area = normal.length();
        let Margins { offset, clearance } = scene.margins(tri);
        let height = scene.least_height(tri);
        for node in basis.nodes_of(tri) {
            let ring = &mut rings[node.index()];
            ring.triangles += 1;
            ring.last = tri;
            ring.area += area;
            ring.offset = ring.offset.max(offset);
            ring.clearance = ring.clearance.max(clearance);
            ring.height = ring.height.min(height);
            ring.weighted_centroid += (a + b + c) * (area / 3.0);
            ring.weighted_normal += normal;
        }
    }
    rings
}

impl Ring {
    fn reach(&self) -> f32 {
        reach_over((self.area / f64::from(self.triangles.max(1))) as f32)
    }

    fn site(&self, scene: &Scene) -> Site {
        let vertex = scene.positions()[self.vertex as usize].as_dvec3();
        let shading = scene.normals()[self.vertex as usize];
        let normal = self.weighted_normal.try_normalize().unwrap_or_else(|| shading.as_dvec3());
        // The centre of a triangle is a third of a height away from an edge.
        let inset = INSET.max(LEAST_INSET * 3.0 * self.clearance / self.height).min(MOST_INSET);
        let inward = inset * (self.weighted_centroid / self.area.max(f64::MIN_POSITIVE) - vertex);
        // Around a convex vertex the ring's centre lies below the tangent plane, inside the solid: start on the
        // plane instead, from which no ray of the hemisphere can enter it.
        let lifted = vertex + inward + normal * (-inward.dot(normal)).max(0.0);
        Site {
            origin: (lifted + normal * self.offset).as_vec3(),
            frame: Frame::from_normal(normal.as_vec3()),
            // Around a concave vertex the ring's triangles rise above the origin and are seen from it.
            skip: None,
        }
    }
}
