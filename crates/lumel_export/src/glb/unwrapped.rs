//! Scenes whose vertices know their place in an atlas.

use super::lamps::LampPlace;
use super::material::{Appearance, Look, Materials};
use super::primitive::{Attribute, Primitive, Streams, place, split, tangents, tints, uv, vertex};
use super::write;
use crate::ExportError;
use lumel_scene::{MaterialId, Scene};
use lumel_uv::Atlas;
use serde_json::{Value, json};
use std::path::Path;

/// Writes a scene with its places in an atlas as a GLB file, atomically.
///
/// `TEXCOORD_1` is the place on the page, 0 to 1, `v` down; `TEXCOORD_0` is there with it, zero where the scene has none.
/// Meshes, nodes, materials and textures are those of [`write_glb`](crate::write_glb), but lit by viewers, and an object
/// that lies on several pages has primitives of its own for each, whose `extras` name it as `lightmap_page`. Back sides
/// are triangles of their own. `COLOR_0` is the tint and alpha of vertices, in scenes that have any. Cameras and lights are
/// those of [`write_glb`](crate::write_glb), but for rectangles, which have no place in the atlas. Pages, density, gutter and the hash of the atlas are in the `extras` of `asset`.
///
/// # Errors
/// An atlas of another scene, a scene beyond the format's limit of 4 GiB, and the errors of
/// [`write_atomically`](crate::write_atomically).
pub fn write_unwrapped_glb(path: &Path, scene: &Scene, atlas: &Atlas) -> Result<(), ExportError> {
    let primitives = split_by_place(path, scene, atlas)?;
    let look = Look { lamps: LampPlace::Unseen, ..Look::of(Appearance::Surfaces) };
    let materials =
        Materials::new(scene, &primitives, &look).map_err(|error| ExportError::io(path, error))?;
    let attributes = placed_attributes(scene, atlas, |_, corner| uv(scene, corner));
    let extras = extras(scene, atlas);
    let streams = Streams { scene, materials: &materials, primitives: &primitives, attributes };
    write(path, &streams, extras)
}

/// The primitives of a scene by pages, once it is clear that the atlas is its own.
pub(super) fn split_by_place(
    path: &Path,
    scene: &Scene,
    atlas: &Atlas,
) -> Result<Vec<Primitive>, ExportError> {
    if atlas.triangle_count() != scene.triangle_count() {
        let problem = format!(
            "an atlas of {} triangles does not belong to a scene with {}",
            atlas.triangle_count(),
            scene.triangle_count()
        );
        return Err(ExportError::content(path, problem));
    }
    Ok(split(scene, Some(atlas)))
}

/// Geometry, tints and alphas where there are any, and both sets of texture coordinates, the first as given.
pub(super) fn placed_attributes<'a>(
    scene: &'a Scene,
    atlas: &'a Atlas,
    first: impl Fn(MaterialId, u32) -> [f32; 2] + 'a,
) -> Vec<Attribute<'a>> {
    let mut attributes = vec![
        Attribute::new("POSITION", |_, corner| scene.positions()[vertex(scene, corner)].to_array()),
        Attribute::new("NORMAL", |_, corner| scene.normals()[vertex(scene, corner)].to_array()),
    ];
    attributes.extend(tints(scene));
    attributes.extend(tangents(scene));
    attributes.extend([
        Attribute::new("TEXCOORD_0", first),
        Attribute::new("TEXCOORD_1", |_, corner| place(atlas, corner).to_array()),
    ]);
    attributes
}

/// What the file tells about its atlas.
pub(super) fn extras(scene: &Scene, atlas: &Atlas) -> Value {
    json!({
        "scene": scene.name(),
        "geometry_hash": scene.geometry_hash().to_hex().as_str(),
        "lightmap": {
            "pages": atlas.pages(),
            "lumels_per_metre": atlas.density(),
            "gutter": atlas.gutter(),
            "hash": atlas.identity().to_hex().as_str(),
        },
    })
}
