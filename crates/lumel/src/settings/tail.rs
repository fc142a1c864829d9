//! What is added for the bounces that are not computed.

use super::value::choices;
use serde::{Deserialize, Serialize};

/// What is added for the bounces that are not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tail {
    /// Nothing.
    #[default]
    Off,
    /// A geometric series of the last bounce.
    Geometric,
}

choices! {
    Tail {
        Off = "off", "Nothing", "nothing";
        Geometric = "geometric", "Geometric series",
            "the last bounce times the sum of a geometric series: an estimate";
    }
}
