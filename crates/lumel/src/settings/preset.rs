//! Named settings.

use serde::{Deserialize, Serialize};

/// Named settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// To see where the light goes.
    Draft,
    /// Clean enough to look at.
    #[default]
    Medium,
    /// To ship.
    Production,
}
