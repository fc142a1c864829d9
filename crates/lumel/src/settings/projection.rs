//! How light becomes coefficients at vertices.

use super::about::Influence;
use super::value::choices;
use lumel_basis::Sampling;
use serde::{Deserialize, Serialize};

/// How light is projected onto the piecewise linear functions on the vertices: where it is measured, how it is carried
/// from bounce to bounce, and how the result is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// Measured, carried and read at the vertices.
    #[serde(alias = "vertex")]
    Point,
    /// Measured over the triangles around each vertex, carried and read as the mean under its hat function.
    #[serde(alias = "vertex-area")]
    Area,
    /// Measured and carried as [`Area`](Self::Area), read as the [nearest](lumel_basis::LeastSquares) function.
    LeastSquares,
}

impl Projection {
    /// Where light is measured.
    pub fn sampling(self) -> Sampling {
        match self {
            Self::Point => Sampling::Point,
            Self::Area | Self::LeastSquares => Sampling::Area,
        }
    }
}

choices! {
    Projection {
        Point = "point" | "vertex", "At vertices",
            "the light at each vertex; vertices inside geometry take that of their neighbours";
        Area = "area" | "vertex-area", "Over areas",
            "the mean over the triangles around each vertex: conserves power, blurs";
        LeastSquares = "least-squares", "Least squares",
            "carried as area, read as the nearest piecewise linear function: conserves power, stays sharp";
    }
    /// What is measured and carried the same way is only read differently.
    fn influence(&self, other: &Self, usual: Influence) -> Influence {
        if self.sampling() == other.sampling() { Influence::Sum } else { usual }
    }
}
