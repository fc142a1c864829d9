//! The tests of the ray tracer, compiled for 64-bit ARM and run by an emulator.

use crate::cargo::cargo;
use crate::shell::{run, succeeds};
use anyhow::{Result, bail};
use std::process::Command;

const TARGET: &str = "aarch64-unknown-linux-gnu";
const LINKER: &str = "aarch64-linux-gnu-gcc";

/// Packages of Debian, and a program of each.
const NEEDED: [(&str, &str); 2] =
    [(LINKER, "gcc-aarch64-linux-gnu libc6-dev-arm64-cross"), ("qemu-aarch64", "qemu-user")];

/// Runs the tests; arguments go to `cargo test`.
pub(crate) fn test(arguments: &[String]) -> Result<()> {
    for (program, packages) in NEEDED {
        if !succeeds(Command::new(program).arg("--version")) {
            bail!("there is no {program}; try `apt-get install {packages}`");
        }
    }
    if !succeeds(Command::new("rustup").args(["target", "add", TARGET])) {
        bail!("the standard library for {TARGET} is missing; try `rustup target add {TARGET}`");
    }
    let mut command = cargo(&["test", "-p", "lumel_accel", "--target", TARGET]);
    command
        .args(arguments)
        .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", LINKER)
        .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER", "qemu-aarch64 -L /usr/aarch64-linux-gnu");
    run(&mut command)
}
