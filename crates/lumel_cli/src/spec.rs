//! Things described by `key=value` words.

/// Words of the form `key=value`, each key once.
#[derive(Debug)]
pub(crate) struct Spec<'a> {
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Spec<'a> {
    /// Splits a text into words with known keys.
    pub(crate) fn parse(text: &'a str, keys: &[&str]) -> Result<Self, String> {
        let mut pairs: Vec<(&str, &str)> = Vec::new();
        for word in text.split_whitespace() {
            let (key, value) = word.split_once('=').ok_or_else(|| {
                format!("\"{word}\" is not of the form key=value; write numbers without spaces between them")
            })?;
            if !keys.contains(&key) {
                return Err(format!("there is no key \"{key}\"; the keys are {}", keys.join(", ")));
            }
            if pairs.iter().any(|(known, _)| *known == key) {
                return Err(format!("{key} is given twice"));
            }
            pairs.push((key, value));
        }
        Ok(Self { pairs })
    }

    /// The value of a key that must be there.
    pub(crate) fn require<T>(
        &self,
        key: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<T, String> {
        self.optional(key, parse)?.ok_or_else(|| format!("{key} is missing"))
    }

    /// The value of a key that may be there.
    pub(crate) fn optional<T>(
        &self,
        key: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, String> {
        let value = self.pairs.iter().find(|(known, _)| *known == key);
        value.map(|(_, value)| parse(value).map_err(|problem| format!("{key}: {problem}"))).transpose()
    }
}
