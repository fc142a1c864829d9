//! One coefficient per vertex, measured at the vertex, linear in between.

use crate::{Basis, ElementId, Field, Measure, NodeId, NodeWeights, Receivers, Site};
use glam::{DVec3, Vec3};
use lumel_sample::Frame;
use lumel_scene::{Scene, SurfacePoint, TriId, offset_along};
use std::collections::HashMap;
use std::sync::Arc;

/// How far a vertex's rays start inside its ring of triangles, as a share of the way to the ring's centre.
///
/// It puts the corners of a room inside the room: without it a corner vertex loses or leaks whole octants of its
/// hemisphere. A thousandth of a triangle is too little to shift the light.
const INSET: f64 = 1e-3;

/// Vertices at one position whose normals agree to this cosine (2.6°) share a node, whatever their texture
/// coordinates or materials: the irradiance there is the same.
const SAME_NORMAL_COS: f32 = 0.999;

/// The piecewise linear basis on the vertices of a scene, point-sampled.
///
/// Its error falls with the square of the edge length where light is smooth; a vertex inside other geometry is
/// measured as invalid and gets the mean of its neighbours.
#[derive(Clone, Debug)]
pub struct VertexBasis {
    scene: Arc<Scene>,
    node_of_vertex: Vec<NodeId>,
    sites: Vec<Site>,
    areas: Vec<f32>,
}

/// What the triangles around a node add up to.
#[derive(Clone, Copy)]
struct Ring {
    vertex: u32,
    area: f64,
    weighted_centroid: DVec3,
    weighted_normal: DVec3,
}

impl VertexBasis {
    /// The basis on a scene's vertices.
    pub fn new(scene: Arc<Scene>) -> Self {
        let (node_of_vertex, first_vertex) = merge_vertices(&scene);
        let rings = rings(&scene, &node_of_vertex, &first_vertex);
        let sites = rings.iter().map(|ring| ring.site(&scene)).collect();
        let areas = rings.iter().map(|ring| (ring.area / 3.0) as f32).collect();
        Self { scene, node_of_vertex, sites, areas }
    }

    /// The scene the basis lies on.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The nodes at a triangle's corners.
    #[inline]
    pub(crate) fn nodes_of(&self, tri: TriId) -> [NodeId; 3] {
        self.scene.triangle(tri).map(|v| self.node_of_vertex[v as usize])
    }
}

/// Assigns vertices to nodes; returns the node of each vertex and the first vertex of each node.
fn merge_vertices(scene: &Scene) -> (Vec<NodeId>, Vec<u32>) {
    let mut at_position: HashMap<[u32; 3], Vec<NodeId>> = HashMap::new();
    let mut first_vertex: Vec<u32> = Vec::new();
    let normals = scene.normals();
    let node_of_vertex = scene.positions().iter().enumerate().map(|(vertex, position)| {
        // Adding zero turns -0 into 0.
        let key = (*position + Vec3::ZERO).to_array().map(f32::to_bits);
        let here = at_position.entry(key).or_default();
        let same = |node: &&NodeId| {
            normals[first_vertex[node.index()] as usize].dot(normals[vertex]) > SAME_NORMAL_COS
        };
        if let Some(node) = here.iter().find(same) {
            return *node;
        }
        let node = NodeId(first_vertex.len() as u32);
        here.push(node);
        first_vertex.push(vertex as u32);
        node
    });
    (node_of_vertex.collect(), first_vertex)
}

fn rings(scene: &Scene, node_of_vertex: &[NodeId], first_vertex: &[u32]) -> Vec<Ring> {
    let zero = |&vertex: &u32| Ring {
        vertex,
        area: 0.0,
        weighted_centroid: DVec3::ZERO,
        weighted_normal: DVec3::ZERO,
    };
    let mut rings: Vec<Ring> = first_vertex.iter().map(zero).collect();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let [a, b, c] = scene.triangle_positions(tri).map(|p| p.as_dvec3());
        let normal = 0.5 * (b - a).cross(c - a);
        let area = normal.length();
        for vertex in scene.triangle(tri) {
            let ring = &mut rings[node_of_vertex[vertex as usize].index()];
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

impl Receivers for VertexBasis {
    fn node_count(&self) -> usize {
        self.sites.len()
    }

    fn element_count(&self) -> usize {
        self.sites.len()
    }

    fn measure(&self) -> Measure {
        Measure::AtPoint
    }

    fn receiver(&self, e: ElementId, _u: [f32; 2], counts_towards: &mut NodeWeights) -> Site {
        counts_towards.push(NodeId(e.0), 1.0);
        self.sites[e.index()]
    }
}

impl Basis for VertexBasis {
    #[inline]
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        for (node, weight) in self.nodes_of(at.tri).into_iter().zip(at.bary.weights()) {
            weights.push(node, weight);
        }
    }

    fn corner_nodes(&self, tri: TriId) -> Option<[NodeId; 3]> {
        Some(self.nodes_of(tri))
    }

    fn node_areas(&self) -> Vec<f32> {
        self.areas.clone()
    }

    fn fill(&self, field: &mut Field, known: &[bool]) {
        let mut known = known.to_vec();
        while known.contains(&false) {
            let filled = self.neighbour_means(field, &known);
            if filled.is_empty() {
                break;
            }
            for (node, mean) in filled {
                field.values_mut()[node.index()] = mean;
                known[node.index()] = true;
            }
        }
        for (value, _) in field.values_mut().iter_mut().zip(&known).filter(|(_, known)| !**known) {
            *value = Vec3::ZERO;
        }
    }

    fn node_of_vertex(&self) -> &[NodeId] {
        &self.node_of_vertex
    }
}

impl VertexBasis {
    /// The means of the known neighbours of nodes that have any but are not known themselves, in node order.
    fn neighbour_means(&self, field: &Field, known: &[bool]) -> Vec<(NodeId, Vec3)> {
        let mut sums: Vec<(DVec3, u32)> = vec![(DVec3::ZERO, 0); known.len()];
        for tri in (0..self.scene.triangle_count() as u32).map(TriId) {
            let nodes = self.nodes_of(tri);
            for (k, node) in nodes.into_iter().enumerate().filter(|(_, node)| !known[node.index()]) {
                for neighbour in [nodes[(k + 1) % 3], nodes[(k + 2) % 3]] {
                    if known[neighbour.index()] {
                        let (sum, n) = &mut sums[node.index()];
                        *sum += field.node(neighbour).0.as_dvec3();
                        *n += 1;
                    }
                }
            }
        }
        let mean =
            |(i, (sum, n)): (usize, &(DVec3, u32))| (NodeId(i as u32), (*sum / f64::from(*n)).as_vec3());
        sums.iter().enumerate().filter(|(_, (_, n))| *n > 0).map(mean).collect()
    }
}
