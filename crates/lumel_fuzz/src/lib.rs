//! Feeds any bytes to the readers of lumel and checks what every answer must satisfy.
//!
//! Each function of [`TARGETS`] is the body of the fuzz target of that name in `fuzz/`, which runs it with inputs that
//! a fuzzer makes up, and of the test of this crate, which runs it with the inputs kept in `fuzz/corpus`. It panics
//! where lumel breaks a promise: a panic of its own, a scene with impossible numbers, a file that does not survive
//! being written and read again.

mod folder;
mod project;
mod scene;
mod solution;
mod spec;

/// A reader that is fuzzed.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The name of the fuzz target, and of its folder of kept inputs.
    pub name: &'static str,
    /// Feeds it an input.
    pub run: fn(&[u8]),
}

/// All of them.
pub const TARGETS: [Target; 7] = [
    Target { name: "obj", run: scene::obj },
    Target { name: "mtl", run: scene::mtl },
    Target { name: "gltf", run: scene::gltf },
    Target { name: "ply", run: scene::ply },
    Target { name: "npz", run: solution::npz },
    Target { name: "project", run: project::project },
    Target { name: "light", run: spec::light },
];

/// Feeds an input to the target of a name.
///
/// # Panics
/// Where there is no such target, and where lumel breaks a promise.
pub fn run(name: &str, input: &[u8]) {
    let target = TARGETS.iter().find(|target| target.name == name);
    let target = target.unwrap_or_else(|| panic!("there is no fuzz target \"{name}\""));
    (target.run)(input);
}
