//! What is known of where light comes from, and what it is shown on.

use super::Session;
use crate::prefs::Known;
use lumel::{Directional, MaterialId};

impl Session {
    /// What there is to be looked at.
    pub fn known(&self) -> Known {
        Known { lumels: self.layout().is_some(), directional: self.directional() }
    }

    /// What is known of all light by direction.
    pub fn directional(&self) -> Directional {
        let n = self.document.as_ref().map_or(0, |document| document.scene.vertex_count());
        self.light.directions(n).map_or(Directional::Off, |coefficients| coefficients.kind())
    }

    /// Whether a solve runs that measures where light comes from once it knows all light.
    pub fn measures_directions(&self) -> bool {
        self.running
            .as_ref()
            .is_some_and(|r| r.is_under_way() && r.settings().directional != Directional::Off)
    }

    /// The materials with waves over them.
    pub fn rippled_materials(&self) -> Vec<MaterialId> {
        let Some(document) = &self.document else { return Vec::new() };
        let materials = (0..).map(MaterialId).zip(document.scene.materials());
        materials.filter(|(_, m)| self.rippled.contains(&m.name)).map(|(id, _)| id).collect()
    }

    /// Gives all materials of a name a ripple, or takes it away.
    pub fn set_ripple(&mut self, material: &str, on: bool) {
        if on {
            self.rippled.insert(material.to_owned());
        } else {
            self.rippled.remove(material);
        }
    }
}
