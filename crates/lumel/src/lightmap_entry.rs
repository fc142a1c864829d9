//! What a lightmap is to be like, as project files say it.

use lumel_export::LightmapTarget;
use lumel_uv::{Density, GivenUvs, UnwrapSettings};
use serde::{Deserialize, Serialize};

/// Where a bake stores light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightBasis {
    /// At the vertices of the mesh, whose long edges are split.
    #[default]
    Vertex,
    /// On points that are scattered over the surfaces; in the end it is read at the vertices.
    Points,
    /// In lumels, the texels of a lightmap: the mesh stays as it is.
    Lightmap,
}

/// What becomes of the lightmap coordinates that a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UvChoice {
    /// They are kept where they can be used.
    Keep,
    /// All objects get new ones.
    New,
}

/// How a lightmap is laid out, finished and written; what is missing is as usual.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightmapEntry {
    /// Lumels per metre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<f32>,
    /// Instead: as fine as so many lumels on all pages together allow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lumels: Option<u32>,
    /// The largest width and height of a page, lumels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub atlas_size: Option<u32>,
    /// How far charts keep from each other, lumels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gutter: Option<u32>,
    /// Charts share no block of so many lumels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub align: Option<u32>,
    /// What becomes of the lightmap coordinates that the file has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uv: Option<UvChoice>,
    /// After so many seconds, objects that are left get simple charts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_limit: Option<u32>,
    /// Whether noise is taken off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub denoise: Option<bool>,
    /// What a GLB file with the lightmap is made for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<LightmapTarget>,
}

impl LightmapEntry {
    /// What `over` says, else what `self` says. A density and a number of lumels replace each other.
    #[must_use]
    pub fn overridden_by(self, over: Self) -> Self {
        let fineness = if over.density.is_some() || over.lumels.is_some() { over } else { self };
        Self {
            density: fineness.density,
            lumels: fineness.lumels,
            atlas_size: over.atlas_size.or(self.atlas_size),
            gutter: over.gutter.or(self.gutter),
            align: over.align.or(self.align),
            uv: over.uv.or(self.uv),
            time_limit: over.time_limit.or(self.time_limit),
            denoise: over.denoise.or(self.denoise),
            target: over.target.or(self.target),
        }
    }

    /// The settings of the layout; as fine as `usual_lumels` allow if it does not say how fine.
    pub fn settings(&self, usual_lumels: u32) -> UnwrapSettings {
        let usual = UnwrapSettings::default();
        UnwrapSettings {
            density: match (self.density, self.lumels) {
                (Some(density), _) => Density::PerMetre(density),
                (None, lumels) => Density::Budget(lumels.unwrap_or(usual_lumels)),
            },
            page_size: self.atlas_size.unwrap_or(usual.page_size),
            gutter: self.gutter.unwrap_or(usual.gutter),
            align: self.align.unwrap_or(usual.align),
            given: match self.uv {
                Some(UvChoice::New) => GivenUvs::Ignore,
                Some(UvChoice::Keep) | None => GivenUvs::Keep,
            },
            factors: usual.factors,
        }
    }

    /// What is wrong although the types allow it.
    pub(crate) fn problem(&self) -> Option<String> {
        if self.density.is_some() && self.lumels.is_some() {
            return Some("[lightmap] has both a density and a number of lumels".to_owned());
        }
        self.settings(1).check().err().map(|error| format!("[lightmap]: {error}"))
    }
}
