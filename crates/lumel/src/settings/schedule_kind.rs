//! In which order light is transported.

use super::value::choices;
use serde::{Deserialize, Serialize};

/// In which order light is transported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScheduleKind {
    /// Bounce by bounce: every surface gathers the light of all others.
    #[default]
    Gather,
    /// The brightest first: what has the most light to send sends it to all others.
    Shoot,
}

choices! {
    ScheduleKind {
        Gather = "gather", "Gather", "bounce by bounce, each measured at all vertices from the light of the one before";
        Shoot = "shoot", "Shoot", "the brightest vertices first: what has the most light to send sends it to all others";
    }
}
