//! One coefficient per vertex, linear in between.

use crate::{Adjacency, Basis, Identity, NodeId, NodeWeights};
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint, TriId};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Vertices at one position whose normals agree to this cosine (2.6°) share a node, whatever their texture
/// coordinates or materials: the irradiance there is the same.
const SAME_NORMAL_COS: f32 = 0.999;

/// The continuous piecewise linear functions on the triangles of a scene, split where normals turn.
#[derive(Clone, Debug)]
pub struct VertexBasis {
    scene: Arc<Scene>,
    corner_nodes: Vec<[NodeId; 3]>,
    /// The first vertex of each node.
    first_vertices: Vec<u32>,
    areas: Vec<f32>,
    /// Made when it is first asked for: most solves know all nodes.
    adjacency: OnceLock<Adjacency>,
}

impl VertexBasis {
    /// The basis on a scene's vertices.
    pub fn new(scene: Arc<Scene>) -> Self {
        let (nodes, first_vertices) = merge_vertices(&scene);
        let corner_nodes: Vec<[NodeId; 3]> =
            scene.triangles().iter().map(|corners| corners.map(|v| nodes[v as usize])).collect();
        let areas = node_areas(&scene, &corner_nodes, first_vertices.len());
        Self { scene, corner_nodes, first_vertices, areas, adjacency: OnceLock::new() }
    }

    /// The scene the basis lies on.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The nodes at a triangle's corners.
    #[inline]
    pub(crate) fn nodes_of(&self, tri: TriId) -> [NodeId; 3] {
        self.corner_nodes[tri.index()]
    }

    /// The area of a triangle, m², unrounded.
    pub(crate) fn triangle_area(&self, tri: usize) -> f64 {
        triangle_area(&self.scene, tri)
    }

    /// The first vertex of each node.
    pub fn first_vertices(&self) -> &[u32] {
        &self.first_vertices
    }
}

/// Assigns vertices to nodes; returns the node of each vertex and the first vertex of each node.
fn merge_vertices(scene: &Scene) -> (Vec<NodeId>, Vec<u32>) {
    let mut at_position: HashMap<[u32; 3], Vec<NodeId>> = HashMap::new();
    let mut first_vertices: Vec<u32> = Vec::new();
    let normals = scene.normals();
    let nodes = scene.positions().iter().enumerate().map(|(vertex, position)| {
        // Adding zero turns -0 into 0.
        let key = (*position + Vec3::ZERO).to_array().map(f32::to_bits);
        let here = at_position.entry(key).or_default();
        let same = |node: &&NodeId| {
            normals[first_vertices[node.index()] as usize].dot(normals[vertex]) > SAME_NORMAL_COS
        };
        if let Some(node) = here.iter().find(same) {
            return *node;
        }
        let node = NodeId(first_vertices.len() as u32);
        here.push(node);
        first_vertices.push(vertex as u32);
        node
    });
    (nodes.collect(), first_vertices)
}

/// A third of the triangles around each node, m².
fn node_areas(scene: &Scene, corner_nodes: &[[NodeId; 3]], n_nodes: usize) -> Vec<f32> {
    let mut areas = vec![0.0f64; n_nodes];
    for (tri, nodes) in corner_nodes.iter().enumerate() {
        let area = triangle_area(scene, tri);
        nodes.iter().for_each(|node| areas[node.index()] += area);
    }
    areas.into_iter().map(|area| (area / 3.0) as f32).collect()
}

fn triangle_area(scene: &Scene, tri: usize) -> f64 {
    let [a, b, c] = scene.triangle_positions(TriId(tri as u32)).map(|p| p.as_dvec3());
    (0.5 * (b - a).cross(c - a)).length()
}

impl Basis for VertexBasis {
    fn identity(&self) -> Identity {
        Identity::new("vertices, linear", [&self.scene.geometry_hash().as_bytes()[..]])
    }

    fn node_count(&self) -> usize {
        self.first_vertices.len()
    }

    #[inline]
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        for (node, weight) in self.nodes_of(at.tri).into_iter().zip(at.bary.weights()) {
            weights.push(node, weight);
        }
    }

    fn corner_nodes(&self) -> Option<&[[NodeId; 3]]> {
        Some(&self.corner_nodes)
    }

    fn node_areas(&self) -> &[f32] {
        &self.areas
    }

    fn adjacency(&self) -> &Adjacency {
        self.adjacency
            .get_or_init(|| Adjacency::from_cells(self.node_count(), self.corner_nodes.iter().copied()))
    }
}
