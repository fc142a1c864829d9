//! Sizes of memory.

use super::number_or_text::NumberOrText;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A size in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<u64>", into = "u64")]
pub struct Memory(pub u64);

const UNITS: [(&str, u64); 7] = [
    ("kib", 1 << 10),
    ("mib", 1 << 20),
    ("gib", 1 << 30),
    ("kb", 1_000),
    ("mb", 1_000_000),
    ("gb", 1_000_000_000),
    ("b", 1),
];

impl FromStr for Memory {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.trim().to_ascii_lowercase();
        let unit = UNITS.iter().find_map(|(unit, size)| Some((lower.strip_suffix(unit)?, *size)));
        let (number, size) = unit.unwrap_or((&lower, 1));
        let bytes = number.trim().parse::<f64>().ok().map(|n| n * size as f64);
        match bytes {
            Some(bytes) if bytes.is_finite() && bytes >= 0.0 => Ok(Self(bytes.round() as u64)),
            _ => Err(format!("\"{text}\" is not a size; write for example 500MB or 2GiB")),
        }
    }
}

impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let binary = [(1u64 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
        match binary.into_iter().find(|(size, _)| self.0 >= *size) {
            Some((size, unit)) => {
                let number = self.0 as f64 / size as f64;
                let digits = if number.fract() == 0.0 || number >= 100.0 { 0 } else { 1 };
                write!(f, "{number:.digits$} {unit}")
            }
            None => write!(f, "{} B", self.0),
        }
    }
}

impl TryFrom<NumberOrText<u64>> for Memory {
    type Error = String;

    fn try_from(value: NumberOrText<u64>) -> Result<Self, String> {
        value.read(Self)
    }
}

impl From<Memory> for u64 {
    fn from(memory: Memory) -> Self {
        memory.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them() {
        for (text, bytes) in [
            ("2GiB", 2 << 30),
            ("500 MB", 500_000_000),
            ("1.5gib", 3 << 29),
            ("0", 0),
            ("77", 77),
            ("8 b", 8),
        ] {
            assert_eq!(text.parse(), Ok(Memory(bytes)), "{text}");
        }
        for text in ["", "-1", "2 potatoes", "NaN", "infGB"] {
            let error = text.parse::<Memory>().unwrap_err();
            assert!(error.contains("500MB"), "{error}");
        }
        assert_eq!(Memory(2 << 30).to_string(), "2 GiB");
        assert_eq!(Memory(1_600_000_000).to_string(), "1.5 GiB");
        assert_eq!(Memory(700).to_string(), "700 B");
        assert_eq!(serde_json::from_str::<Memory>("\"1MiB\"").unwrap(), Memory(1 << 20));
        assert_eq!(serde_json::to_string(&Memory(5)).unwrap(), "5");
    }
}
