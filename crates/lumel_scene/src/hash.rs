//! Recognising a scene.

use crate::{Material, Scene, Texture, TriId};
use std::fmt;

/// What a solution must agree with to belong to a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneHash {
    /// Positions, normals and triangles: a solution of the same geometry can be shown.
    pub geometry: blake3::Hash,
    /// Materials, textures, lights and sky: a solution of the same lighting can be continued.
    pub lighting: blake3::Hash,
}

impl SceneHash {
    /// The hashes of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self { geometry: geometry(scene), lighting: lighting(scene) }
    }
}

impl fmt::Display for SceneHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", &self.geometry.to_hex()[..16])
    }
}

fn geometry(scene: &Scene) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    for v in scene.positions().iter().chain(scene.normals()) {
        update_floats(&mut hasher, &v.to_array());
    }
    for triangle in scene.triangles() {
        for index in triangle {
            hasher.update(&index.to_le_bytes());
        }
    }
    hasher.finalize()
}

fn lighting(scene: &Scene) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    for tri in 0..scene.triangle_count() {
        hasher.update(&scene.material_id(TriId(tri as u32)).0.to_le_bytes());
    }
    for material in scene.materials() {
        // Debug output is a complete and stable rendering of these plain numbers; names do not matter.
        let anonymous = Material { name: String::new(), ..material.clone() };
        hasher.update(format!("{anonymous:?}").as_bytes());
    }
    for texture in scene.textures() {
        update_texture(&mut hasher, texture);
    }
    for uv in scene.uvs() {
        update_floats(&mut hasher, &uv.to_array());
    }
    for tint in scene.tints() {
        update_floats(&mut hasher, &tint.to_array());
    }
    hasher.update(format!("{:?} {:?}", scene.lights(), scene.sky()).as_bytes());
    hasher.finalize()
}

fn update_texture(hasher: &mut blake3::Hasher, texture: &Texture) {
    let (width, height) = texture.size();
    hasher.update(format!("{width} {height} {:?} {:?}", texture.wrap_u, texture.wrap_v).as_bytes());
    if let Some((rgba, encoding)) = texture.bytes() {
        hasher.update(format!("{encoding:?}").as_bytes());
        hasher.update(rgba.as_flattened());
    } else {
        for y in 0..height {
            for x in 0..width {
                update_floats(hasher, &texture.texel(x, y).to_array());
            }
        }
    }
}

fn update_floats(hasher: &mut blake3::Hasher, values: &[f32]) {
    for value in values {
        hasher.update(&value.to_le_bytes());
    }
}
