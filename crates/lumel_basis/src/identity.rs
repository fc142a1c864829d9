//! Telling bases and receivers apart.

use std::fmt;

/// A hash of all that decides what the nodes of a basis or the elements of receivers are.
///
/// Stored rows, caches and checkpoints carry it: two things with the same identity can use each other's results, however
/// many nodes they have, and two things with the same number of nodes are not taken for each other.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Identity([u8; 32]);

impl Identity {
    /// The identity of something of this `kind`, decided by these `parts`.
    ///
    /// `kind` names the construction and changes when the construction does.
    pub fn new<'a>(kind: &str, parts: impl IntoIterator<Item = &'a [u8]>) -> Self {
        let mut hasher = blake3::Hasher::new();
        let mut add = |bytes: &[u8]| {
            // With their lengths, so that no two lists of parts are the same bytes.
            hasher.update(&(bytes.len() as u64).to_le_bytes());
            hasher.update(bytes);
        };
        add(kind.as_bytes());
        parts.into_iter().for_each(add);
        Self(*hasher.finalize().as_bytes())
    }

    /// The identity of something made from this one and nothing else.
    #[must_use]
    pub fn derived(&self, kind: &str) -> Self {
        Self::new(kind, [&self.0[..]])
    }

    /// The hash.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Display for Identity {
    /// In hexadecimal.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Identity({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kind_and_parts_and_where_parts_end_matter() {
        let parts = |parts: [&'static str; 2]| Identity::new("kind", parts.map(str::as_bytes));
        assert_eq!(parts(["a", "bc"]), parts(["a", "bc"]));
        assert_ne!(parts(["a", "bc"]), parts(["ab", "c"]));
        assert_ne!(parts(["a", "bc"]), Identity::new("other", ["a", "bc"].map(str::as_bytes)));
        assert_ne!(parts(["a", "bc"]).derived("x"), parts(["a", "bc"]).derived("y"));
        assert_eq!(parts(["a", "bc"]).to_string().len(), 64);
    }
}
