//! Warnings that may occur a million times, reported once.

use crate::ImportError;
use lumel_scene::Warnings;
use std::collections::BTreeMap;
use std::path::Path;

/// Counts what is skipped, by kind, with the position of the first of each.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    kinds: BTreeMap<&'static str, (u64, String)>,
}

impl Tally {
    /// Counts one. `what` completes "3 ..., first in ...".
    pub(crate) fn note(&mut self, what: &'static str, place: impl FnOnce() -> String) {
        self.kinds.entry(what).or_insert_with(|| (0, place())).0 += 1;
    }

    /// The error of a file of which nothing is left: it names what was skipped, if anything was.
    pub(crate) fn nothing_left(&self, path: &Path) -> ImportError {
        if self.kinds.is_empty() {
            return ImportError::Empty { path: path.to_owned() };
        }
        let skipped: Vec<String> = self
            .kinds
            .iter()
            .map(|(what, (count, first))| format!("{count} {what}, first in {first}"))
            .collect();
        ImportError::malformed(path, format!("no triangles are left: {}", skipped.join("; ")))
    }

    /// One warning for each kind.
    pub(crate) fn report(&self, path: &Path, warnings: &mut Warnings) {
        for (what, (count, first)) in &self.kinds {
            warnings.push(path.display().to_string(), format!("{count} {what}, first in {first}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_reported_once_with_its_first_place() {
        let mut tally = Tally::default();
        for line in [7, 9] {
            tally.note("faces dropped: no area", || format!("line {line}"));
        }
        let mut warnings = Warnings::default();
        tally.report(Path::new("a.obj"), &mut warnings);
        let texts: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["a.obj: 2 faces dropped: no area, first in line 7"]);
    }
}
