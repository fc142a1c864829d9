//! The regulariser: bends of a piecewise linear function across edges.

use crate::{NodeId, VertexBasis};
use glam::DVec3;
use lumel_scene::TriId;
use rayon::prelude::*;

/// The most that a bend weighs per squared unit at a node, over the area of the smaller triangle.
///
/// Triangles of usual shape stay below 20. Without a bound, slivers would stiffen all around them, and iterations would
/// not end.
const MAX_STIFFNESS: f64 = 40.0;

/// An edge between two triangles, and what a function costs that bends there: the square of the sum of its values at the
/// four nodes times `jumps`.
pub(super) struct Bend {
    /// The ends of the edge and the corners opposite.
    pub(super) nodes: [NodeId; 4],
    /// The jump of the gradient per unit at each node, times the area of both triangles, m.
    pub(super) jumps: [f64; 4],
}

/// The sides of all triangles by their nodes in ascending order, with the corner opposite.
pub(super) struct Edges(Vec<([NodeId; 2], TriId, u8)>);

impl Edges {
    /// Of triangles with nodes at their corners.
    pub(super) fn new(triangles: &[[NodeId; 3]]) -> Self {
        let side = |(tri, nodes): (usize, &[NodeId; 3]), k: usize| {
            let [a, b] = [nodes[(k + 1) % 3], nodes[(k + 2) % 3]];
            ([a.min(b), a.max(b)], TriId(tri as u32), k as u8)
        };
        let mut sides: Vec<_> =
            triangles.par_iter().enumerate().flat_map_iter(|tri| [0, 1, 2].map(|k| side(tri, k))).collect();
        sides.par_sort_unstable();
        Self(sides)
    }

    /// Each edge with all its triangles.
    fn chunks(&self) -> impl Iterator<Item = &[([NodeId; 2], TriId, u8)]> {
        self.0.chunk_by(|a, b| a.0 == b.0)
    }

    /// All edges with two triangles that share its nodes; creases, where each has nodes of its own, and borders have none.
    pub(super) fn bends(&self, basis: &VertexBasis) -> Vec<Bend> {
        let edges: Vec<_> = self.chunks().collect();
        let bend = |edge: &&[([NodeId; 2], TriId, u8)]| {
            let [(ends, first, k), (_, second, l)] = **edge else { return None };
            Bend::new(ends, [Wing::new(basis, first, k, ends)?, Wing::new(basis, second, l, ends)?])
        };
        edges.par_iter().filter_map(bend).collect()
    }

    /// Which of `n_nodes` nodes lie at borders and creases: at edges of one triangle.
    pub(super) fn borders(&self, n_nodes: usize) -> Vec<bool> {
        let mut is_border = vec![false; n_nodes];
        for edge in self.chunks().filter(|edge| edge.len() == 1) {
            edge[0].0.iter().for_each(|node| is_border[node.index()] = true);
        }
        is_border
    }
}

impl Bend {
    fn new(ends: [NodeId; 2], [c, d]: [Wing; 2]) -> Option<Self> {
        let jumps = [-c.at_ends[0] - d.at_ends[0], -c.at_ends[1] - d.at_ends[1], c.at_apex, d.at_apex];
        let steepest = jumps.iter().fold(0.0, |max: f64, jump| max.max(jump.abs()));
        let weight = (c.area + d.area).min((MAX_STIFFNESS * c.area.min(d.area)).sqrt() / steepest);
        // Twice the same triangle has no other side, and an edge without length no direction.
        let is_edge = ends[0] != ends[1] && c.apex != d.apex && weight > 0.0;
        is_edge.then(|| Self {
            nodes: [ends[0], ends[1], c.apex, d.apex],
            jumps: jumps.map(|jump| weight * jump),
        })
    }
}

/// A triangle beside an edge: its slope away from the edge per unit of light at its corners, m⁻¹.
struct Wing {
    apex: NodeId,
    area: f64,
    at_apex: f64,
    /// Taken off per unit at the edge's ends.
    at_ends: [f64; 2],
}

impl Wing {
    /// `None` for a triangle without area.
    fn new(basis: &VertexBasis, tri: TriId, apex: u8, ends: [NodeId; 2]) -> Option<Self> {
        let (nodes, apex) = (basis.nodes_of(tri), usize::from(apex));
        let corners = basis.scene().triangle_positions(tri).map(|p| p.as_dvec3());
        let corner = |end: NodeId| (0..3).find(|&k| k != apex && nodes[k] == end).map(|k| corners[k]);
        let (a, b, c): (DVec3, DVec3, DVec3) = (corner(ends[0])?, corner(ends[1])?, corners[apex]);
        let length = a.distance(b);
        let along = (c - a).dot(b - a) / (length * length);
        let height = (b - a).cross(c - a).length() / length;
        let wing = Self {
            apex: nodes[apex],
            area: 0.5 * length * height,
            at_apex: height.recip(),
            at_ends: [(1.0 - along) / height, along / height],
        };
        (wing.at_apex.is_finite() && along.is_finite()).then_some(wing)
    }
}
