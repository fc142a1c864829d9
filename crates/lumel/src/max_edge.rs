//! How finely scenes are tessellated when they are opened.

use crate::length::metres;
use lumel_scene::{SceneBuilder, SceneError, Warnings};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::fmt::{self, Display};
use std::str::FromStr;

/// The longest edge of a scene: light is stored at vertices, so that long edges lose what lies between them.
///
/// As text and in project files `auto`, `off` or a length: in metres, or with a unit as in `10cm`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MaxEdge {
    /// Suits the scene: see [`SceneBuilder::tessellate_to_suit`].
    #[default]
    Auto,
    /// The mesh stays as it is.
    Off,
    /// Longer edges are split, metres.
    Length(f32),
}

impl MaxEdge {
    /// What is usual: built-in scenes are made as finely as they should be, files mostly not.
    pub(crate) fn usual(is_fine: bool) -> Self {
        if is_fine { Self::Off } else { Self::Auto }
    }

    /// Splits the edges of a scene. Returns the longest edge that [`Auto`](Self::Auto) chose, if it split any.
    pub(crate) fn apply(
        self,
        builder: &mut SceneBuilder,
        vertex_budget: u32,
    ) -> Result<(Option<f32>, Warnings), SceneError> {
        match self {
            Self::Auto => Ok(builder.tessellate_to_suit(vertex_budget)),
            Self::Off => {
                builder.unify_diagonals();
                Ok((None, Warnings::default()))
            }
            Self::Length(length) => builder.tessellate(length).map(|warnings| (None, warnings)),
        }
    }
}

impl Display for MaxEdge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Off => f.write_str("off"),
            Self::Length(length) => write!(f, "{length}"),
        }
    }
}

impl FromStr for MaxEdge {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "auto" => Ok(Self::Auto),
            "off" => Ok(Self::Off),
            number => {
                let length = metres(number).ok_or_else(|| {
                    format!("\"{text}\" is neither auto, off nor a length, such as 0.1 or 10cm")
                })?;
                let is_length = length > 0.0 && length.is_finite();
                is_length
                    .then_some(Self::Length(length))
                    .ok_or_else(|| "a length must be greater than zero".to_owned())
            }
        }
    }
}

/// As it stands in a file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Length(f32),
    Word(String),
}

impl Serialize for MaxEdge {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Length(length) => Written::Length(*length),
            word => Written::Word(word.to_string()),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for MaxEdge {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Written::deserialize(deserializer)? {
            // Lengths that are none are refused by name when they are used.
            Written::Length(length) => Ok(Self::Length(length)),
            Written::Word(word) => match word.parse() {
                Ok(Self::Length(_)) | Err(_) => {
                    Err(de::Error::custom(format!("\"{word}\" is neither \"auto\", \"off\" nor a length")))
                }
                Ok(word) => Ok(word),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lengths_are_read_back() {
        for (text, value) in [("auto", MaxEdge::Auto), ("off", MaxEdge::Off), ("0.25", MaxEdge::Length(0.25))]
        {
            assert_eq!((text.parse(), value.to_string()), (Ok(value), text.to_owned()));
            let json = serde_json::to_string(&value).unwrap();
            assert_eq!(serde_json::from_str::<MaxEdge>(&json).unwrap(), value, "{json}");
        }
        assert_eq!("25 cm".parse(), Ok(MaxEdge::Length(0.25)));
        for wrong in ["", "Auto", "0", "-1", "nan", "inf", "0 m", "1 yd"] {
            assert!(wrong.parse::<MaxEdge>().is_err(), "{wrong}");
        }
        for wrong in ["\"fine\"", "\"0.1\"", "true"] {
            assert!(serde_json::from_str::<MaxEdge>(wrong).is_err(), "{wrong}");
        }
    }
}
