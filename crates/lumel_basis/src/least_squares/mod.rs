//! From the means of light under hat functions to the piecewise linear function nearest to it.

mod bends;
mod conjugate_gradients;
mod incidence;
mod limits;
mod matrix;

use crate::{Basis, Field, Readout, VertexBasis};
use bends::{Bend, Edges};
use glam::{DVec3, Vec3};
use incidence::Incidence;
pub use limits::Limits;
use matrix::Matrix;
use rayon::prelude::*;

/// The regularised least-squares projection onto a [`VertexBasis`].
///
/// Solves `(M + αR) u = b`, where `M` is the mass matrix `∫BᵢBⱼ dA`, `bᵢ = ∫BᵢE dA`, and `R` penalises bends of `u` across
/// edges: the squared jump of the gradient between two triangles that are unfolded into one plane, times the square of
/// their area. Edges at borders and creases, where the light itself may bend, and edges of more than two triangles are
/// left out of `R`.
///
/// As `bᵢ` is the mean under the hat function of a node times its area, all that the projection needs is a field of
/// means, which [`AreaReceivers`](crate::AreaReceivers) measure. Constants are exact, and so is power: the sum of
/// coefficients by area is that of the means. Functions that are linear over a flat piece of the surfaces are exact too.
/// Smooth light has an error of second order in the length of edges, with a smaller factor than its values at the
/// vertices have. Beside an edge of the light, coefficients overshoot, also below zero, unless they are kept within [`Limits`].
///
/// Kavan, Bargteil, Sloan, *Least Squares Vertex Baking*, Computer Graphics Forum 30 (4), 2011.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    matrix: Matrix,
    /// The inverse of the matrix's diagonal, m⁻²; zero for nodes without area.
    inverse_diagonal: Vec<f64>,
    /// Row sums of the matrix, which are the areas of nodes, m².
    areas: Vec<f64>,
    /// Whether a node lies at a border or a crease.
    is_border: Vec<bool>,
}

impl LeastSquares {
    /// A factor of the regulariser that damps noise and overshoot without taking much from smooth light.
    pub const ALPHA: f64 = 0.1;

    /// The projection onto a basis, with the factor `alpha` of the regulariser, which is without unit: 0 for none.
    pub fn new(basis: &VertexBasis, alpha: f64) -> Self {
        let triangles = basis.corner_nodes().unwrap_or_default();
        let n_nodes = basis.node_count();
        let edges = Edges::new(triangles);
        let bends = if alpha > 0.0 { edges.bends(basis) } else { Vec::new() };
        let (around, across) = rayon::join(
            || Incidence::new(n_nodes, triangles.len(), |tri| triangles[tri]),
            || Incidence::new(n_nodes, bends.len(), |bend| bends[bend].nodes),
        );
        // Terms of both halves of the symmetric matrix come in the same order, and so round alike.
        let matrix = Matrix::from_rows(n_nodes, |row, terms| {
            for tri in around.of(row) {
                let twelfth = basis.triangle_area(tri) / 12.0;
                // A node may be at two corners of a triangle without area.
                let factor = |own: usize, other: usize| if own == other { 2.0 } else { 1.0 };
                for own in (0..3).filter(|&k| triangles[tri][k] == row) {
                    terms.extend((0..3).map(|k| (triangles[tri][k], factor(own, k) * twelfth)));
                }
            }
            for bend in across.of(row) {
                let Bend { nodes, jumps } = &bends[bend];
                let own = nodes.iter().position(|&node| node == row).map_or(0.0, |k| jumps[k]);
                terms.extend((0..4).map(|k| (nodes[k], alpha * (own * jumps[k]))));
            }
        });
        let rows = (0..n_nodes).into_par_iter();
        let areas = rows.clone().map(|i| matrix.row(i).map(|(_, value)| value).sum()).collect();
        let inverse_diagonal = rows.map(|i| {
            let diagonal: f64 = matrix.row(i).filter(|(column, _)| column.index() == i).map(|(_, v)| v).sum();
            if diagonal > 0.0 { diagonal.recip() } else { 0.0 }
        });
        let is_border = edges.borders(n_nodes);
        Self { inverse_diagonal: inverse_diagonal.collect(), areas, matrix, is_border }
    }

    /// Replaces the mean under each hat function, `∫BᵢE dA / ∫Bᵢ dA`, by the coefficients of the nearest function.
    ///
    /// Nodes without area keep their value. The bits do not depend on the number of threads. Returns how many iterations
    /// of conjugate gradients it took.
    ///
    /// # Panics
    /// If the field has another number of nodes than the basis.
    pub fn project(&self, means: &mut Field) -> usize {
        self.in_each_channel(means, |means| self.solve(means)).into_iter().max().unwrap_or(0)
    }

    /// Replaces coefficients by the means that they are the projection of: undoes [`project`](Self::project).
    ///
    /// # Panics
    /// If the field has another number of nodes than the basis.
    pub fn unproject(&self, coefficients: &mut Field) {
        self.in_each_channel(coefficients, |u| {
            let mean =
                |i: usize| if self.areas[i] > 0.0 { self.matrix.times(i, u) / self.areas[i] } else { u[i] };
            ((0..u.len()).into_par_iter().map(mean).collect(), ())
        });
    }

    fn in_each_channel<T>(&self, field: &mut Field, f: impl Fn(&[DVec3]) -> (Vec<DVec3>, T)) -> Vec<T> {
        assert_eq!(field.node_count(), self.areas.len(), "the field is one over other nodes");
        let n_channels = field.channels();
        let channel = |channel: usize| {
            let values = field.values().iter().skip(channel).step_by(n_channels);
            f(&values.map(|value: &Vec3| value.as_dvec3()).collect::<Vec<_>>())
        };
        let (found, rest): (Vec<Vec<DVec3>>, Vec<T>) = (0..n_channels).map(channel).unzip();
        for (channel, found) in found.into_iter().enumerate() {
            let values = field.values_mut().iter_mut().skip(channel).step_by(n_channels);
            values.zip(found).for_each(|(value, found)| *value = found.as_vec3());
        }
        rest
    }
}

impl Readout for LeastSquares {
    fn read(&self, field: &mut Field) {
        self.project(field);
    }
}
