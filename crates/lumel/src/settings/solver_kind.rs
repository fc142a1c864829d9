//! How bounces are computed.

use serde::{Deserialize, Serialize};

/// How the bounces are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SolverKind {
    /// Hemisphere rays are traced once and stored; every bounce after that costs next to nothing.
    #[default]
    Cached,
    /// Every bounce traces rays of its own: the plain Neumann series.
    Neumann,
}
