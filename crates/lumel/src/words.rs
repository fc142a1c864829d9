//! Numbers in the words of messages.

/// A count and what is counted.
///
/// ```
/// assert_eq!(lumel::counted(1, "bounce", "bounces"), "1 bounce");
/// assert_eq!(lumel::counted(0, "bounce", "bounces"), "0 bounces");
/// ```
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
