//! What stands for the bounces that are not computed.

use serde::{Deserialize, Serialize};

/// What to add for the bounces that are not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tail {
    /// Nothing.
    #[default]
    Off,
    /// The geometric series of the last bounce.
    Geometric,
}
