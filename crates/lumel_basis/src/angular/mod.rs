//! Functions of direction: which moments of the light that arrives at a node are kept.

mod harmonics;

pub use harmonics::{Directional, HARMONICS, Harmonics, spherical_harmonics};
