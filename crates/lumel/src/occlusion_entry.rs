//! Ambient occlusion, as project files say it.

use lumel_transport::AmbientOcclusion;
use serde::{Deserialize, Serialize};

/// The ambient occlusion that a bake computes besides light; none without a distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OcclusionEntry {
    /// What is farther away hides nothing, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f32>,
    /// How fast hiding falls with the distance; 1 is usual.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub falloff: Option<f32>,
}

impl OcclusionEntry {
    /// What `over` says, else what `self` says.
    #[must_use]
    pub fn overridden_by(self, over: Self) -> Self {
        Self { distance: over.distance.or(self.distance), falloff: over.falloff.or(self.falloff) }
    }

    /// What is to be computed.
    pub fn occlusion(&self) -> Option<AmbientOcclusion> {
        let falloff = self.falloff.unwrap_or(1.0);
        self.distance.map(|distance| AmbientOcclusion { distance, falloff })
    }

    /// What is wrong although the types allow it.
    pub(crate) fn problem(&self) -> Option<&'static str> {
        if self.distance.is_some_and(|distance| distance.is_nan() || distance <= 0.0) {
            return Some("[ambient_occlusion]: the distance must be above 0");
        }
        if self.falloff.is_some_and(|falloff| !falloff.is_finite() || falloff < 0.0) {
            return Some("[ambient_occlusion]: the falloff must be 0 or more");
        }
        (self.falloff.is_some() && self.distance.is_none())
            .then_some("[ambient_occlusion] has a falloff, but no distance")
    }
}
