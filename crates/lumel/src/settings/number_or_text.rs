//! Values that files write as a number or in words.

use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A value of a settings file that is written as a number or in words.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum NumberOrText<N> {
    Number(N),
    Text(String),
}

impl<N> NumberOrText<N> {
    pub(super) fn read<T: FromStr>(self, of_number: impl FnOnce(N) -> T) -> Result<T, T::Err> {
        match self {
            Self::Number(number) => Ok(of_number(number)),
            Self::Text(text) => text.parse(),
        }
    }
}
