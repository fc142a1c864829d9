//! `lumel view`

use crate::failure::{hinted, with_hint};
use crate::outcome::Outcome;
use anyhow::Context;
use std::env;
use std::ffi::OsString;
use std::io::{self, ErrorKind};
use std::path::PathBuf;
use std::process::Command;

/// The program of the viewer.
const VIEWER: &str = "lumel-view";

/// Becomes the viewer in the folder of this program, or else the one on the path.
pub(crate) fn run(arguments: &[OsString]) -> anyhow::Result<Outcome> {
    let program = beside().unwrap_or_else(|| VIEWER.into());
    let error = become_program(Command::new(&program).args(arguments));
    let hint = "install it with `cargo install --path crates/lumel_view`, or run it from source with \
                `cargo run --release -p lumel_view`";
    if error.kind() == ErrorKind::NotFound {
        return Err(hinted(
            format!("the viewer {VIEWER} is neither in the folder of lumel nor on the path"),
            hint,
        ));
    }
    let error = Err::<(), _>(error).with_context(|| format!("cannot run {}", program.display()));
    error.map(|()| Outcome::Done).map_err(|error| with_hint(error, hint))
}

fn beside() -> Option<PathBuf> {
    let name = format!("{VIEWER}{}", env::consts::EXE_SUFFIX);
    let program = env::current_exe().ok()?.with_file_name(name);
    program.is_file().then_some(program)
}

/// Replaces this process with a program, so that exit code and signals are those of the program. Returns only on failure.
#[cfg(unix)]
fn become_program(command: &mut Command) -> io::Error {
    use std::os::unix::process::CommandExt;
    command.exec()
}

/// Runs a program and exits with its exit code. Returns only on failure.
#[cfg(not(unix))]
fn become_program(command: &mut Command) -> io::Error {
    match command.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(crate::outcome::FAILED.into())),
        Err(error) => error,
    }
}
