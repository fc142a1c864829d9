//! Rectangle lights as the shader reads them.

use bytemuck::{Pod, Zeroable};
use lumel_scene::{RectLight, TextureId};

/// A rectangle light: `rect_light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct RectLightInstance {
    center: [f32; 3],
    u: [f32; 3],
    v: [f32; 3],
    radiance: [f32; 3],
}

/// The rectangle lights that can be drawn, with their textures: those with an area and a finite position.
pub(crate) fn instances(rect_lights: &[RectLight]) -> Vec<(RectLightInstance, Option<TextureId>)> {
    let can_be_drawn = |rect_light: &&RectLight| {
        rect_light.center.is_finite()
            && rect_light.u.is_finite()
            && rect_light.v.is_finite()
            && rect_light.normal().is_some()
    };
    let instance = |rect_light: &RectLight| {
        let number = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, f32::MAX) };
        let values = RectLightInstance {
            center: rect_light.center.to_array(),
            u: rect_light.u.to_array(),
            v: rect_light.v.to_array(),
            radiance: rect_light.radiance.0.to_array().map(number),
        };
        (values, rect_light.texture)
    };
    rect_lights.iter().filter(can_be_drawn).map(instance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lumel_scene::Radiance;

    #[test]
    fn rect_lights_without_area_or_place_are_left_out() {
        let good = RectLight {
            center: Vec3::ZERO,
            u: Vec3::X,
            v: Vec3::Y,
            radiance: Radiance(Vec3::new(f32::NAN, f32::INFINITY, 2.0)),
            texture: None,
        };
        let rect_lights = [RectLight { v: Vec3::X, ..good }, RectLight { center: Vec3::NAN, ..good }, good];
        let drawn = instances(&rect_lights);
        assert_eq!(drawn.len(), 1);
        assert_eq!(drawn[0].0.radiance, [0.0, f32::MAX, 2.0]);
    }
}
