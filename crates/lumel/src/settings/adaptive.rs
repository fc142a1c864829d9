//! How closely the mesh follows light.

use super::number_or_text::NumberOrText;
use super::preset::Preset;
use super::share::Share;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Whether edges are split where light needs it, and how closely the mesh then follows light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<f32>", into = "NumberOrText<f32>")]
pub enum Adaptive {
    /// The mesh stays as it is.
    #[default]
    Off,
    /// Edges are split, with the error of the [preset](Preset::adaptive_error). [`Settings`](crate::Settings) that are made of
    /// a patch have that error instead.
    Auto,
    /// How far light may be from a linear function along an edge of a 64th of the scene's diameter, relative to the light there.
    At(Share),
}

impl Adaptive {
    /// The same with the error of a preset where none is given.
    #[must_use]
    pub(super) fn with_error_of(self, preset: Preset) -> Self {
        if self == Self::Auto { Self::At(preset.adaptive_error()) } else { self }
    }

    /// The error, if edges are split.
    pub fn error(self) -> Option<Share> {
        match self {
            Self::Off => None,
            Self::Auto => Some(Preset::default().adaptive_error()),
            Self::At(error) => Some(error),
        }
    }
}

impl fmt::Display for Adaptive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::Auto => f.write_str("auto"),
            Self::At(error) => error.fmt(f),
        }
    }
}

impl FromStr for Adaptive {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "off" => Ok(Self::Off),
            "auto" => Ok(Self::Auto),
            error => error.parse().map(Self::At),
        }
    }
}

impl TryFrom<NumberOrText<f32>> for Adaptive {
    type Error = String;

    fn try_from(value: NumberOrText<f32>) -> Result<Self, String> {
        match value {
            NumberOrText::Text(text) => text.parse(),
            number @ NumberOrText::Number(_) => number.try_into().map(Self::At),
        }
    }
}

impl From<Adaptive> for NumberOrText<f32> {
    fn from(adaptive: Adaptive) -> Self {
        match adaptive {
            Adaptive::At(error) => Self::Number(error.get()),
            word => Self::Text(word.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::SettingsPatch;

    #[test]
    fn an_error_is_written_as_a_share_or_left_to_the_preset() {
        let read = |text| serde_json::from_str::<Adaptive>(text).unwrap();
        assert_eq!([read("\"3%\""), read("0.03")], [Adaptive::At("3%".parse().unwrap()); 2]);
        assert_eq!([read("\"off\""), read("\"auto\"")], [Adaptive::Off, Adaptive::Auto]);
        let all = [Adaptive::Off, Adaptive::Auto, Adaptive::At("50%".parse().unwrap())];
        assert_eq!(serde_json::to_string(&all).unwrap(), r#"["off","auto",0.5]"#);
        for preset in Preset::ALL {
            let patch =
                SettingsPatch { preset: Some(preset), adaptive: Some(Adaptive::Auto), ..Default::default() };
            assert_eq!(patch.settings().adaptive, Adaptive::At(preset.adaptive_error()));
        }
    }
}
