//! Data as the shaders read it: order and padding are those of the structs of the same names in `shaders/`.

use bytemuck::{Pod, Zeroable};
use lumel_render_cpu::Ripple;
use lumel_scene::{AlphaMode, Camera, Material, Sky, SkyGradient, TextureRef, Transparency, UvTransform};

/// The camera and the exposure: `view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct View {
    eye: [f32; 3],
    near: f32,
    right: [f32; 3],
    exposure: f32,
    up: [f32; 3],
    closer: f32,
    forward: [f32; 3],
    phase: f32,
    size: [f32; 2],
    ripple: [f32; 2],
}

/// A material: `material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MaterialValues {
    albedo: [f32; 4],
    emission: [f32; 4],
    albedo_uv: [[f32; 4]; 2],
    emission_uv: [[f32; 4]; 2],
    normal_uv: [[f32; 4]; 2],
    normal_tilt: [f32; 4],
    alpha_uv: [[f32; 4]; 2],
}

/// A sky: `backdrop.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(crate) struct BackdropValues {
    zenith: [f32; 3],
    turns: f32,
    horizon: [f32; 3],
    strength: f32,
    ground: [f32; 3],
    unused: f32,
}

/// Settings of the tone mapper: `tone.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Tone {
    pub(crate) white: f32,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) logarithmic: f32,
}

/// How far in front of its surface a mark is drawn at least, as a fraction of the distance.
const CLOSER: f32 = 1e-4;

/// The same in pixels at its distance: enough for a dot on a surface tilted by 60°.
const CLOSER_PIXELS: f32 = 4.0;

/// The same at most, where pixels are large.
const CLOSEST: f32 = 0.02;

impl View {
    /// `exposure` multiplies linear values. `None` for a camera without a view; see
    /// [`lumel_render_cpu::Lens`].
    pub(crate) fn new(
        camera: &Camera,
        near: f32,
        size: [u32; 2],
        exposure: f32,
        ripple: Option<Ripple>,
    ) -> Option<Self> {
        let [width, height] = size.map(|n| n as f32);
        let aspect = (f64::from(size[0]) / f64::from(size[1])) as f32;
        lumel_render_cpu::Lens::new(camera, aspect).ok()?;
        let [right, up, forward] = camera.axes()?;
        let h = (0.5 * camera.fov_y).tan();
        let pixel = 2.0 * h / height;
        Some(Self {
            eye: camera.position.to_array(),
            near,
            right: (right / (h * aspect)).to_array(),
            exposure,
            up: (up / h).to_array(),
            closer: 1.0 + (CLOSER + CLOSER_PIXELS * pixel).min(CLOSEST),
            forward: forward.to_array(),
            phase: ripple.map_or(0.0, |ripple| ripple.phase),
            size: [width, height],
            ripple: ripple.map_or([1.0, 0.0], |ripple| [ripple.length, ripple.slope]),
        })
    }
}

impl BackdropValues {
    /// `None` for a sky that is the same everywhere.
    pub(crate) fn of(sky: &Sky) -> Option<Self> {
        match sky {
            Sky::Uniform(_) => None,
            Sky::Gradient(SkyGradient { zenith, horizon, ground }) => Some(Self {
                zenith: zenith.0.to_array(),
                horizon: horizon.0.to_array(),
                ground: ground.0.to_array(),
                ..Self::default()
            }),
            Sky::Image(image) => {
                let turns = (f64::from(image.rotation()).to_degrees() / 360.0).fract() as f32;
                Some(Self { turns, strength: image.strength(), ..Self::default() })
            }
        }
    }
}

/// In place of the least alpha of a mask: the share of pixels that are there is alpha.
const DITHERED: f32 = -1.0;

impl MaterialValues {
    pub(crate) fn new(material: &Material) -> Self {
        let rows = |map: Option<TextureRef>| uv_rows(map.map_or(UvTransform::default(), |map| map.transform));
        let normals = material.normal_texture;
        let Transparency { mode, alpha, texture, transmission } = material.transparency;
        // Opaque, unless it is glass.
        let alpha = if mode == AlphaMode::Opaque { 1.0 } else { alpha };
        let opacity = alpha * (1.0 - transmission.element_sum() / 3.0);
        let cutoff = if let AlphaMode::Mask { cutoff } = mode { cutoff } else { DITHERED };
        Self {
            albedo: material.albedo.extend(opacity).to_array(),
            emission: material.emission.0.extend(cutoff).to_array(),
            albedo_uv: rows(material.albedo_texture),
            emission_uv: rows(material.emission_texture),
            normal_uv: rows(normals.map(|map| map.image)),
            normal_tilt: normals.map(|map| map.tangent_from_texel().to_cols_array()).unwrap_or_default(),
            alpha_uv: rows(texture),
        }
    }
}

/// [`UvTransform::apply`] as the rows of a matrix.
fn uv_rows(transform: UvTransform) -> [[f32; 4]; 2] {
    let (sin, cos) = transform.rotation.sin_cos();
    let UvTransform { offset, scale, .. } = transform;
    [[cos * scale.x, sin * scale.y, offset.x, 0.0], [-sin * scale.x, cos * scale.y, offset.y, 0.0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders;
    use glam::Vec2;
    use std::mem::offset_of;

    /// Size of a struct in WGSL, and its members with their offsets.
    fn in_wgsl(source: &str, name: &str) -> (usize, Vec<(String, usize)>) {
        let module = naga::front::wgsl::parse_str(source).unwrap();
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap().1;
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
        let members = members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize)).collect();
        (*span as usize, members)
    }

    fn offsets<const N: usize>(named: [(&str, usize); N]) -> Vec<(String, usize)> {
        named.map(|(name, offset)| (name.to_owned(), offset)).into()
    }

    #[test]
    fn the_camera_has_the_layout_of_its_shader() {
        let (span, members) = in_wgsl(&shaders::source(shaders::Shader::Value), "View");
        assert_eq!(span, size_of::<View>());
        let ours = offsets([
            ("eye", offset_of!(View, eye)),
            ("near", offset_of!(View, near)),
            ("right", offset_of!(View, right)),
            ("exposure", offset_of!(View, exposure)),
            ("up", offset_of!(View, up)),
            ("closer", offset_of!(View, closer)),
            ("forward", offset_of!(View, forward)),
            ("phase", offset_of!(View, phase)),
            ("size", offset_of!(View, size)),
            ("ripple", offset_of!(View, ripple)),
        ]);
        assert_eq!(members, ours);
    }

    #[test]
    fn materials_have_the_layout_of_their_shader() {
        let (span, members) = in_wgsl(&shaders::source(shaders::Shader::Surface), "Material");
        assert_eq!(span, size_of::<MaterialValues>());
        let ours = offsets([
            ("albedo", offset_of!(MaterialValues, albedo)),
            ("emission", offset_of!(MaterialValues, emission)),
            ("albedo_u", offset_of!(MaterialValues, albedo_uv)),
            ("albedo_v", offset_of!(MaterialValues, albedo_uv) + 16),
            ("emission_u", offset_of!(MaterialValues, emission_uv)),
            ("emission_v", offset_of!(MaterialValues, emission_uv) + 16),
            ("normal_u", offset_of!(MaterialValues, normal_uv)),
            ("normal_v", offset_of!(MaterialValues, normal_uv) + 16),
            ("normal_tilt", offset_of!(MaterialValues, normal_tilt)),
            ("alpha_u", offset_of!(MaterialValues, alpha_uv)),
            ("alpha_v", offset_of!(MaterialValues, alpha_uv) + 16),
        ]);
        assert_eq!(members, ours);
    }

    #[test]
    fn a_sky_has_the_layout_of_its_shader() {
        let (span, members) = in_wgsl(&shaders::source(shaders::Shader::Backdrop), "Backdrop");
        assert_eq!(span, size_of::<BackdropValues>());
        let ours = offsets([
            ("zenith", offset_of!(BackdropValues, zenith)),
            ("turns", offset_of!(BackdropValues, turns)),
            ("horizon", offset_of!(BackdropValues, horizon)),
            ("strength", offset_of!(BackdropValues, strength)),
            ("ground", offset_of!(BackdropValues, ground)),
            ("unused", offset_of!(BackdropValues, unused)),
        ]);
        assert_eq!(members, ours);
    }

    #[test]
    fn the_tone_mapper_has_the_layout_of_its_shader() {
        let (span, members) = in_wgsl(&shaders::source(shaders::Shader::Tone), "Tone");
        assert_eq!(span, size_of::<Tone>());
        let ours = offsets([
            ("white", offset_of!(Tone, white)),
            ("low", offset_of!(Tone, low)),
            ("high", offset_of!(Tone, high)),
            ("logarithmic", offset_of!(Tone, logarithmic)),
        ]);
        assert_eq!(members, ours);
    }

    #[test]
    fn the_rows_of_a_uv_transform_do_what_it_does() {
        let transform =
            UvTransform { offset: Vec2::new(0.3, -2.0), rotation: 0.7, scale: Vec2::new(-2.0, 3.0) };
        let uv = Vec2::new(0.4, 1.7);
        let by_rows = uv_rows(transform).map(|row| row[0] * uv.x + row[1] * uv.y + row[2]);
        assert!((transform.apply(uv) - Vec2::from(by_rows)).length() < 1e-6);
    }
}
