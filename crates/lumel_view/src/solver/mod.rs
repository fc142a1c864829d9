//! Solves in the background, on all cores, and what can be seen of them meanwhile.
//!
//! The thread that draws never waits for the threads that solve: it reads what was [`Published`] last and may ask to
//! stop. A solve is cancelled within a few milliseconds.

mod course;
mod first_look;
mod job;
mod lumels;
mod points;
mod published;
mod publisher;
mod refine;
mod run;
mod task;

pub use course::Moment;
pub use job::SolveJob;
pub use published::{BounceStats, Ending, Phase, Published};
pub use task::{Keep, SolveStart, Solved, Task, Work};
