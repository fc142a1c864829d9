//! Functions of direction: which moments of the light that arrives at a node are kept, and how they are read.

mod coefficients;
mod harmonics;
mod incident;
mod moment;
mod shading;

pub use coefficients::Coefficients;
pub use harmonics::{
    Directional, HARMONICS, Harmonics, band_of, integrals_of_harmonics, spherical_harmonics,
};
pub use incident::IncidentRadiance;
pub use moment::Moment;
pub use shading::{Shading, UnknownShading};
