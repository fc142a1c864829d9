//! Functions of direction: which moments of the light that arrives at a node are kept.

mod coefficients;
mod harmonics;

pub use coefficients::Coefficients;
pub use harmonics::{Directional, HARMONICS, Harmonics, spherical_harmonics};
