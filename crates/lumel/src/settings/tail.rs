//! What is added for the bounces that are not computed.

use super::bounce_limit::BounceLimit;
use super::value::choices;
use serde::{Deserialize, Serialize};

/// What is added for the bounces that are not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tail {
    /// Nothing.
    Off,
    /// A geometric series of the last bounce.
    Geometric,
    /// That series where all bounces are asked for, nothing after a number of them.
    #[default]
    Auto,
}

impl Tail {
    /// Whether anything is added after so many bounces.
    pub fn is_added(self, bounces: BounceLimit) -> bool {
        match self {
            Self::Off => false,
            Self::Geometric => true,
            Self::Auto => bounces == BounceLimit::All,
        }
    }
}

choices! {
    Tail {
        Off = "off", "Left out", "nothing";
        Geometric = "geometric", "Estimated",
            "the last bounce times the sum of a geometric series: an estimate";
        Auto = "auto", "Automatic", "the geometric series, where all bounces are computed";
    }
}
