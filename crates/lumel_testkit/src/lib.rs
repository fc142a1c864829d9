//! What the tests of light transport measure against.
//!
//! - [`form_factor`]: closed forms, in f64, that share no code with what they test.
//! - [`mesh`], [`scene`] and [`screen`]: small scenes whose light is known.
//! - [`Stage`] and [`Combination`]: one test body for every basis, sampler and solver.
//! - [`laws`]: what every basis and all receivers keep, from one test body.
//! - [`Reference`] and [`SurfaceError`]: the error of light over all surfaces.
//! - [`Estimate`]: a mean with its standard error, and how far from the truth it may be; [`Ratio`]: one of two means.
//! - [`shared`]: scenes outside the repository, for the tests and benchmarks that read them.
//!
//! A dev-dependency only. Everything here panics with a message when a test is set up wrongly.

mod combination;
pub mod form_factor;
pub mod laws;
pub mod mesh;
mod quadrature;
pub mod scene;
pub mod screen;
pub mod shared;
mod stage;
mod statistics;
mod stored;
mod surface_error;
mod surface_points;

pub use combination::{AtPoints, Combination, Estimator, Method, Solver, Storage};
pub use quadrature::{hat_average, triangle_integral};
pub use stage::{Operator, Stage, measure, replicates, tracer};
pub use statistics::{
    Estimate, ROUNDING, Ratio, assert_nodes_near, correlation, fitted_slope, ratio_bias, rms,
};
pub use surface_error::{Reference, SurfaceError};
pub use surface_points::random_surface_points;
