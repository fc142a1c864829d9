//! Names in OBJ and MTL files.

/// A name on a line of its own. A backslash at the end would join the next line.
pub(super) fn printable(name: &str) -> String {
    let text: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let text = text.trim();
    text.strip_suffix('\\').map_or_else(|| text.to_owned(), |rest| format!("{rest}_"))
}
