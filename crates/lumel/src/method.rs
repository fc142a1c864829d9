//! How all bounces are solved, and with how much memory.

use crate::settings::NumberOrText;
use lumel_solve::{REPLICATES, Target};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// How the bounces are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SolverKind {
    /// Hemisphere rays are traced once and stored; every bounce after that costs next to nothing.
    #[default]
    Cached,
    /// Every bounce traces rays of its own: the plain Neumann series.
    Neumann,
}

/// Bytes that stored rays may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "NumberOrText<u64>", into = "u64")]
pub struct Memory(pub u64);

impl Default for Memory {
    /// 2 GiB, on every machine: what is computed must not depend on where.
    fn default() -> Self {
        Self(2 << 30)
    }
}

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
            _ => Err(format!("\"{text}\" is no size; write for example 500MB or 2GiB")),
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

/// How a certain scene is solved with certain settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// All rays are stored.
    Cached {
        /// The memory they take.
        memory: Memory,
    },
    /// All rays would take too much memory: the bounces are solved with some that are stored, then all light is
    /// gathered once more with as many as were asked for.
    FinalGather {
        /// Rays per vertex that are stored.
        stored: u32,
        /// The memory they take.
        memory: Memory,
    },
    /// Every bounce traces rays of its own.
    Neumann,
    /// Independent solves on stored rays, with more samples where their spread is too large.
    Replicates {
        /// Where they end.
        target: Target,
        /// Rays per vertex that each stores at first.
        rays: u32,
        /// The memory that those of all take.
        memory: Memory,
    },
}

/// Fewer stored rays than this per element would carry more noise from bounce to bounce than a final gather smooths.
const MIN_STORED: u32 = 16;

impl Method {
    /// Chooses: `bytes(rays)` is the memory of so many rays per element.
    pub(crate) fn new(kind: SolverKind, limit: Memory, wanted: u32, bytes: impl Fn(u32) -> u64) -> Self {
        if kind == SolverKind::Neumann {
            return Self::Neumann;
        }
        if bytes(wanted) <= limit.0 {
            return Self::Cached { memory: Memory(bytes(wanted)) };
        }
        // Powers of two keep the samples even.
        let fits = (0..32).map(|k| 1 << k).take_while(|&rays| rays < wanted && bytes(rays) <= limit.0).last();
        match fits {
            Some(stored) if stored >= MIN_STORED => {
                Self::FinalGather { stored, memory: Memory(bytes(stored)) }
            }
            _ => Self::Neumann,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cached { memory } => write!(f, "rays traced once, {memory} of them stored"),
            Self::FinalGather { stored, memory } => {
                write!(f, "{stored} rays per vertex stored ({memory}), then a final gather")
            }
            Self::Neumann => f.write_str("rays of its own for every bounce"),
            Self::Replicates { rays, memory, .. } => {
                write!(
                    f,
                    "{REPLICATES} independent solves, each of {rays} rays per vertex at first ({memory} stored)"
                )
            }
        }
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

    #[test]
    fn what_fits_is_stored_and_what_does_not_is_gathered_at_the_end() {
        let choose = |limit| Method::new(SolverKind::Cached, Memory(limit), 300, |rays| 10 * u64::from(rays));
        assert_eq!(choose(3000), Method::Cached { memory: Memory(3000) });
        assert_eq!(choose(2999), Method::FinalGather { stored: 256, memory: Memory(2560) });
        assert_eq!(choose(160), Method::FinalGather { stored: 16, memory: Memory(160) });
        assert_eq!(choose(159), Method::Neumann);
        assert_eq!(Method::new(SolverKind::Neumann, Memory(9999), 300, u64::from), Method::Neumann);
    }
}
