//! Everything that is printed: results on stdout, the rest on stderr.

use crate::alike::{self, Group};
use crate::failure;
use crate::outcome::{FAILED, Outcome};
use anyhow::Context;
use indicatif::ProgressBar;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Warnings of further kinds are only counted.
const MAX_WARNINGS: usize = 20;

/// How messages on stderr are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Messages {
    /// Lines of text.
    Text,
    /// One JSON object per line.
    Json,
}

/// Writes messages to stderr, around the progress bar if there is one.
pub(crate) struct Console {
    messages: Messages,
    color: bool,
    n_warnings: AtomicUsize,
    bar: Mutex<Option<ProgressBar>>,
}

impl Console {
    /// A console that writes messages in one way.
    pub(crate) fn new(messages: Messages) -> Self {
        let no_color = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let color = io::stderr().is_terminal() && !no_color && !dumb;
        Self { messages, color, n_warnings: AtomicUsize::new(0), bar: Mutex::new(None) }
    }

    /// From now on, messages are written above this bar.
    pub(crate) fn set_bar(&self, bar: Option<ProgressBar>) {
        *self.bar.lock().unwrap_or_else(PoisonError::into_inner) = bar;
    }

    /// A warning: something that lumel continues without.
    pub(crate) fn warning(&self, message: &str) {
        self.n_warnings.fetch_add(1, Ordering::Relaxed);
        self.message("warning", "33", message, None);
    }

    /// A warning that says what to do.
    pub(crate) fn warning_with_hint(&self, message: &str, hint: &str) {
        self.n_warnings.fetch_add(1, Ordering::Relaxed);
        self.message("warning", "33", message, Some(hint));
    }

    /// Warnings, those that are alike as one; `more` says that there are so many further ones, and where to find them.
    pub(crate) fn warnings<W: ToString>(
        &self,
        warnings: impl Iterator<Item = W>,
        more: impl FnOnce(usize) -> String,
    ) {
        self.grouped_warnings(warnings.map(|warning| (warning.to_string(), None)), more);
    }

    /// The same, with what to do about them.
    pub(crate) fn grouped_warnings(
        &self,
        warnings: impl Iterator<Item = (String, Option<String>)>,
        more: impl FnOnce(usize) -> String,
    ) {
        let groups = alike::groups(warnings, |(message, _)| message);
        let mut left_out = groups.iter().skip(MAX_WARNINGS).map(|group| group.count).sum();
        for Group { first: (message, hint), count } in groups.iter().take(MAX_WARNINGS) {
            let others = count - 1;
            let message = match others {
                0 => Cow::Borrowed(message),
                _ => Cow::Owned(format!("{message}; and {others} more like it")),
            };
            self.n_warnings.fetch_add(1, Ordering::Relaxed);
            self.message("warning", "33", &message, hint.as_deref());
            left_out += others;
        }
        if left_out > 0 {
            self.n_warnings.fetch_add(left_out, Ordering::Relaxed);
            self.note(&more(left_out));
        }
    }

    /// How many warnings there were.
    pub(crate) fn warning_count(&self) -> usize {
        self.n_warnings.load(Ordering::Relaxed)
    }

    /// The outcome of a finished command; warnings count only if `strict`.
    pub(crate) fn outcome(&self, strict: bool) -> Outcome {
        if strict && self.warning_count() > 0 { Outcome::Objected } else { Outcome::Done }
    }

    /// A note.
    pub(crate) fn note(&self, message: &str) {
        self.message("note", "36", message, None);
    }

    /// Why the command failed.
    pub(crate) fn error(&self, error: &anyhow::Error) {
        self.message("error", "31", &failure::text(error), failure::hint(error));
    }

    fn message(&self, kind: &str, color: &str, message: &str, hint: Option<&str>) {
        let message = &*printable(message);
        match self.messages {
            Messages::Json => {
                let mut event = json!({ "event": kind, "message": message });
                if let Some(hint) = hint {
                    event["hint"] = hint.into();
                }
                self.event(&event);
            }
            Messages::Text => {
                let kind =
                    if self.color { format!("\x1b[1;{color}m{kind}:\x1b[0m") } else { format!("{kind}:") };
                let hint = hint.map(|hint| format!("\n  hint: {}", printable(hint))).unwrap_or_default();
                self.line(&format!("{kind} {message}{hint}"));
            }
        }
    }

    /// A JSON object on its own line.
    pub(crate) fn event(&self, event: &Value) {
        self.line(&event.to_string());
    }

    /// A line of text.
    pub(crate) fn line(&self, line: &str) {
        // If stderr is closed, nobody reads messages.
        let write = || {
            let _ = writeln!(io::stderr().lock(), "{line}");
        };
        match &*self.bar.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }
}

/// Writes a result to stdout, with control characters spelled out. A closed pipe is not an error.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    print_bytes(printable(text).as_bytes())
}

/// Text whose lines stay lines, but which cannot steer a terminal.
fn printable(text: &str) -> Cow<'_, str> {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(steers) {
        return text.into();
    }
    let spell = |c: char| if steers(c) { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(spell).collect()
}

/// As [`print()`], for what need not be UTF-8.
pub(crate) fn print_bytes(bytes: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result.context("cannot write to the standard output"),
    }
}

/// Prints clap's help, version or usage error. Returns the exit code.
pub(crate) fn print_usage(message: &clap::Error, messages: Messages) -> u8 {
    if message.use_stderr() && messages == Messages::Json {
        let text = message.render().to_string();
        let text = text.trim().strip_prefix("error: ").unwrap_or(text.trim());
        Console::new(messages).error(&anyhow::anyhow!("{text}"));
        return FAILED;
    }
    match message.print() {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => FAILED,
        _ if message.use_stderr() => FAILED,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_steer_a_terminal() {
        assert_eq!(printable("a\tb\nTür"), "a\tb\nTür");
        assert_eq!(printable("\u{1b}[2J\r\u{9b}"), "\\u{1b}[2J\\r\\u{9b}");
    }
}
