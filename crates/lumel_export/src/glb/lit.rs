//! Scenes with light at their vertices.

use super::material::{Appearance, Look, Materials, Shown};
use super::primitive::{Attribute, Only, Primitive, Streams, split, tangents, tints, uv, vertex};
use super::write;
use crate::display::{factor_at, finite_irradiance, seen_radiance, white_radiance};
use crate::{ColorScale, ExportError};
use glam::Vec3;
use lumel_basis::{Directional, HARMONICS, IncidentRadiance, Lighting, incident_at_vertices};
use lumel_scene::{Barycentrics, MaterialId, Scene, SurfacePoint, TriId};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;

/// What the materials of a lit mesh are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GltfMaterials {
    /// Unlit ones, which show the light of the bake in any viewer.
    #[default]
    Unlit,
    /// Those of the scene, which viewers light: with normal maps, metal and roughness.
    Keep,
}

/// How a lit mesh is written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GlbOptions {
    /// Its materials.
    pub materials: GltfMaterials,
    /// The scale of what unlit materials show.
    pub exposure: ColorScale,
}

impl From<ColorScale> for GlbOptions {
    fn from(exposure: ColorScale) -> Self {
        Self { exposure, ..Self::default() }
    }
}

/// Writes the lit scene as a GLB file, atomically. Returns the exposure of what it shows, 1 with kept materials.
///
/// Every object is a mesh with one primitive per material, at a node that moves it where a scene is far from the origin. Its vertices carry
/// - `_IRRADIANCE`: irradiance, W·m⁻² (lux if the lights are photometric), linear Rec. 709, exact;
/// - `COLOR_0`: radiance of a white surface under that irradiance, times the exposure, clamped to 0..=1; its fourth
///   component, in scenes that have any, is the alpha of vertices. With kept materials it is the tint and alpha of vertices;
/// - `_SH1R`, `_SH1G` and `_SH1B`, where light is known by direction: of each colour, the four coefficients of incident
///   radiance in bands 0 and 1, W·m⁻², in world space, in the order of [`Harmonics`](lumel_basis::Harmonics); `_SH2R`,
///   `_SH2G` and `_SH2B` the first four of band 2, and `_SH22` the last one of all colours;
/// - `_DIRECTION`, likewise: [where most light comes from](lumel_basis::IncidentRadiance::dominant).
///
/// Materials are one-sided, with the albedo as base colour and the radiance as emission, each with its own texture.
/// They are unlit, so that any viewer shows base colour times `COLOR_0`: radiance times exposure. Base colour can only
/// darken, so the exposure is that of white, not of the actual surfaces. Emissive surfaces without textures show
/// emitted and reflected radiance in `COLOR_0` alone, with white as base colour. Emissive surfaces with a texture are
/// lit: viewers show their emission, times the exposure, and reflect light of their own. Albedo and emission of each material
/// are in its `extras`; exposure, units and the hash of the geometry in those of `asset`. Normal
/// maps, whose green points up, and `TANGENT` are there for readers that light the scene.
/// [Kept materials](GltfMaterials::Keep) are lit, and have metal and roughness, too.
///
/// Cameras are there with their names. Rectangle lights are surfaces that emit, as bright as the rest of the file; points, spheres, spots and
/// suns are lights of `KHR_lights_punctual`, in the units of the scene. Disks and the sky have no counterpart: the `extras` of
/// `asset` name them.
///
/// # Errors
/// Light of a different scene or that is not finite, an exposure that is not positive, a scene beyond the format's limit
/// of 4 GiB, and the errors of [`write_atomically`](crate::write_atomically).
pub fn write_glb(
    path: &Path,
    scene: &Scene,
    lighting: &dyn Lighting,
    options: impl Into<GlbOptions>,
) -> Result<f32, ExportError> {
    let options = options.into();
    let irradiance = &*finite_irradiance(path, scene, lighting)?;
    let incident = incident_at_vertices(scene, lighting);
    let primitives = split(scene, None);
    let (look, colors, lit) = match options.materials {
        GltfMaterials::Keep => (Look::of(Appearance::Surfaces), tints(scene), None),
        GltfMaterials::Unlit => {
            let exposure = exposure(path, scene, irradiance, &primitives, options.exposure)?;
            let look = Look { exposure, ..Look::of(Appearance::Light) };
            (look, Some(light_colors(scene, irradiance, exposure)), Some(exposure))
        }
    };
    let materials =
        Materials::new(scene, &primitives, &look).map_err(|error| ExportError::io(path, error))?;
    let uvs = Attribute::new("TEXCOORD_0", |_, corner| uv(scene, corner));
    let mut attributes = vec![
        Attribute::new("POSITION", |_, corner| scene.positions()[vertex(scene, corner)].to_array()),
        Attribute::new("NORMAL", |_, corner| scene.normals()[vertex(scene, corner)].to_array()),
        Attribute::new("_IRRADIANCE", |_, corner| irradiance[vertex(scene, corner)].to_array()),
    ];
    attributes.extend(colors);
    attributes.push(Attribute { only: Only::Textured, ..uvs });
    attributes.extend(tangents(scene));
    let by_direction = incident.iter().flat_map(|incident| directional(scene, incident));
    attributes.extend(by_direction);
    let mut extras = json!({
        "scene": scene.name(),
        "geometry_hash": scene.geometry_hash().to_hex().as_str(),
        "_IRRADIANCE": "irradiance, W/m^2 (lux if the lights are photometric), linear Rec. 709",
    });
    if let Some(exposure) = lit {
        extras["exposure"] = json!(exposure);
        extras["emission_scale"] = json!(exposure);
        extras["COLOR_0"] = json!(COLORS);
    }
    if incident.is_some() {
        extras["_SH1R"] = json!(COEFFICIENTS);
        extras["_DIRECTION"] =
            json!("where most light comes from, as long as its share that comes from there");
    }
    let streams = Streams { scene, materials: &materials, primitives: &primitives, attributes };
    write(path, &streams, extras)?;
    Ok(lit.unwrap_or(1.0))
}

const COLORS: &str = "min(1, _IRRADIANCE / pi * vertex tint * exposure); \
                      on emitting materials without textures min(1, (emitted + reflected radiance) * exposure)";

/// The factor of what is shown.
fn exposure(
    path: &Path,
    scene: &Scene,
    irradiance: &[Vec3],
    primitives: &[Primitive],
    scale: ColorScale,
) -> Result<f32, ExportError> {
    if scale != ColorScale::Unclipped {
        return scale.factor(path, irradiance);
    }
    let shown = primitives.iter().flat_map(|primitive| {
        primitive.corners().map(|corner| seen(scene, irradiance, primitive.material, corner).max_element())
    });
    Ok(factor_at(shown, 1.0))
}

/// `COLOR_0` that is light, with the alpha of vertices where there are any.
fn light_colors<'a>(scene: &'a Scene, irradiance: &'a [Vec3], exposure: f32) -> Attribute<'a> {
    let color = move |material, corner| {
        (seen(scene, irradiance, material, corner) * exposure).clamp(Vec3::ZERO, Vec3::ONE)
    };
    if scene.alphas().is_empty() {
        return Attribute::new("COLOR_0", move |material, corner| color(material, corner).to_array());
    }
    Attribute::new("COLOR_0", move |material, corner| {
        color(material, corner).extend(scene.alphas()[vertex(scene, corner)]).to_array()
    })
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

/// The radiance that times the base colour is seen.
fn seen(scene: &Scene, irradiance: &[Vec3], material: MaterialId, corner: u32) -> Vec3 {
    let vertex = vertex(scene, corner);
    let irradiance = irradiance[vertex];
    match Shown::of(&scene.materials()[material.index()]) {
        Shown::Colors => {
            let bary = Barycentrics::CORNERS[corner as usize % 3];
            seen_radiance(scene, SurfacePoint { tri: TriId(corner / 3), bary }, irradiance).0
        }
        _ => white_radiance(irradiance) * scene.tints()[vertex],
    }
}
