//! `lumel`: bakes diffuse global illumination, draws it, measures it and compares it.
//!
//! [`args`] is the command line, each file of [`commands`] one command. Results go to stdout, everything else to
//! stderr through the [`console`].

mod alike;
mod args;
mod checkpoint;
mod clock;
mod command_run;
mod commands;
mod console;
mod failure;
mod interrupt;
mod load;
mod memory;
mod out_of_memory;
mod outcome;
mod outputs;
mod parse;
mod picture;
mod points;
mod progress;
mod report;
mod scene_report;
mod source;

use crate::console::Console;
use args::{Cli, Command};
use clap::Parser;
use console::Messages;
use out_of_memory::OrError;
use outcome::{FAILED, Outcome};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: OrError = OrError;

fn main() -> ExitCode {
    interrupt::outlive_file_size_limits();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(message) => return ExitCode::from(console::print_usage(&message, messages_asked_for())),
    };
    let messages = cli.command.messages();
    out_of_memory::tell_as(messages);
    let console = Arc::new(Console::new(messages));
    ExitCode::from(guarded(&console, || commands::run(&cli.command, &console)))
}

/// How messages are wanted by a command line that cannot be understood.
fn messages_asked_for() -> Messages {
    let words: Vec<_> = std::env::args_os().collect();
    let is_json = words.windows(2).any(|pair| pair[0] == "--progress" && pair[1] == "json")
        || words.iter().any(|word| word == "--progress=json");
    if is_json { Messages::Json } else { Messages::Text }
}

/// Runs a command and reports errors, including panics. Returns the exit code.
fn guarded(console: &Arc<Console>, run: impl FnOnce() -> anyhow::Result<Outcome>) -> u8 {
    let bugs = failure::catch_panic_messages();
    let result = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| Err(bugs.take()));
    match result {
        Ok(outcome) => outcome.exit_code(),
        Err(error) => {
            console.error(&error);
            FAILED
        }
    }
}

impl Command {
    /// How messages of this command are written.
    fn messages(&self) -> Messages {
        match self {
            Self::Bake(args) => args.run.progress.messages(),
            Self::Measure(args) => args.run.progress.messages(),
            _ => Messages::Text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_failure() {
        let console = Arc::new(Console::new(Messages::Text));
        assert_eq!(guarded(&console, || panic!("on purpose")), FAILED);
        assert_eq!(guarded(&console, || Ok(Outcome::Objected)), 1);
        assert_eq!(guarded(&console, || anyhow::bail!("on purpose")), FAILED);
    }
}
