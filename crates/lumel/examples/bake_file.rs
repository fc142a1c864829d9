//! A scene from a file, with its own settings, to a solution and a lit mesh.
//!
//! `cargo run --release -p lumel --example bake_file -- SCENE OUTPUT`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example is a program")]

use lumel::{Bake, FileFormat, OpenOptions};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "cornell-box".to_owned());
    let temporary = tempfile::tempdir()?;
    let output = arguments.next().map_or_else(|| temporary.path().join("lit.glb"), PathBuf::from);

    let opened = lumel::open(&scene, &OpenOptions::default())?;
    for warning in opened.warnings.iter() {
        eprintln!("{warning}");
    }
    // Settings of a project file come first; what follows replaces them.
    let baked = Bake::new(opened.builder).settings(opened.settings).bounces(2).run()?;
    println!("{}: {} vertices", scene, baked.solution().vertex_count());
    println!("share of light that later bounces would bring: {:?}", baked.baker().remainder(baked.state()));
    FileFormat::of(&output)?.write(&output, baked.baker().scene(), &baked.solution())?;
    Ok(())
}
