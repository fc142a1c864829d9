//! How many bounces a bake computes.

use super::number_or_text::NumberOrText;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// How many bounces to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<u32>", into = "NumberOrText<u32>")]
pub enum BounceLimit {
    /// This many after the direct light.
    Count(u32),
    /// Until the rest is negligible.
    All,
}

impl TryFrom<NumberOrText<u32>> for BounceLimit {
    type Error = String;

    fn try_from(value: NumberOrText<u32>) -> Result<Self, String> {
        value.read(Self::Count)
    }
}

impl From<BounceLimit> for NumberOrText<u32> {
    fn from(limit: BounceLimit) -> Self {
        match limit {
            BounceLimit::Count(n) => Self::Number(n),
            BounceLimit::All => Self::Text("all".into()),
        }
    }
}

impl FromStr for BounceLimit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
        }
        text.parse().map(Self::Count).map_err(|_| format!("\"{text}\" is neither a number nor \"all\""))
    }
}

impl fmt::Display for BounceLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(n) => write!(f, "{n}"),
            Self::All => f.write_str("all"),
        }
    }
}
