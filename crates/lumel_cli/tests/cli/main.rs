//! `lumel` as its users meet it: the program is run, and what it prints, writes and returns is looked at.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are no tests to Clippy")]

mod adaptive;
mod bake;
mod broken;
mod common;
mod compare;
#[cfg(unix)]
mod failures;
mod help;
mod info;
mod lightmaps;
mod lights;
mod measure;
mod names;
mod points;
mod project;
mod refusals;
mod render;
mod resume;
mod shooting;
mod shown;
mod three;
mod tutorial;
mod unwrap;
#[cfg(unix)]
mod view;
