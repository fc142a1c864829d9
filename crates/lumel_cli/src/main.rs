//! `lumel`: bakes diffuse global illumination, draws it, measures it and compares it.
//!
//! [`args`] is the command line, each file of [`commands`] one command. Results go to stdout, everything else to
//! stderr through the [`console`].

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
mod outcome;
mod outputs;
mod parse;
mod picture;
mod points;
mod progress;
mod report;
mod scene_report;

use crate::console::Console;
use args::{Cli, Command};
use clap::Parser;
use outcome::{FAILED, Outcome};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(message) => return ExitCode::from(console::print_usage(&message)),
    };
    let console = Arc::new(Console::new(cli.command.messages()));
    ExitCode::from(guarded(&console, || commands::run(&cli.command, &console)))
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
    fn messages(&self) -> console::Messages {
        match self {
            Self::Bake(args) => args.run.progress.messages(),
            Self::Measure(args) => args.run.progress.messages(),
            _ => console::Messages::Text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_failure() {
        let console = Arc::new(Console::new(console::Messages::Text));
        assert_eq!(guarded(&console, || panic!("on purpose")), FAILED);
        assert_eq!(guarded(&console, || Ok(Outcome::Objected)), 1);
        assert_eq!(guarded(&console, || anyhow::bail!("on purpose")), FAILED);
    }
}
