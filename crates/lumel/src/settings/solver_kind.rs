//! How bounces are computed.

use super::value::choices;
use serde::{Deserialize, Serialize};

/// How bounces are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolverKind {
    /// Hemisphere rays are traced once and stored; every bounce after that costs next to nothing.
    #[default]
    Cached,
    /// Every bounce traces new rays: the plain Neumann series.
    Neumann,
}

choices! {
    SolverKind {
        Cached = "cached", "Stored rays", "trace rays once, store them, and apply them bounce after bounce";
        Neumann = "neumann", "New rays per bounce",
            "trace new rays for every bounce: slower, but needs no memory for rays";
    }
}
