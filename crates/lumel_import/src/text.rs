//! Words and numbers in the line-based formats.

use std::str::FromStr;

/// The longest piece of a file that a message quotes, characters.
const QUOTE_LENGTH: usize = 60;

/// Text as UTF-8 or, if it is invalid, as Latin-1, so that every name can be displayed and compared.
///
/// Control characters become spaces, because names are printed to terminals.
pub(crate) fn decode(bytes: &[u8]) -> String {
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    match std::str::from_utf8(bytes) {
        Ok(text) => text.chars().map(clean).collect(),
        Err(_) => bytes.iter().map(|&byte| clean(char::from(byte))).collect(),
    }
}

/// Text in which control characters, and those that turn the direction of writing, are spelled out (`\u{1b}`), because
/// names and messages are printed to terminals.
pub(crate) fn escaped(text: &str) -> String {
    let turns =
        |c: char| matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let hidden = |c: char| c.is_control() || turns(c);
    if !text.contains(hidden) {
        return text.to_owned();
    }
    let spell = |c: char| if hidden(c) { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(spell).collect()
}

/// A piece of a file in quotation marks, shortened, for messages.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    // Four bytes make at most one character less than four, so this prefix is long enough.
    let head = &bytes[..bytes.len().min(4 * QUOTE_LENGTH)];
    let text = decode(head);
    match text.char_indices().nth(QUOTE_LENGTH) {
        Some((end, _)) => format!("\"{}...\"", &text[..end]),
        None => format!("\"{text}\""),
    }
}

/// Names in a sentence: "a, b and 3 more".
pub(crate) fn name_list(names: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown = names[..names.len().min(SHOWN)].join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// The words of a line up to a comment.
pub(crate) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    words.take_while(|word| !word.starts_with(b"#"))
}

/// The first word of a line and what follows it, without blanks at either end.
pub(crate) fn split_keyword(text: &[u8]) -> (&[u8], &[u8]) {
    let text = text.trim_ascii();
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_ascii())
}

/// A number as C and Rust write it, rounded once to the nearest of its type.
///
/// What C runtimes print for values that are no numbers is understood too (`-nan(ind)`, `1.#QNAN`).
pub(crate) fn float<F: FromStr + From<f32>>(word: &[u8]) -> Option<F> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        let lower = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        let not_a_number = ["nan(", "1.#qnan", "1.#snan", "1.#ind"].iter().any(|n| lower.starts_with(n));
        let infinite = lower.starts_with("1.#inf");
        (not_a_number || infinite).then_some(if infinite { f32::INFINITY } else { f32::NAN }.into())
    })
}

/// The leading numbers of a statement, at most `N`, and how many there are.
///
/// # Errors
/// The first word among them that is not a number.
pub(crate) fn floats<const N: usize>(arguments: &[u8]) -> Result<([f32; N], usize), String> {
    numbers(arguments)
}

/// The same in double precision.
///
/// # Errors
/// As [`floats`].
pub(crate) fn doubles<const N: usize>(arguments: &[u8]) -> Result<([f64; N], usize), String> {
    numbers(arguments)
}

fn numbers<F: FromStr + From<f32> + Copy, const N: usize>(
    arguments: &[u8],
) -> Result<([F; N], usize), String> {
    let (mut values, mut count) = ([F::from(0.0); N], 0);
    for (slot, word) in values.iter_mut().zip(words(arguments)) {
        *slot = float(word).ok_or_else(|| format!("{} is not a number", quoted(word)))?;
        count += 1;
    }
    Ok((values, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_every_spelling() {
        let spellings: [(&str, f32); 9] = [
            ("+1", 1.0),
            ("2.", 2.0),
            ("2.e1", 20.0),
            (".8e-1", 0.08),
            ("-1.5e-001", -0.15),
            ("+1e+2", 100.0),
            ("1E2", 100.0),
            ("1e400", f32::INFINITY),
            ("1.#INF", f32::INFINITY),
        ];
        for (text, value) in spellings {
            assert_eq!(float(text.as_bytes()), Some(value), "{text}");
        }
        for text in ["nan", "-nan", "-nan(ind)", "1.#QNAN", "-1.#IND00"] {
            assert!(float(text.as_bytes()).is_some_and(f32::is_nan), "{text}");
        }
        for text in ["", "3.1+e2", "1,5", "x", "0x10", "1.0f", "--1", "\u{ff11}"] {
            assert_eq!(float::<f32>(text.as_bytes()), None, "{text}");
        }
        assert_eq!(float::<f32>(b"\xff"), None);
    }

    #[test]
    fn comments_end_the_numbers_of_a_statement() {
        assert_eq!(floats::<4>(b"1\t2  3 # 4 blue"), Ok(([1.0, 2.0, 3.0, 0.0], 3)));
        assert_eq!(floats::<2>(b"1 2 x"), Ok(([1.0, 2.0], 2)), "what follows is not looked at");
        assert_eq!(floats::<3>(b"1 x 2"), Err("\"x\" is not a number".to_owned()));
    }

    #[test]
    fn control_characters_are_spelled_out_and_other_text_is_kept() {
        assert_eq!(escaped("Tür \"1\" \\"), "Tür \"1\" \\");
        assert_eq!(
            escaped("a\u{1b}[31m\r\nb\u{7}\u{9b}\u{202e}"),
            "a\\u{1b}[31m\\r\\nb\\u{7}\\u{9b}\\u{202e}"
        );
    }

    #[test]
    fn text_of_any_encoding_is_readable() {
        assert_eq!(decode("Tür".as_bytes()), "Tür");
        assert_eq!(decode(b"T\xfcr"), "Tür");
        assert_eq!(decode(b"a\x1b[31mb"), "a [31mb");
        assert_eq!(quoted(&[b'x'; 5000]).len(), QUOTE_LENGTH + 5);
        assert_eq!(quoted("ü".repeat(500).as_bytes()).chars().count(), QUOTE_LENGTH + 5);
        assert_eq!(split_keyword(b"  usemtl  two words \r"), (&b"usemtl"[..], &b"two words"[..]));
        assert_eq!(split_keyword(b"s"), (&b"s"[..], &b""[..]));
    }
}
