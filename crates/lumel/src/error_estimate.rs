//! How large the error of a bake about is, from what is there anyway.

use crate::Baker;
use glam::{DMat3, DVec2, DVec3};
use lumel_basis::{Basis, NodeId, VertexBasis};
use lumel_export::Solution;
use lumel_sample::Frame;
use lumel_scene::luminance;

/// What differs from its surroundings by this share of their light lies at an edge of light, or is very noisy.
const EDGE: f64 = 0.2;

/// The share of the surfaces that is left out: where light is worst, in slits and at the rims of lamps, it says little about
/// the rest.
const WORST: f64 = 0.02;

/// What remains of noise changes its sign from vertex to vertex: its correlation with that of the neighbours is -0.24 on a
/// regular mesh. What remains of light that bends is the same for neighbours.
const BENT: f64 = 0.2;

/// An estimate of the error of the light at vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Root mean square over the surfaces but for the worst 2 % of them, relative to that of the light.
    pub error: f64,
    /// What most of it comes from.
    pub cause: ErrorCause,
}

/// What most of an error comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorCause {
    /// Noise of direct light: more shadow rays lower it.
    DirectNoise,
    /// Noise of bounces: more hemisphere rays lower it.
    IndirectNoise,
    /// Light varies more than the triangles can show: shorter edges lower it.
    CoarseMesh,
}

impl Baker {
    /// Estimates how far light is from what it would be with any number of samples on any number of vertices.
    ///
    /// At each vertex inside a surface, light is compared with what a linear function through its neighbours says. What is
    /// left is noise, and detail that the mesh does not resolve. It says nothing of
    /// [bounces that are missing](Self::remainder). `None` if there are no such vertices, or no light.
    ///
    /// `solution` must be one of this baker's.
    pub fn error_estimate(&self, solution: &Solution) -> Option<ErrorEstimate> {
        let direct = solution.bounces.first()?;
        let at_nodes = || self.basis().first_vertices().iter().map(|&vertex| vertex as usize);
        let valid: Vec<bool> = at_nodes().map(|vertex| solution.valid[vertex]).collect();
        let all: Vec<f64> = at_nodes().map(|vertex| luminance(solution.irradiance[vertex]).into()).collect();
        let direct: Vec<f64> = at_nodes().map(|vertex| luminance(direct[vertex]).into()).collect();
        let indirect: Vec<f64> = all.iter().zip(&direct).map(|(all, direct)| all - direct).collect();
        let basis = self.basis();
        let [mut of_direct, mut of_indirect] = [(); 2].map(|()| Residuals::new(basis.node_count()));
        let mut light = 0.0;
        for node in (0..basis.node_count() as u32).map(NodeId).filter(|node| valid[node.index()]) {
            if let Some(fit) = Fit::around(basis, node, &valid) {
                let area = f64::from(basis.node_areas()[node.index()]);
                of_direct.add(node, area, fit.residual(&direct));
                of_indirect.add(node, area, fit.residual(&indirect));
                light += area * all[node.index()].powi(2);
            }
        }
        let ([direct, at_edges_of_direct], [indirect, at_edges_of_indirect]) =
            (of_direct.integrals(), of_indirect.integrals());
        let error = ((direct + indirect) / light).sqrt();
        let (larger, all, at_edges) = match direct > indirect {
            true => (&of_direct, direct, at_edges_of_direct),
            false => (&of_indirect, indirect, at_edges_of_indirect),
        };
        let cause = match direct > indirect {
            _ if 2.0 * at_edges > all || larger.correlation(basis) > BENT => ErrorCause::CoarseMesh,
            true => ErrorCause::DirectNoise,
            false => ErrorCause::IndirectNoise,
        };
        error.is_finite().then_some(ErrorEstimate { error, cause })
    }
}

/// What a linear function through the neighbours of a node has to be multiplied with to be compared with the node.
struct Fit {
    node: NodeId,
    /// The neighbours, each with its weight.
    prediction: Vec<(NodeId, f64)>,
    /// The standard deviation of the difference for noise of 1.
    deviation: f64,
}

impl Fit {
    /// `None` at borders, where neighbours lie to one side, and beside nodes that were not measured.
    fn around(basis: &VertexBasis, node: NodeId, valid: &[bool]) -> Option<Self> {
        let scene = basis.scene();
        let position =
            |node: NodeId| scene.positions()[basis.first_vertices()[node.index()] as usize].as_dvec3();
        let frame = Frame::from_normal(scene.normals()[basis.first_vertices()[node.index()] as usize]);
        let axes = [frame.tangent, frame.bitangent].map(|axis| axis.as_dvec3());
        let here = position(node);
        let mut around: Vec<(NodeId, DVec3)> = Vec::new();
        for (neighbour, shared) in basis.adjacency().neighbours(node) {
            if shared < 2.0 || !valid[neighbour.index()] {
                return None;
            }
            let at = DVec2::from(axes.map(|axis| axis.dot(position(neighbour) - here)));
            around.push((neighbour, at.extend(1.0)));
        }
        let scale = around.iter().map(|(_, at)| at.truncate().length_squared()).fold(0.0, f64::max).sqrt();
        around.iter_mut().for_each(|(_, at)| *at = (at.truncate() / scale).extend(1.0));
        let outer = |at: &DVec3| DMat3::from_cols(*at * at.x, *at * at.y, *at * at.z);
        let normal = around.iter().map(|(_, at)| outer(at)).fold(DMat3::ZERO, |sum, outer| sum + outer);
        if around.len() < 3 || normal.determinant().abs() < 1e-6 {
            return None;
        }
        let inverse = normal.inverse();
        let prediction: Vec<(NodeId, f64)> =
            around.iter().map(|&(neighbour, at)| (neighbour, (inverse * at).z)).collect();
        Some(Self { node, prediction, deviation: (1.0 + inverse.z_axis.z).sqrt() })
    }

    /// The noise of light at the node, as far as one value can say.
    fn residual(&self, light: &[f64]) -> Residual {
        let predicted: f64 = self.prediction.iter().map(|&(node, weight)| weight * light[node.index()]).sum();
        let found = light[self.node.index()];
        let is_edge = (found - predicted).abs() > EDGE * found.abs().max(predicted.abs());
        Residual { value: (found - predicted) / self.deviation, is_edge }
    }
}

/// What remains of a field at a node.
struct Residual {
    value: f64,
    is_edge: bool,
}

/// What remains of a field.
struct Residuals {
    /// Squares, with the area that each stands for and whether it lies at an edge.
    squares: Vec<(f64, f64, bool)>,
    /// By node; zero where there is none.
    at: Vec<f64>,
}

impl Residuals {
    fn new(nodes: usize) -> Self {
        Self { squares: Vec::new(), at: vec![0.0; nodes] }
    }

    fn add(&mut self, node: NodeId, area: f64, Residual { value, is_edge }: Residual) {
        self.squares.push((value * value, area, is_edge));
        self.at[node.index()] = value;
    }

    /// The integral of the squares but for the largest, on [`WORST`] of the area; and of those at edges.
    fn integrals(&mut self) -> [f64; 2] {
        self.squares.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut left = (1.0 - WORST) * self.squares.iter().map(|(_, area, _)| area).sum::<f64>();
        let mut integrals = [0.0; 2];
        for (square, area, is_edge) in &self.squares {
            let area = area.min(left);
            left -= area;
            integrals[0] += square * area;
            integrals[1] += if *is_edge { square * area } else { 0.0 };
        }
        integrals
    }

    /// How much neighbours are alike.
    fn correlation(&self, basis: &VertexBasis) -> f64 {
        let (mut products, mut squares) = (0.0, 0.0);
        for (node, value) in (0..).map(NodeId).zip(&self.at).filter(|(_, value)| **value != 0.0) {
            let others = basis.adjacency().neighbours(node).map(|(neighbour, _)| self.at[neighbour.index()]);
            for other in others.filter(|other| *other != 0.0) {
                products += value * other;
                squares += value * value;
            }
        }
        if squares > 0.0 { products / squares } else { 0.0 }
    }
}
