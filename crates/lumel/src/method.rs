//! How all bounces are solved, and with how much memory.

use crate::settings::{Memory, SolverKind};
use lumel_solve::{REPLICATES, Target};
use std::fmt;

/// How a certain scene is solved with certain settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// All rays are stored.
    Cached {
        /// The memory they take.
        memory: Memory,
    },
    /// All rays would take too much memory: the bounces are solved with some that are stored, then all light is
    /// gathered once more with as many as were asked for.
    FinalGather {
        /// Rays per vertex that are stored.
        stored: u32,
        /// The memory they take.
        memory: Memory,
    },
    /// Every bounce traces rays of its own.
    Neumann,
    /// Independent solves on stored rays, with more samples where their spread is too large.
    Replicates {
        /// Where they end.
        target: Target,
        /// Rays per vertex that each stores at first.
        rays: u32,
        /// The memory that those of all take.
        memory: Memory,
    },
}

/// Fewer stored rays than this per element would carry more noise from bounce to bounce than a final gather smooths.
const MIN_STORED: u32 = 16;

impl Method {
    /// Chooses: `bytes(rays)` is the memory of so many rays per element.
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
            Self::Cached { memory } => write!(f, "rays traced once, {memory} of them stored"),
            Self::FinalGather { stored, memory } => {
                write!(f, "{stored} rays per vertex stored ({memory}), then a final gather")
            }
            Self::Neumann => f.write_str("rays of its own for every bounce"),
            Self::Replicates { rays, memory, .. } => {
                write!(
                    f,
                    "{REPLICATES} independent solves, each of {rays} rays per vertex at first ({memory} stored)"
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
