//! Which parts of the light are also told apart.

use super::value::choices;
use serde::{Deserialize, Serialize};

/// Which parts of the light are also told apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layers {
    /// None: only all light.
    #[default]
    Off,
    /// That of each light.
    Lights,
}

choices! {
    Layers {
        Off = "off", "Off", "only all light";
        Lights = "lights", "Lights", "a layer for each light, each emissive material and the sky";
    }
}
