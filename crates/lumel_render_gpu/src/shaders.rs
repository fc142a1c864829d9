//! The sources of the shaders, composed from the files in `shaders/`.

use glam::Vec3;
use lumel_render_cpu::Ripple;
use lumel_scene::{MAX_ALBEDO, Radiosity, luminance};

/// One composed shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shader {
    Value,
    LumelValue,
    Surface,
    Relief,
    Places,
    Gather,
    PointSurface,
    Normals,
    Plain,
    RectLight,
    Backdrop,
    Tone,
    Overlay,
    Composite,
}

impl Shader {
    /// In the order of their numbers.
    pub(crate) const ALL: [Self; 14] = [
        Self::Value,
        Self::LumelValue,
        Self::Surface,
        Self::Relief,
        Self::Places,
        Self::Gather,
        Self::PointSurface,
        Self::Normals,
        Self::Plain,
        Self::RectLight,
        Self::Backdrop,
        Self::Tone,
        Self::Overlay,
        Self::Composite,
    ];
}

const VIEW: &str = include_str!("../shaders/view.wgsl");
const MATERIAL: &str = include_str!("../shaders/material.wgsl");
const TEXTURES: &str = include_str!("../shaders/textures.wgsl");
const PAINT: &str = include_str!("../shaders/paint.wgsl");
const TILT: &str = include_str!("../shaders/tilt.wgsl");
const LUMELS: &str = include_str!("../shaders/lumels.wgsl");
const HEADLIGHT: &str = include_str!("../shaders/headlight.wgsl");
const SCREEN: &str = include_str!("../shaders/screen.wgsl");

/// A shader's parts, joined.
pub(crate) fn source(shader: Shader) -> String {
    let parts: &[&str] = match shader {
        Shader::Value => &[VIEW, MATERIAL, include_str!("../shaders/value.wgsl")],
        Shader::LumelValue => &[VIEW, LUMELS, HEADLIGHT, include_str!("../shaders/lumel_value.wgsl")],
        Shader::Surface => {
            &[VIEW, MATERIAL, TEXTURES, PAINT, LUMELS, include_str!("../shaders/surface.wgsl")]
        }
        Shader::Relief => &[
            VIEW,
            MATERIAL,
            TEXTURES,
            PAINT,
            LUMELS,
            TILT,
            include_str!("../shaders/shading.wgsl"),
            include_str!("../shaders/lumel_moments.wgsl"),
            include_str!("../shaders/relief.wgsl"),
        ],
        Shader::Places => &[VIEW, MATERIAL, TEXTURES, PAINT, include_str!("../shaders/places.wgsl")],
        Shader::Gather => &[SCREEN, include_str!("../shaders/gather.wgsl")],
        Shader::PointSurface => {
            &[VIEW, MATERIAL, TEXTURES, PAINT, include_str!("../shaders/point_surface.wgsl")]
        }
        Shader::Normals => &[VIEW, MATERIAL, TEXTURES, TILT, include_str!("../shaders/normals.wgsl")],
        Shader::Plain => &[VIEW, HEADLIGHT, include_str!("../shaders/plain.wgsl")],
        Shader::RectLight => &[VIEW, include_str!("../shaders/rect_light.wgsl")],
        Shader::Backdrop => &[VIEW, SCREEN, include_str!("../shaders/backdrop.wgsl")],
        Shader::Tone => &[SCREEN, include_str!("../shaders/tone.wgsl")],
        Shader::Overlay => &[VIEW, include_str!("../shaders/overlay.wgsl")],
        Shader::Composite => &[SCREEN, include_str!("../shaders/composite.wgsl")],
    };
    constants() + &parts.join("\n")
}

/// A light up to this fraction behind a surface counts as in front of it: `SHADOW_END` of `lumel_accel`, as in
/// `lumel_render_cpu`.
const SHADOW_END: f32 = 1.0 - 1e-4;

/// The largest 16-bit float.
pub(crate) const MAX_F16: f32 = 65_504.0;

/// The most pages of an atlas: layers that every device has.
pub(crate) const MAX_PAGES: usize = 256;

/// The most levels of scattered points: more than settings allow.
pub(crate) const MAX_LEVELS: usize = 16;

/// Constants that are defined elsewhere.
fn constants() -> String {
    let [r, g, b] = [Vec3::X, Vec3::Y, Vec3::Z].map(luminance);
    let waves =
        Ripple::WAVES.map(|w| format!("vec4<f32>({:?}, {:?}, {:?}, {:?})", w.x, w.y, w.z, w.w)).join(", ");
    let inverse_pi = Radiosity(Vec3::ONE).radiance().0.x;
    format!(
        "const LUMINANCE = vec3<f32>({r:?}, {g:?}, {b:?});\n\
         const INVERSE_PI: f32 = {inverse_pi:?};\n\
         const MAX_ALBEDO: f32 = {MAX_ALBEDO:?};\n\
         const SHADOW_END: f32 = {SHADOW_END:?};\n\
         const MAX_F16: f32 = {MAX_F16:?};\n\
         const MAX_PAGES: u32 = {MAX_PAGES}u;\n\
         const MAX_LEVELS: u32 = {MAX_LEVELS}u;\n\
         const WAVES = array<vec4<f32>, 4>({waves});\n\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    #[test]
    fn every_shader_is_valid_without_optional_capabilities() {
        for shader in Shader::ALL {
            let source = source(shader);
            let module = naga::front::wgsl::parse_str(&source)
                .unwrap_or_else(|error| panic!("{shader:?}: {}", error.emit_to_string(&source)));
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            validator
                .validate(&module)
                .unwrap_or_else(|error| panic!("{shader:?}: {}", error.emit_to_string(&source)));
        }
    }

    #[test]
    fn shaders_are_numbered_in_order() {
        for (i, shader) in Shader::ALL.into_iter().enumerate() {
            assert_eq!(shader as usize, i);
        }
    }
}
