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

/// With less than this share of the light on all surfaces, the darker half of them counts as unlit: nobody looks at it.
const DARKEST: f64 = 1e-3;

/// What remains of noise changes its sign from vertex to vertex: its correlation with that of the neighbours is -0.24 on a
/// regular mesh. What remains of light that bends is the same for neighbours.
const BENT: f64 = 0.2;

/// An estimate of the error of the light at vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Root mean square over the surfaces but for the worst 2 % of them, relative to that of the light there.
    pub error: f64,
    /// The same over the darker half of those surfaces alone. Much larger where most light never comes to where people look:
    /// on the outside of a house under a sky. `None` if next to no light comes there.
    pub in_darker_half: Option<f64>,
    /// What most of the error comes from.
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

/// As many nodes are looked at: their mean square is known to some percent.
const NODES: usize = 2048;

impl Baker {
    /// Estimates how far light is from what it would be with any number of samples on any number of vertices.
    ///
    /// At vertices inside a surface, two thousand of them at most, light is compared with what a linear function through the
    /// neighbours says. What is left is noise, and detail that the mesh does not resolve. It says nothing of
    /// [bounces that are missing](Self::remainder). `None` if there are no such vertices, or no light, or points have carried it:
    /// then neighbours share what is wrong.
    ///
    /// `solution` must be one of this baker's.
    pub fn error_estimate(&self, solution: &Solution) -> Option<ErrorEstimate> {
        let direct = solution.bounces.first().filter(|_| self.basis().points().is_none())?;
        let basis = &self.surfaces().vertices;
        let at_nodes = || basis.first_vertices().iter().map(|&vertex| vertex as usize);
        let valid: Vec<bool> = at_nodes().map(|vertex| solution.valid[vertex]).collect();
        let all: Vec<f64> = at_nodes().map(|vertex| luminance(solution.irradiance[vertex]).into()).collect();
        let direct: Vec<f64> = at_nodes().map(|vertex| luminance(direct[vertex]).into()).collect();
        let indirect: Vec<f64> = all.iter().zip(&direct).map(|(all, direct)| all - direct).collect();
        let found = |node: NodeId| {
            let fit = Fit::around(basis, node, &valid)?;
            let area = basis.node_areas()[node.index()].into();
            let residuals = [&direct, &indirect].map(|light| fit.residual(light));
            Some(Found { node, area, light: all[node.index()], residuals })
        };
        let nodes = spread(basis.node_count()).filter(|node| valid[node.index()]);
        let kept = without_worst(nodes.filter_map(found).collect());
        let integral = |value: &dyn Fn(&Found) -> f64| kept.iter().map(|at| at.area * value(at)).sum::<f64>();
        let squares = [0, 1].map(|k| integral(&|at| at.residuals[k].value.powi(2)));
        let everywhere = Squares::of(kept.iter().map(|at| (at, at.area)));
        let error = everywhere.error()?;
        let (k, noise) = match squares[0] > squares[1] {
            true => (0, ErrorCause::DirectNoise),
            false => (1, ErrorCause::IndirectNoise),
        };
        let at_edges =
            integral(&|at| if at.residuals[k].is_edge { at.residuals[k].value.powi(2) } else { 0.0 });
        let light = [&direct, &indirect][k];
        let of_neighbour = |at: &Found| {
            let mut around = basis.adjacency().neighbours(at.node).map(|(neighbour, _)| neighbour);
            around.find_map(|node| Some(Fit::around(basis, node, &valid)?.residual(light).value))
        };
        let is_bent = || {
            let pairs = kept.iter().filter_map(|at| Some((at.residuals[k].value, of_neighbour(at)?)));
            let (products, squares) = pairs.fold((0.0, 0.0), |(products, squares), (own, other)| {
                (products + own * other, squares + 0.5 * (own * own + other * other))
            });
            products > BENT * squares
        };
        let cause = if 2.0 * at_edges > squares[k] || is_bent() { ErrorCause::CoarseMesh } else { noise };
        let darker = Squares::of(darker_half(&kept));
        let is_lit = darker.mean_light() > DARKEST.powi(2) * everywhere.mean_light();
        let in_darker_half = darker.error().filter(|_| is_lit);
        Some(ErrorEstimate { error, in_darker_half, cause })
    }
}

/// Up to [`NODES`] of `n` nodes, spread over all of them at no regular distance.
fn spread(n: usize) -> impl Iterator<Item = NodeId> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let spread = move |i: usize| ((i as f64 * GOLDEN).fract() * n as f64) as usize;
    (0..n.min(NODES)).map(move |i| NodeId(if n > NODES { spread(i) } else { i } as u32))
}

/// What was found at a node.
struct Found {
    node: NodeId,
    /// That it stands for, m².
    area: f64,
    light: f64,
    /// Of direct light and of bounces.
    residuals: [Residual; 2],
}

impl Found {
    fn square(&self) -> f64 {
        self.residuals.iter().map(|residual| residual.value.powi(2)).sum()
    }
}

/// Leaves out those with the largest residuals, on [`WORST`] of the area.
fn without_worst(mut found: Vec<Found>) -> Vec<Found> {
    found.sort_by(|a, b| a.square().total_cmp(&b.square()));
    let mut left = (1.0 - WORST) * found.iter().map(|at| at.area).sum::<f64>();
    for at in &mut found {
        at.area = at.area.min(left);
        left -= at.area;
    }
    found.retain(|at| at.area > 0.0);
    found
}

/// The darkest, on half of the area, each with the area that belongs to it.
fn darker_half(found: &[Found]) -> impl Iterator<Item = (&Found, f64)> {
    let mut ascending: Vec<&Found> = found.iter().collect();
    ascending.sort_by(|a, b| a.light.total_cmp(&b.light));
    let mut left = 0.5 * found.iter().map(|at| at.area).sum::<f64>();
    ascending.into_iter().map_while(move |at| {
        let area = at.area.min(left);
        left -= area;
        (area > 0.0).then_some((at, area))
    })
}

/// Integrals of squares over some of the surfaces.
struct Squares {
    area: f64,
    light: f64,
    residual: f64,
}

impl Squares {
    /// Over what was found, each with the area that counts.
    fn of<'a>(found: impl Iterator<Item = (&'a Found, f64)>) -> Self {
        let none = Self { area: 0.0, light: 0.0, residual: 0.0 };
        found.fold(none, |sum, (at, area)| Self {
            area: sum.area + area,
            light: sum.light + area * at.light * at.light,
            residual: sum.residual + area * at.square(),
        })
    }

    fn mean_light(&self) -> f64 {
        self.light / self.area
    }

    /// The root mean square of residuals over that of the light, if there is light.
    fn error(&self) -> Option<f64> {
        (self.light > 0.0).then(|| (self.residual / self.light).sqrt())
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
