//! How bounces are solved, and how much memory that takes.

use crate::settings::{Memory, SolverKind};
use lumel_solve::{REPLICATES, Target};
use std::fmt;

/// How settings solve a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// All rays are stored.
    Cached {
        /// The memory they take.
        memory: Memory,
    },
    /// Not all rays fit into memory: fewer are stored to solve the bounces, then a final gather traces as many as the
    /// settings ask for.
    FinalGather {
        /// Rays per vertex that are stored.
        stored: u32,
        /// The memory they take.
        memory: Memory,
    },
    /// Every bounce traces new rays.
    Neumann,
    /// Independent solves on stored rays, which get more samples where their spread is too large.
    Replicates {
        /// What they are to reach.
        target: Target,
        /// Rays per vertex that each stores in the first round.
        rays: u32,
        /// The memory that the rays of all of them take in the first round.
        memory: Memory,
    },
}

/// With fewer stored rays per element, noise would grow from bounce to bounce by more than a final gather smooths.
const MIN_STORED: u32 = 16;

impl Method {
    /// Chooses for `wanted` rays per element; `bytes(rays)` is the memory that so many per element take.
    pub(crate) fn new(kind: SolverKind, limit: Memory, wanted: u32, bytes: impl Fn(u32) -> u64) -> Self {
        if kind == SolverKind::Neumann {
            return Self::Neumann;
        }
        if bytes(wanted) <= limit.0 {
            return Self::Cached { memory: Memory(bytes(wanted)) };
        }
        // Powers of two keep the samples even.
        let fits = (0..32).map(|k| 1 << k).take_while(|&rays| rays < wanted && bytes(rays) <= limit.0).last();
        match fits {
            Some(stored) if stored >= MIN_STORED => {
                Self::FinalGather { stored, memory: Memory(bytes(stored)) }
            }
            _ => Self::Neumann,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cached { memory } => write!(f, "rays traced once and stored ({memory})"),
            Self::FinalGather { stored, memory } => {
                write!(f, "{stored} rays per vertex stored ({memory}), then a final gather")
            }
            Self::Neumann => f.write_str("new rays for every bounce"),
            Self::Replicates { rays, memory, .. } => {
                write!(
                    f,
                    "{REPLICATES} independent solves of {rays} rays per vertex in the first round ({memory})"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_is_stored_and_what_does_not_is_gathered_at_the_end() {
        let choose = |limit| Method::new(SolverKind::Cached, Memory(limit), 300, |rays| 10 * u64::from(rays));
        assert_eq!(choose(3000), Method::Cached { memory: Memory(3000) });
        assert_eq!(choose(2999), Method::FinalGather { stored: 256, memory: Memory(2560) });
        assert_eq!(choose(160), Method::FinalGather { stored: 16, memory: Memory(160) });
        assert_eq!(choose(159), Method::Neumann);
        assert_eq!(Method::new(SolverKind::Neumann, Memory(9999), 300, u64::from), Method::Neumann);
    }
}
