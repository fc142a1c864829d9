//! Scenes with light at their vertices.

use super::material::{Appearance, Materials, Shown};
use super::primitive::{Attribute, Only, Streams, split, tangents, vertex};
use super::write;
use crate::display::{finite_irradiance, seen_radiance, white_radiance};
use crate::{ColorScale, ExportError};
use glam::Vec3;
use lumel_basis::{Directional, HARMONICS, IncidentRadiance, Lighting, incident_at_vertices};
use lumel_scene::{Barycentrics, MaterialId, Scene, SurfacePoint, TriId};
use serde_json::json;
use std::path::Path;

/// Writes the lit scene as a GLB file, atomically. Returns the exposure used.
///
/// Every object is a mesh with one primitive per material, at a node that moves it where a scene is far from the origin. Its vertices carry
/// - `_IRRADIANCE`: irradiance, W·m⁻² (lux if the lights are photometric), linear Rec. 709, exact;
/// - `COLOR_0`: radiance of a white surface under that irradiance, times the exposure, clamped to 0..=1; its fourth
///   component, in scenes that have any, is the alpha of vertices;
/// - `_SH1R`, `_SH1G` and `_SH1B`, where light is known by direction: of each colour, the four coefficients of incident
///   radiance in bands 0 and 1, W·m⁻², in world space, in the order of [`Harmonics`](lumel_basis::Harmonics); `_SH2R`,
///   `_SH2G` and `_SH2B` the first four of band 2, and `_SH22` the last one of all colours;
/// - `_DIRECTION`, likewise: [where most light comes from](lumel_basis::IncidentRadiance::dominant).
///
/// Materials are one-sided, with the albedo as base colour and the radiance as emission, each with its own texture.
/// They are unlit, so that any viewer shows base colour times `COLOR_0`: radiance times exposure. Base colour can only
/// darken, so the exposure is that of white, not of the actual surfaces. Emissive surfaces without textures show
/// emitted and reflected radiance in `COLOR_0` alone, with white as base colour. Emissive surfaces with a texture are
/// lit: viewers show their emission, unscaled, and reflect light of their own. Albedo and emission of each material
/// are in its `extras`; exposure, units and the hash of the geometry in those of `asset`. Normal
/// maps, whose green points up, and `TANGENT` are there for readers that light the scene.
///
/// # Errors
/// Light of a different scene or that is not finite, an exposure that is not positive, a scene beyond the format's limit
/// of 4 GiB, and the errors of [`write_atomically`](crate::write_atomically).
pub fn write_glb(
    path: &Path,
    scene: &Scene,
    lighting: &dyn Lighting,
    exposure: ColorScale,
) -> Result<f32, ExportError> {
    let irradiance = &*finite_irradiance(path, scene, lighting)?;
    let incident = incident_at_vertices(scene, lighting);
    let exposure = exposure.factor(path, irradiance)?;
    let primitives = split(scene, None);
    let materials = Materials::new(scene, &primitives, Appearance::Light, None)
        .map_err(|error| ExportError::io(path, error))?;
    let color = move |material, corner| color(scene, irradiance, exposure, material, corner);
    let colors = if scene.alphas().is_empty() {
        Attribute::new("COLOR_0", move |material, corner| color(material, corner).to_array())
    } else {
        Attribute::new("COLOR_0", move |material, corner| {
            color(material, corner).extend(scene.alphas()[vertex(scene, corner)]).to_array()
        })
    };
    let uvs = Attribute::new("TEXCOORD_0", |_, corner| scene.uvs()[vertex(scene, corner)].to_array());
    let mut attributes = vec![
        Attribute::new("POSITION", |_, corner| scene.positions()[vertex(scene, corner)].to_array()),
        Attribute::new("NORMAL", |_, corner| scene.normals()[vertex(scene, corner)].to_array()),
        Attribute::new("_IRRADIANCE", |_, corner| irradiance[vertex(scene, corner)].to_array()),
        colors,
        Attribute { only: Only::Textured, ..uvs },
    ];
    attributes.extend(tangents(scene));
    let by_direction = incident.iter().flat_map(|incident| directional(scene, incident));
    attributes.extend(by_direction);
    let mut extras = json!({
        "scene": scene.name(),
        "geometry_hash": scene.geometry_hash().to_hex().as_str(),
        "exposure": exposure,
        "_IRRADIANCE": "irradiance, W/m^2 (lux if the lights are photometric), linear Rec. 709",
        "COLOR_0": "min(1, _IRRADIANCE / pi * vertex tint * exposure); \
                    on emitting materials without textures min(1, (emitted + reflected radiance) * exposure)",
    });
    if incident.is_some() {
        extras["_SH1R"] = json!(COEFFICIENTS);
        extras["_DIRECTION"] =
            json!("where most light comes from, as long as its share that comes from there");
    }
    let streams = Streams { scene, materials: &materials, primitives: &primitives, attributes };
    write(path, &streams, &extras)?;
    Ok(exposure)
}

const COEFFICIENTS: &str = "coefficients of the red radiance L that arrives, integrals of L Y over directions, W/m^2, in real \
                            spherical harmonics in world space: Y00, Y1-1 (y), Y10 (z), Y11 (x); _SH1G and _SH1B are green and \
                            blue, _SH2R, _SH2G and _SH2B Y2-2, Y2-1, Y20 and Y21, _SH22 red, green and blue of Y22";

/// Light by direction at all vertices.
fn directional<'a>(scene: &'a Scene, light: &'a [IncidentRadiance]) -> Vec<Attribute<'a>> {
    let of_band = |name, first: usize, color: usize| {
        Attribute::new(name, move |_, corner| {
            let coefficients = light[vertex(scene, corner)].coefficients();
            [0, 1, 2, 3].map(|k| coefficients[first + k][color])
        })
    };
    let mut attributes: Vec<Attribute<'a>> =
        ["_SH1R", "_SH1G", "_SH1B"].into_iter().enumerate().map(|(k, name)| of_band(name, 0, k)).collect();
    if light.iter().any(|light| light.kind() == Directional::Sh2) {
        let names = ["_SH2R", "_SH2G", "_SH2B"].into_iter().enumerate();
        attributes.extend(names.map(|(k, name)| of_band(name, 4, k)));
        let last = |_, corner| light[vertex(scene, corner)].coefficients()[HARMONICS - 1].to_array();
        attributes.push(Attribute::new("_SH22", last));
    }
    let dominant = |_, corner| light[vertex(scene, corner)].dominant().to_array();
    attributes.push(Attribute::new("_DIRECTION", dominant));
    attributes
}

/// `COLOR_0`: what times the base colour is seen.
fn color(scene: &Scene, irradiance: &[Vec3], exposure: f32, material: MaterialId, corner: u32) -> Vec3 {
    let vertex = vertex(scene, corner);
    let irradiance = irradiance[vertex];
    let color = match Shown::of(&scene.materials()[material.index()]) {
        Shown::Colors => {
            let bary = Barycentrics::CORNERS[corner as usize % 3];
            seen_radiance(scene, SurfacePoint { tri: TriId(corner / 3), bary }, irradiance).0
        }
        _ => white_radiance(irradiance) * scene.tints()[vertex],
    };
    (color * exposure).clamp(Vec3::ZERO, Vec3::ONE)
}
