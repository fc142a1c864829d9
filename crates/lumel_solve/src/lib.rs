//! Solves for all bounces of light, with checkpoints.
//!
//! [`solve`] adds up the Neumann series `e + Ke + K²e + …` bounce by bounce. It knows nothing of vertices or rays:
//! a [`Transport`](lumel_transport::Transport) applies the operator, a [`Basis`](lumel_basis::Basis) says how its
//! coefficients hang together.

mod energy;
mod observer;
mod solver;
mod state;

pub use energy::Energy;
pub use observer::{Observer, Silent, Snapshot, Step};
pub use solver::{SolveError, Stop, final_gather, solve};
pub use state::SolveState;
