//! Errors as the user sees them: what, where, and what to do.

use anyhow::Error;
use std::fmt;
use std::panic;
use std::sync::{Arc, Mutex, PoisonError};

/// An error with a hint.
#[derive(Debug)]
struct Hinted {
    message: String,
    hint: String,
}

impl fmt::Display for Hinted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Hinted {}

/// An error that says what to do.
pub(crate) fn hinted(message: impl Into<String>, hint: impl Into<String>) -> Error {
    Hinted { message: message.into(), hint: hint.into() }.into()
}

/// The same error with a hint.
pub(crate) fn with_hint(error: impl Into<Error>, hint: impl Into<String>) -> Error {
    hinted(text(&error.into()), hint)
}

/// The error and its causes in one text, causes last; a cause that the text already contains is omitted.
pub(crate) fn text(error: &Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// The hint of an error, if it has one.
pub(crate) fn hint(error: &Error) -> Option<&str> {
    error.chain().find_map(|cause| cause.downcast_ref::<Hinted>()).map(|hinted| hinted.hint.as_str())
}

/// Panic messages, kept instead of printed.
#[derive(Clone, Default)]
pub(crate) struct Bugs(Arc<Mutex<Option<String>>>);

/// Keeps the message of the first panic on any thread, to be reported as an error.
pub(crate) fn catch_panic_messages() -> Bugs {
    let bugs = Bugs::default();
    let kept = bugs.clone();
    panic::set_hook(Box::new(move |info| {
        let said = info.payload();
        let said = said.downcast_ref::<&str>().copied().or(said.downcast_ref::<String>().map(String::as_str));
        let place = info.location().map(|at| format!(" ({}:{})", at.file(), at.line())).unwrap_or_default();
        let message = format!("{}{place}", said.unwrap_or("no message"));
        kept.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
    }));
    bugs
}

impl Bugs {
    /// The error for a panic.
    pub(crate) fn take(&self) -> Error {
        let said = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        hinted(
            format!("this is a bug in lumel: {}", said.unwrap_or_else(|| "no message".to_owned())),
            "please report it with this message, the command and, if possible, the scene",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn causes_follow_unless_they_were_told_already() {
        let cause = std::io::Error::other("the disk is on fire");
        let error =
            Error::new(cause).context("cannot read (the disk is on fire): \"a.npz\"").context("resume");
        assert_eq!(text(&error), "resume: cannot read (the disk is on fire): \"a.npz\"");
        let error = Err::<(), _>(std::io::Error::other("no")).context("reading").unwrap_err();
        assert_eq!(text(&error), "reading: no");
    }

    #[test]
    fn advice_survives_more_context() {
        let error = hinted("no light", "add one").context("scene \"a\"");
        assert_eq!(text(&error), "scene \"a\": no light");
        assert_eq!(hint(&error), Some("add one"));
        assert_eq!(hint(&with_hint(anyhow::anyhow!("x"), "do y")), Some("do y"));
        assert_eq!(hint(&anyhow::anyhow!("x")), None);
    }
}
