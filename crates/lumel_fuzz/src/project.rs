//! Project files.

use crate::folder::with_files;
use crate::scene::build;
use lumel::{MaxEdge, OpenOptions, Project};
use std::path::Path;

/// A shorter edge makes many triangles of the scenes below.
const LEAST_EDGE: f32 = 0.2;

/// A project file beside a mesh, `a.obj`, and a texture.
pub(crate) fn project(input: &[u8]) {
    let mesh: &[u8] = b"o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    with_files(&[("a.lumel.toml", input), ("a.obj", mesh)], |path| match Project::read(path) {
        Ok(project) => {
            write_and_read(&project, path);
            open(&project, path);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    });
}

/// A project that can be read is written and read again as it is. Compared as text: a number may be NaN.
fn write_and_read(project: &Project, path: &Path) {
    let copy = path.with_file_name("b.lumel.toml");
    project.write(&copy).expect("a project that was read can be written");
    let again = Project::read(&copy).expect("a project that was written can be read");
    assert_eq!(format!("{again:?}"), format!("{project:?}"));
}

fn open(project: &Project, path: &Path) {
    let is_small = match project.builtin.as_deref() {
        Some("furnace") => project.subdivide.is_none_or(|levels| levels == 0),
        Some(_) => false,
        None => true,
    };
    let is_coarse = !matches!(project.max_edge, Some(MaxEdge::Length(edge)) if edge < LEAST_EDGE);
    if !is_small || !is_coarse {
        return;
    }
    let name = path.to_str().expect("temporary folders have names that are text");
    match lumel::open(name, &OpenOptions::default()) {
        Ok(opened) => {
            let _settings = opened.settings.settings();
            build(opened.builder);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
