//! Scenes with their lightmap.

use super::lamps::LampPlace;
use super::material::{Appearance, Look, Materials};
use super::page_image::PageImages;
use super::primitive::{Streams, place, uv};
use super::unwrapped::{extras, placed_attributes, split_by_place};
use super::write;
use crate::ExportError;
use crate::display::seen_radiance;
use crate::lightmap::{Curve, check, lumels_of};
use glam::Vec3;
use lumel_lightmap::{Dilation, Lightmap, LightmapLayer};
use lumel_scene::{Scene, TriId};
use lumel_uv::{Coverage, Piece};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;

/// Who reads a scene with a lightmap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightmapTarget {
    /// three.js, and what else reads `MOZ_lightmap`: irradiance, by which the albedo is multiplied.
    Three,
    /// Any reader of glTF: the radiance of surfaces, as emission of black ones.
    #[default]
    Any,
    /// Any reader of glTF that lights the scene itself: the layer "occlusion", as `occlusionTexture`.
    Occlusion,
}

/// Places per side at which a triangle whose albedo or emission varies is looked at, in each lumel.
const LOOKS: u32 = 4;

/// Writes a scene with its light on the lumels of its atlas as a GLB file, atomically. The lightmap must be finished.
///
/// Geometry and materials are those of [`write_unwrapped_glb`](crate::write_unwrapped_glb). The first layer is in PNG images of
/// 8 bits, dithered, one for each page, or two where emission is in them: what emits has its own. Materials are there
/// once for each page that they are on, and show it by `TEXCOORD_1`. Cameras and rectangles that emit are those of
/// [`write_glb`](crate::write_glb); the other lights are in a scene of their own, the second of the file, unless viewers are to light
/// the surfaces.
///
/// - [`LightmapTarget::Three`]: `MOZ_lightmap` has linear irradiance over its `intensity`, which three.js multiplies by the albedo.
///   Materials that emit keep their emission. Bytes are coarse for what is dark; the `extras` of images name a view of the buffer,
///   `rgb9e5`, that has the same in 32 bits, row by row, for readers that know it.
/// - [`LightmapTarget::Any`]: surfaces are black, mirror nothing (`KHR_materials_specular`), and emit. The image has radiance
///   over the `emissiveStrength` of `KHR_materials_emissive_strength`, on the sRGB curve: light that is reflected, with the mean
///   albedo of each lumel, and emitted. Textures are as coarse as lumels there. Where a material has no texture beside it, the place
///   on the page is `TEXCOORD_0`, too: some readers, such as Godot's, know no other for emission.
/// - [`LightmapTarget::Occlusion`]: materials are those of the scene, and dim ambient light by the layer "occlusion".
///
/// # Errors
/// An atlas of another scene, a layer that there is not, light that is not finite, a scene beyond the format's limit of 4 GiB,
/// and the errors of [`write_atomically`](crate::write_atomically).
pub fn write_lightmap_glb(
    path: &Path,
    scene: &Scene,
    lightmap: &Lightmap,
    target: LightmapTarget,
) -> Result<(), ExportError> {
    let atlas = &*lightmap.atlas;
    let primitives = split_by_place(path, scene, atlas)?;
    check(path, lightmap)?;
    let mut light = Vec::new();
    let mut add = |values: &[Vec3]| -> Result<(), ExportError> {
        for page in 0..atlas.pages().len() {
            light.push(values[lumels_of(path, lightmap, page)?].to_vec());
        }
        Ok(())
    };
    let (appearance, curve, meaning) = match target {
        LightmapTarget::Three => {
            add(&lightmap.layers[0].values)?;
            (Appearance::Surfaces, Curve::Linear, "irradiance over the intensity of MOZ_lightmap, W/m^2")
        }
        LightmapTarget::Occlusion => {
            let layer = lightmap.layers.iter().find(|layer| layer.name == LightmapLayer::OCCLUSION);
            let missing = || ExportError::content(path, "the lightmap has no layer \"occlusion\"".to_owned());
            add(&layer.ok_or_else(missing)?.values)?;
            (Appearance::Occluded, Curve::Linear, "share of an even sky that is seen past what is near")
        }
        LightmapTarget::Any => {
            let emits = |tri: TriId| scene.material(tri).emits();
            let coverage = Coverage::new(atlas);
            add(&radiance(scene, lightmap, &coverage, |tri| !emits(tri)))?;
            if primitives.iter().any(|primitive| scene.materials()[primitive.material.index()].emits()) {
                add(&radiance(scene, lightmap, &coverage, emits))?;
            }
            (Appearance::Emitters, Curve::Srgb, "radiance over the strength of the emission, W/(m^2 sr)")
        }
    };
    let io = |error| ExportError::io(path, error);
    let pages = match target {
        LightmapTarget::Occlusion => PageImages::of_shares(atlas.pages(), &light),
        LightmapTarget::Three | LightmapTarget::Any => PageImages::new(atlas.pages(), &light, curve),
    };
    let pages = pages.map_err(io)?;
    // The light of lamps is on the surfaces already, which viewers would light a second time.
    let lamps = match target {
        LightmapTarget::Occlusion => LampPlace::Scene,
        LightmapTarget::Three | LightmapTarget::Any => LampPlace::Apart,
    };
    let look = Look { pages: Some(&pages), lamps, ..Look::of(appearance) };
    let materials = Materials::new(scene, &primitives, &look).map_err(io)?;
    let first = |material, corner| match target == LightmapTarget::Any && !materials.is_textured(material) {
        true => place(atlas, corner).to_array(),
        false => uv(scene, corner),
    };
    let mut attributes = placed_attributes(scene, atlas, first);
    if target == LightmapTarget::Any && scene.alphas().is_empty() {
        // Tints multiply the albedo, which is in the image.
        attributes.retain(|attribute| attribute.name != "COLOR_0");
    }
    let mut extras = extras(scene, atlas);
    extras["lightmap"]["value"] = json!(meaning);
    write(path, &Streams { scene, materials: &materials, primitives: &primitives, attributes }, extras)
}

/// Radiance by lumel that some of the triangles leave: the mean over what they cover of each. All other lumels have that of
/// the nearest.
fn radiance(
    scene: &Scene,
    lightmap: &Lightmap,
    coverage: &Coverage,
    of: impl Fn(TriId) -> bool + Sync,
) -> Vec<Vec3> {
    let (atlas, irradiance) = (&*lightmap.atlas, &lightmap.layers[0].values);
    let seen = |place: usize| -> Option<(usize, Vec3)> {
        let lumel = coverage.lumels()[place] as usize;
        let (_, at) = atlas.column_and_row(lumel);
        let (mut sum, mut weight) = (Vec3::ZERO, 0.0);
        for share in coverage.shares(place).iter().filter(|share| of(share.tri)) {
            // What only comes near is all of a lumel.
            let area = if share.area > 0.0 { share.area } else { 1.0 };
            let piece = Piece::new(atlas, share.tri, at)?;
            let varies = scene.uniform_albedo(share.tri).is_none()
                || scene.material(share.tri).emission_texture.is_some();
            let looks = if varies { LOOKS } else { 1 };
            let part = area / (looks * looks) as f32;
            for look in 0..looks * looks {
                let u = [look % looks, look / looks].map(|k| (k as f32 + 0.5) / looks as f32);
                sum += seen_radiance(scene, piece.point(u), irradiance[lumel]).0 * part;
            }
            weight += area;
        }
        (weight > 0.0).then(|| (lumel, sum / weight))
    };
    let mut values = vec![Vec3::ZERO; irradiance.len()];
    let mut is_seen = vec![false; irradiance.len()];
    let found: Vec<(usize, Vec3)> = (0..coverage.len()).into_par_iter().filter_map(seen).collect();
    for (lumel, value) in found {
        (values[lumel], is_seen[lumel]) = (value, true);
    }
    Dilation::new(atlas, coverage, &is_seen).fill(&mut values);
    values
}
