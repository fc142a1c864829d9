//! What the renderer draws, on any adapter: a software one will do.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are no tests to Clippy")]

mod agreement;
mod common;
mod golden;
mod lumels;
mod marks;
mod pictures;
mod points;
mod relief;
mod robust;
mod scenes;
