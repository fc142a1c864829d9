//! How a command ends.

/// How a command ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All is well.
    Done,
    /// Done, but with what the user asked to be told of: warnings, or a difference above a limit.
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
