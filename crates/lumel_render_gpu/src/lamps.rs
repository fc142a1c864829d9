//! Rectangle lights as the shader reads them.

use bytemuck::{Pod, Zeroable};
use lumel_scene::{RectLight, TextureId};

/// A lamp: `lamp.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LampInstance {
    center: [f32; 3],
    u: [f32; 3],
    v: [f32; 3],
    radiance: [f32; 3],
}

/// The lamps that can be drawn, with their textures: those that have an area and are where one can say.
pub(crate) fn instances(lamps: &[RectLight]) -> Vec<(LampInstance, Option<TextureId>)> {
    let can_be_drawn = |lamp: &&RectLight| {
        lamp.center.is_finite() && lamp.u.is_finite() && lamp.v.is_finite() && lamp.normal().is_some()
    };
    let instance = |lamp: &RectLight| {
        let number = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, f32::MAX) };
        let values = LampInstance {
            center: lamp.center.to_array(),
            u: lamp.u.to_array(),
            v: lamp.v.to_array(),
            radiance: lamp.radiance.0.to_array().map(number),
        };
        (values, lamp.texture)
    };
    lamps.iter().filter(can_be_drawn).map(instance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lumel_scene::Radiance;

    #[test]
    fn lamps_without_area_or_place_are_left_out() {
        let good = RectLight {
            center: Vec3::ZERO,
            u: Vec3::X,
            v: Vec3::Y,
            radiance: Radiance(Vec3::new(f32::NAN, f32::INFINITY, 2.0)),
            texture: None,
        };
        let lamps = [RectLight { v: Vec3::X, ..good }, RectLight { center: Vec3::NAN, ..good }, good];
        let drawn = instances(&lamps);
        assert_eq!(drawn.len(), 1);
        assert_eq!(drawn[0].0.radiance, [0.0, f32::MAX, 2.0]);
    }
}
