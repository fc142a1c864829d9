//! A room that is solved in no time.

use std::fs::write;
use std::path::{Path, PathBuf};

/// Writes a room without a front wall, its left wall red and its right one green, with a lamp under the ceiling: a
/// project of 405 vertices.
pub(crate) fn write_room(folder: &Path) -> PathBuf {
    let path = write_mesh(folder).with_file_name("room.toml");
    write(&path, PROJECT).unwrap();
    path
}

/// Writes the mesh of the room; it has neither lights nor cameras.
pub(crate) fn write_mesh(folder: &Path) -> PathBuf {
    let path = folder.join("room.obj");
    write(path.with_extension("mtl"), MATERIALS).unwrap();
    write(&path, MESH).unwrap();
    path
}

const MATERIALS: &str = "\
newmtl white
Kd 0.7 0.7 0.7
newmtl red
Kd 0.6 0.1 0.1
newmtl green
Kd 0.1 0.5 0.1
";

const MESH: &str = "\
mtllib room.mtl
o room
v -1 0 1
v 1 0 1
v 1 0 -1
v -1 0 -1
v -1 2 1
v 1 2 1
v 1 2 -1
v -1 2 -1
usemtl white
f 1 2 3 4
f 8 7 6 5
f 4 3 7 8
usemtl red
f 1 4 8 5
usemtl green
f 2 6 7 3
";

const PROJECT: &str = r#"
scene = "room.obj"
max_edge = 0.25

[[light]]
name = "Lamp"
center = [0.0, 1.9, 0.0]
u = [0.3, 0.0, 0.0]
v = [0.0, 0.0, 0.3]
radiance = [10.0, 10.0, 10.0]

[[camera]]
name = "front"
position = [0.0, 1.0, 3.5]
target = [0.0, 1.0, 0.0]
fov_deg = 50.0

[bake]
bounces = 2
direct_samples = 4
indirect_samples = 8
"#;
