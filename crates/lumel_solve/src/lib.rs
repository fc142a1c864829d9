//! Solves for all bounces of light, with checkpoints.
//!
//! [`solve`] adds up the Neumann series `e + Ke + K²e + …` step by step. It knows nothing of vertices or rays: a
//! [`Transport`](lumel_transport::Transport) applies the operator, a [`Basis`](lumel_basis::Basis) says which
//! coefficients are next to each other, a [`Schedule`] decides what is transported next and when enough has been.
//! [`solve_to_error`] solves eight times at once, with samples of their own, and adds samples where the spread of the
//! eight is still above a target. [`solve_layers`] tells the light of some emitters from that of the others, [`solve_directional`] where light comes from.
//! With a [`DirectOperator`], direct light is measured in another basis, too, in which it is read.

mod accuracy;
mod brightest;
mod directional;
mod integrals;
mod layers;
mod levels;
mod observer;
mod operator;
mod power_log;
mod replicates;
mod schedule;
mod solver;
mod state;

pub use accuracy::{Accuracy, CONFIDENCE_95, Ended, Errors, REPLICATES, Target, mean_and_error};
pub use brightest::brightest;
pub use directional::solve_directional;
pub use integrals::Integrals;
pub use layers::{mix, solve_layers};
pub use levels::{Halves, RefinedLevels, Refinement};
pub use observer::{Observer, Silent, Snapshot, Step};
pub use operator::{DirectOperator, Operator};
pub use power_log::PowerLog;
pub use replicates::{Problem, Replicates, Round, solve_to_error};
pub use schedule::{Gather, Schedule, Shoot, Shot, Stop};
pub use solver::{SolveError, final_gather, solve};
pub use state::{Gatherable, ShotLight, SolveState};
