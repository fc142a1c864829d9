//! Named settings.

use super::value::choices;
use serde::{Deserialize, Serialize};

/// Named settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// To see where the light goes.
    Draft,
    /// Clean enough to look at.
    #[default]
    Medium,
    /// To ship.
    Production,
}

impl Preset {
    /// All presets, from fast to good.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Medium, Self::Production];
}

choices! {
    Preset {
        Draft = "draft", "Draft", "to see where the light goes";
        Medium = "medium", "Medium", "clean enough to look at";
        Production = "production", "Production", "to ship";
    }
}
