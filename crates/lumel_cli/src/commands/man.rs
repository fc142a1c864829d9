//! `lumel man` and `lumel completions`: from the same definition as the command line.

use crate::args::Cli;
use crate::console;
use crate::failure::hinted;
use crate::outcome::Outcome;
use anyhow::Context;
use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::Path;

/// Prints a completion script.
pub(crate) fn completions(shell: Shell) -> anyhow::Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "lumel", &mut script);
    console::print_bytes(&script)?;
    Ok(Outcome::Done)
}

/// Prints the manual page, or writes all of them.
pub(crate) fn run(dir: Option<&Path>) -> anyhow::Result<Outcome> {
    let Some(dir) = dir else {
        let mut page = Vec::new();
        Man::new(Cli::command()).render(&mut page)?;
        console::print_bytes(&page)?;
        return Ok(Outcome::Done);
    };
    if !dir.is_dir() {
        return Err(hinted(format!("there is no such folder: {}", dir.display()), "create it first"));
    }
    clap_mangen::generate_to(Cli::command(), dir)
        .with_context(|| format!("cannot write into {}", dir.display()))?;
    Ok(Outcome::Done)
}
