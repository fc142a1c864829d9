//! Shares: numbers between 0 and 1.

use super::number_or_text::NumberOrText;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A share, as `0.01` or `1%`: above 0, below 1.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<f32>", into = "f32")]
pub struct Share(f32);

impl Share {
    /// In percent, rounded to four decimals, so that no digits of binary fractions show.
    pub fn percent(self) -> f64 {
        (1e6 * f64::from(self.0)).round() / 1e4
    }

    /// 95 %.
    pub const MOST: Self = Self(0.95);

    /// 4 %, 2 % and 1 %.
    pub(super) const PERCENT_4: Self = Self(0.04);
    pub(super) const PERCENT_2: Self = Self(0.02);
    pub(super) const PERCENT_1: Self = Self(0.01);

    /// The share, if it lies between 0 and 1.
    pub fn new(share: f32) -> Option<Self> {
        (share > 0.0 && share < 1.0).then_some(Self(share))
    }

    /// As a number.
    pub fn get(self) -> f32 {
        self.0
    }
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let share = text.strip_suffix('%').map_or_else(|| number(text), |text| Some(number(text)? / 100.0));
        let share = share.and_then(|share| Self::new(share as f32));
        share
            .ok_or_else(|| format!("\"{text}\" is not a share between 0 and 1; write for example 0.01 or 1%"))
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} %", self.percent())
    }
}

impl TryFrom<NumberOrText<f32>> for Share {
    type Error = String;

    fn try_from(value: NumberOrText<f32>) -> Result<Self, String> {
        match value {
            NumberOrText::Number(share) => {
                Self::new(share).ok_or_else(|| format!("{share} does not lie between 0 and 1"))
            }
            NumberOrText::Text(text) => text.parse(),
        }
    }
}

impl From<Share> for f32 {
    fn from(share: Share) -> Self {
        share.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_read_as_people_write_them() {
        for (text, share) in [("1%", 0.01), ("0.01", 0.01), (" 2.5 % ", 0.025), ("95%", 0.95)] {
            assert_eq!(text.parse(), Ok(Share(share)), "{text}");
        }
        for text in ["", "0", "1", "100%", "-1%", "NaN", "one"] {
            assert!(text.parse::<Share>().unwrap_err().contains("1%"), "{text}");
        }
        assert_eq!(Share(0.01).to_string(), "1 %");
        assert_eq!(Share(0.025).to_string(), "2.5 %");
    }
}
