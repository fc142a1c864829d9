//! One file for each command.

mod atlas;
mod bake;
mod compare;
mod info;
mod lightmap;
mod man;
mod measure;
mod render;
mod summary;
mod unwrap;
mod view;

use crate::args::Command;
use crate::console::Console;
use crate::outcome::Outcome;
pub(crate) use lightmap::Lightmapped;
use std::sync::Arc;

/// Runs a command.
pub(crate) fn run(command: &Command, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    match command {
        Command::Bake(args) => bake::run(args, console),
        Command::Render(args) => render::run(args, console),
        Command::Measure(args) => measure::run(args, console),
        Command::Unwrap(args) => unwrap::run(args, console),
        Command::Info(args) => info::run(args, console),
        Command::Compare(args) => compare::run(args, console),
        Command::View { arguments } => view::run(arguments),
        Command::Completions { shell } => man::completions(*shell),
        Command::Man { dir } => man::run(dir.as_deref()),
    }
}
