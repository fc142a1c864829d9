//! The window, driven as one would: by the names and roles of what is in it, by keys and by the mouse.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are no tests to Clippy")]

mod adaptive;
mod camera;
mod changes;
mod compare;
mod directions;
mod expected;
mod files;
mod hands;
mod harness;
mod layers;
mod lightmap;
mod lights;
mod live;
mod measure;
mod names;
mod prefs;
mod recovery;
mod saving;
mod scenes;
mod settings;
mod shooting;
mod snapshots;
mod solutions;
mod solve;
mod start;
mod target;
mod view;
mod window;
