//! Named settings.

use super::share::Share;
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

    /// How many vertices [`MaxEdge::Auto`](crate::MaxEdge::Auto) may add to a scene, about.
    pub fn vertex_budget(self) -> u32 {
        match self {
            Self::Draft => 50_000,
            Self::Medium => 200_000,
            Self::Production => 500_000,
        }
    }

    /// How many points [`PointSpacing::Auto`](crate::PointSpacing::Auto) scatters over a scene, about.
    pub fn point_budget(self) -> u32 {
        match self {
            Self::Draft => 12_500,
            Self::Medium => 50_000,
            Self::Production => 125_000,
        }
    }

    /// How far light may be from a linear function along edges where [`Adaptive`](crate::Adaptive) meshes do not say.
    pub fn adaptive_error(self) -> Share {
        match self {
            Self::Draft => Share::PERCENT_4,
            Self::Medium => Share::PERCENT_2,
            Self::Production => Share::PERCENT_1,
        }
    }

    /// How many lumels the pages of a lightmap have, about.
    pub fn lumel_budget(self) -> u32 {
        match self {
            Self::Draft => 1 << 16,
            Self::Medium => 1 << 18,
            Self::Production => 1 << 20,
        }
    }
}

choices! {
    Preset {
        Draft = "draft", "Draft", "to see where the light goes";
        Medium = "medium", "Medium", "clean enough to look at";
        Production = "production", "Production", "to ship";
    }
}
