//! Partial failures: collected, never lost, never fatal.

use std::collections::HashSet;
use std::fmt;

/// Something in the input that lumel went on without.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    /// What it is about: a file, an object, a material.
    pub subject: String,
    /// What happened, and what lumel does instead.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.subject.is_empty() {
            f.write_str(&self.message)
        } else {
            write!(f, "{}: {}", self.subject, self.message)
        }
    }
}

/// Warnings in the order they arose, each text once.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    list: Vec<Warning>,
    /// The same, to find repetitions: a hostile file can cause any number of warnings.
    known: HashSet<Warning>,
}

impl Warnings {
    /// Adds a warning unless the same one is there already.
    pub fn push(&mut self, subject: impl Into<String>, message: impl Into<String>) {
        let warning = Warning { subject: subject.into(), message: message.into() };
        if self.known.insert(warning.clone()) {
            self.list.push(warning);
        }
    }

    /// Adds one warning for all things of a `kind` that it concerns; `names` are shown as they are, the first two of many.
    ///
    /// Files have dozens of materials, and exporters leave the same default in all of them.
    pub fn push_for_all(&mut self, kind: &str, names: &[String], message: impl Into<String>) {
        let subject = match names {
            [] => return,
            [one] => format!("{kind} {one}"),
            [first, second] => format!("{kind}s {first} and {second}"),
            [first, second, rest @ ..] => format!("{kind}s {first}, {second} and {} more", rest.len()),
        };
        self.push(subject, message);
    }

    /// Adds all of `other`.
    pub fn append(&mut self, other: Warnings) {
        for Warning { subject, message } in other.list {
            self.push(subject, message);
        }
    }

    /// The warnings.
    pub fn iter(&self) -> std::slice::Iter<'_, Warning> {
        self.list.iter()
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_kept_once_and_in_order() {
        let mut warnings = Warnings::default();
        for (subject, message) in [("b", "x"), ("a", "x"), ("b", "x"), ("b", "y")] {
            warnings.push(subject, message);
        }
        let texts: Vec<String> = warnings.iter().map(Warning::to_string).collect();
        assert_eq!(texts, ["b: x", "a: x", "b: y"]);
    }
}
