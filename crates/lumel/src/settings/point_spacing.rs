//! Whether bounces are carried on scattered points, and how far these are apart.

use super::memory::Memory;
use super::number_or_text::NumberOrText;
use super::preset::Preset;
use crate::length::metres;
use lumel_basis::MeshlessBasis;
use lumel_scene::Scene;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// More points than fit into the memory of most machines: spacings that would take more are refused.
const MOST_POINTS: u64 = 100_000_000;

/// Whether bounces are carried on points that are scattered over the surfaces, and how far these are apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<f32>", into = "NumberOrText<f32>")]
pub enum PointSpacing {
    /// They are carried on vertices.
    #[default]
    Off,
    /// As many points as the [preset](Preset::point_budget) has. [`Settings`](crate::Settings) that are made of a patch have that
    /// number instead.
    Auto,
    /// About so many points, one more for each of many small pieces.
    Points(u32),
    /// So far from each other at least, metres.
    Metres(f32),
}

impl PointSpacing {
    /// The same with the number of a preset where none is given.
    #[must_use]
    pub(super) fn with_points_of(self, preset: Preset) -> Self {
        if self == Self::Auto { Self::Points(preset.point_budget()) } else { self }
    }

    /// The spacing on the surfaces of a scene, metres; `None` where bounces are carried on vertices.
    ///
    /// Never so small that there would be more points than fit into memory.
    pub fn on(self, scene: &Scene) -> Option<f32> {
        let spacing = self.wanted_on(scene)?;
        Some(spacing.max(MeshlessBasis::spacing_for(scene, MOST_POINTS)).max(f32::MIN_POSITIVE))
    }

    fn wanted_on(self, scene: &Scene) -> Option<f32> {
        let spacing_for = |points: u32| MeshlessBasis::spacing_for(scene, points.into());
        match self {
            Self::Off => None,
            Self::Auto => Some(spacing_for(Preset::default().point_budget())),
            Self::Points(points) => Some(spacing_for(points)),
            Self::Metres(spacing) => Some(spacing),
        }
    }

    /// What scattering the points of so many levels on a scene needs, from areas alone; `None` where bounces are carried on vertices.
    pub fn need(self, scene: &Scene, levels: u32) -> Option<PointNeed> {
        let spacing = self.wanted_on(scene)?;
        let of_level = |halvings: u32| MeshlessBasis::count_for(scene, spacing * (halvings as f32).exp2());
        let points = (0..levels).map(of_level).sum();
        let [memory, _] = MeshlessBasis::bytes_for(scene, points);
        let least_spacing =
            (of_level(0) > MOST_POINTS).then(|| MeshlessBasis::spacing_for(scene, MOST_POINTS));
        Some(PointNeed { spacing, points, memory: Memory(memory), least_spacing })
    }
}

/// What scattering points over a scene needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointNeed {
    /// The spacing, metres.
    pub spacing: f32,
    /// About how many points there will be; surfaces of many small pieces have up to one more for each.
    pub points: u64,
    /// About how much memory that takes.
    pub memory: Memory,
    /// The least spacing that may be asked for, metres, if this one makes too many points.
    pub least_spacing: Option<f32>,
}

impl fmt::Display for PointSpacing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::Auto => f.write_str("auto"),
            Self::Points(points) => write!(f, "{points} points"),
            Self::Metres(spacing) => write!(f, "{spacing}"),
        }
    }
}

impl FromStr for PointSpacing {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let unknown =
            || format!("\"{text}\" is no spacing in metres, no number of points, neither auto nor off");
        match text.trim() {
            "off" => Ok(Self::Off),
            "auto" => Ok(Self::Auto),
            number => match number.strip_suffix("points") {
                Some(points) => {
                    points.trim_end().parse().ok().filter(|n| *n > 0).map(Self::Points).ok_or_else(unknown)
                }
                None => metres(number)
                    .ok_or_else(unknown)
                    .and_then(|spacing| NumberOrText::Number(spacing).try_into()),
            },
        }
    }
}

impl TryFrom<NumberOrText<f32>> for PointSpacing {
    type Error = String;

    fn try_from(value: NumberOrText<f32>) -> Result<Self, String> {
        match value {
            NumberOrText::Number(spacing) if spacing > 0.0 && spacing.is_finite() => {
                Ok(Self::Metres(spacing))
            }
            NumberOrText::Number(spacing) => {
                Err(format!("{spacing} is no spacing: it must be greater than zero"))
            }
            NumberOrText::Text(text) => text.parse(),
        }
    }
}

impl From<PointSpacing> for NumberOrText<f32> {
    fn from(spacing: PointSpacing) -> Self {
        match spacing {
            PointSpacing::Metres(spacing) => Self::Number(spacing),
            word => Self::Text(word.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::SettingsPatch;

    #[test]
    fn a_spacing_is_a_length_or_a_number_of_points_or_left_to_the_preset() {
        let all =
            [PointSpacing::Off, PointSpacing::Auto, PointSpacing::Points(5000), PointSpacing::Metres(0.25)];
        let written = serde_json::to_string(&all).unwrap();
        assert_eq!(written, r#"["off","auto","5000 points",0.25]"#);
        assert_eq!(serde_json::from_str::<Vec<PointSpacing>>(&written).unwrap(), all);
        for spacing in all {
            assert_eq!(spacing.to_string().parse(), Ok(spacing));
        }
        for wrong in ["", "0", "-1", "nan", "inf", "0 points", "-3 points", "1.5 points", "fine"] {
            assert!(wrong.parse::<PointSpacing>().is_err(), "{wrong}");
        }
        assert!(serde_json::from_str::<PointSpacing>("-0.5").is_err());
        for preset in Preset::ALL {
            let point_spacing = Some(PointSpacing::Auto);
            let patch = SettingsPatch { preset: Some(preset), point_spacing, ..Default::default() };
            assert_eq!(patch.settings().point_spacing, PointSpacing::Points(preset.point_budget()));
        }
    }
}
