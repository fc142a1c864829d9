//! The error at which a bake stops.

use super::number_or_text::NumberOrText;
use super::share::Share;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The error at which a bake stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<f32>", into = "NumberOrText<f32>")]
pub enum TargetError {
    /// None: the samples of the settings decide.
    #[default]
    Off,
    /// Half the width of a value's 95 % interval, relative to it.
    At(Share),
}

impl fmt::Display for TargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::At(error) => error.fmt(f),
        }
    }
}

impl FromStr for TargetError {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "off" { Ok(Self::Off) } else { text.parse().map(Self::At) }
    }
}

impl TryFrom<NumberOrText<f32>> for TargetError {
    type Error = String;

    fn try_from(value: NumberOrText<f32>) -> Result<Self, String> {
        match value {
            NumberOrText::Text(text) => text.parse(),
            number @ NumberOrText::Number(_) => number.try_into().map(Self::At),
        }
    }
}

impl From<TargetError> for NumberOrText<f32> {
    fn from(error: TargetError) -> Self {
        match error {
            TargetError::Off => Self::Text("off".to_owned()),
            TargetError::At(share) => Self::Number(share.get()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_written_as_a_share_or_as_off() {
        let read = |text| serde_json::from_str::<TargetError>(text).unwrap();
        assert_eq!([read("\"2%\""), read("0.02")], [TargetError::At("2%".parse().unwrap()); 2]);
        assert_eq!(read("\"off\""), TargetError::Off);
        let written =
            serde_json::to_string(&[TargetError::Off, TargetError::At("50%".parse().unwrap())]).unwrap();
        assert_eq!(written, r#"["off",0.5]"#);
    }
}
