//! Messages that say the same of different things.

use std::collections::HashMap;

/// Messages that are alike.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Group<T> {
    /// The first of them.
    pub(crate) first: T,
    /// How many there are.
    pub(crate) count: usize,
}

/// Messages in the order in which the first of each kind came. Those are alike whose texts differ in numbers and in what is
/// quoted only.
pub(crate) fn groups<T>(messages: impl Iterator<Item = T>, text: impl Fn(&T) -> &String) -> Vec<Group<T>> {
    let mut groups: Vec<Group<T>> = Vec::new();
    let mut places = HashMap::new();
    for message in messages {
        let place = *places.entry(kind(text(&message))).or_insert(groups.len());
        match groups.get_mut(place) {
            Some(group) => group.count += 1,
            None => groups.push(Group { first: message, count: 1 }),
        }
    }
    groups
}

/// A text without its numbers and what is quoted.
fn kind(text: &str) -> String {
    let mut kind = String::new();
    let mut quoted = false;
    for c in text.chars() {
        let varies = c.is_ascii_digit() || quoted && c != '"';
        quoted ^= c == '"';
        if !varies {
            kind.push(c);
        } else if !kind.ends_with('#') {
            kind.push('#');
        }
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_alike_that_differ_in_numbers_and_names() {
        let texts = [
            "a.obj:12: face without area left out",
            "material \"red\": metal is treated as diffuse",
            "a.obj:3457: face without area left out",
            "material \"blue 2\": metal is treated as diffuse",
            "material \"blue\": its transmission texture is ignored",
        ];
        let groups = groups(texts.into_iter().map(str::to_owned), |text| text);
        let told: Vec<(&str, usize)> = groups.iter().map(|g| (g.first.as_str(), g.count)).collect();
        assert_eq!(told, [(texts[0], 2), (texts[1], 2), (texts[4], 1)]);
    }
}
