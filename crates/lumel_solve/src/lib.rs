//! Solves for all bounces of light, with checkpoints.
//!
//! [`solve`] adds up the Neumann series `e + Ke + K²e + …` bounce by bounce. It knows nothing of vertices or rays:
//! a [`Transport`](lumel_transport::Transport) applies the operator, a [`Basis`](lumel_basis::Basis) says how its
//! coefficients hang together. [`solve_to_error`] solves eight times at once, with samples of their own, and adds samples
//! where the spread of the eight is still above a target.

mod accuracy;
mod energy;
mod neighbours;
mod observer;
mod replicates;
mod solver;
mod state;

pub use accuracy::{Accuracy, CONFIDENCE_95, Ended, Errors, REPLICATES, Target, mean_and_error};
pub use energy::Energy;
pub use neighbours::Neighbours;
pub use observer::{Observer, Silent, Snapshot, Step};
pub use replicates::{Problem, Replicates, solve_to_error};
pub use solver::{SolveError, Stop, final_gather, solve};
pub use state::SolveState;
