//! `lumel` as its users meet it: the program is run, and what it prints, writes and returns is looked at.

mod bake;
mod broken;
mod common;
mod compare;
mod help;
mod info;
mod measure;
mod project;
mod refusals;
mod render;
mod resume;
