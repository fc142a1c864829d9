//! How a command ends.

/// How a command ended without failing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done.
    Done,
    /// Done, but with warnings under `--strict`, or with a difference above the limit.
    Objected,
    /// Stopped by the user.
    Cancelled,
}

/// Exit code of a command that failed.
pub(crate) const FAILED: u8 = 2;

impl Outcome {
    /// The exit code.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Objected => 1,
            Self::Cancelled => 130,
        }
    }
}
