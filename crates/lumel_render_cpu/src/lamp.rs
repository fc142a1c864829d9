//! Rectangle lights as the eye sees them.

use glam::{Vec2, Vec3};
use lumel_accel::{Ray, SHADOW_END};
use lumel_scene::{Light, Radiance, RectLight, Scene, Texture};

/// A [`RectLight`] prepared for rays from the eye: visible from its front, nothing from behind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lamp<'a> {
    light: &'a RectLight,
    normal: Vec3,
    texture: Option<&'a Texture>,
}

impl<'a> Lamp<'a> {
    /// The lamps of a scene.
    pub(crate) fn all_of(scene: &'a Scene) -> Vec<Self> {
        let lamp = |light: &'a Light| match light {
            Light::Rect(light) => Some(Self {
                light,
                normal: light.normal()?,
                texture: light.texture.and_then(|id| scene.textures().get(id.index())),
            }),
            _ => None,
        };
        scene.lights().iter().filter_map(lamp).collect()
    }

    /// The radiance of the lamp that a ray meets first before it ends at `t`, if any.
    ///
    /// A lamp counts as before a surface from the last ten-thousandth of the way behind it on: shadow rays pass
    /// there too, so that a lamp may lie in a ceiling.
    pub(crate) fn nearest(lamps: &[Self], ray: &Ray, t: f32) -> Option<Radiance> {
        let mut nearest = None;
        let mut end = t / SHADOW_END;
        for lamp in lamps {
            if let Some((t, at)) = lamp.meet(ray).filter(|(t, _)| *t < end) {
                end = t;
                nearest = Some((lamp, at));
            }
        }
        nearest.map(|(lamp, at)| lamp.radiance(at))
    }

    /// Distance and position, -1..=1 along `u` and `v`, where a ray meets the front.
    fn meet(&self, ray: &Ray) -> Option<(f32, Vec2)> {
        let RectLight { center, u, v, .. } = *self.light;
        let facing = -ray.direction.dot(self.normal);
        if facing <= 0.0 {
            return None;
        }
        let t = (ray.origin - center).dot(self.normal) / facing;
        let from_center = ray.origin + t * ray.direction - center;
        let at = Vec2::new(from_center.dot(u) / u.length_squared(), from_center.dot(v) / v.length_squared());
        (t > 0.0 && at.abs().max_element() <= 1.0).then_some((t, at))
    }

    fn radiance(&self, at: Vec2) -> Radiance {
        let uv = Vec2::new(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
        let factor = self.texture.map_or(Vec3::ONE, |texture| texture.sample(uv));
        Radiance(self.light.radiance.0 * factor)
    }
}
