//! Rectangle lights that the camera sees directly.

use glam::{Vec2, Vec3};
use lumel_accel::{Ray, SHADOW_END};
use lumel_scene::{Light, Radiance, RectLight, Scene, Texture};

/// A [`RectLight`] prepared for camera rays: visible from its front only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VisibleLight<'a> {
    light: &'a RectLight,
    normal: Vec3,
    texture: Option<&'a Texture>,
}

impl<'a> VisibleLight<'a> {
    /// The rectangle lights of a scene.
    pub(crate) fn all_of(scene: &'a Scene) -> Vec<Self> {
        let visible = |light: &'a Light| match light {
            Light::Rect(light) => Some(Self {
                light,
                normal: light.normal()?,
                texture: light.texture.and_then(|id| scene.textures().get(id.index())),
            }),
            _ => None,
        };
        scene.lights().iter().filter_map(visible).collect()
    }

    /// The radiance of the first light that a ray hits before it ends at `t`, if any.
    ///
    /// A light up to a ten-thousandth of the distance behind a surface counts as in front of it: shadow rays end there
    /// too, so a light may lie in the plane of a ceiling.
    pub(crate) fn nearest(lights: &[Self], ray: &Ray, t: f32) -> Option<Radiance> {
        let mut nearest = None;
        let mut end = t / SHADOW_END;
        for light in lights {
            if let Some((t, at)) = light.intersect(ray).filter(|(t, _)| *t < end) {
                end = t;
                nearest = Some((light, at));
            }
        }
        nearest.map(|(light, at)| light.radiance(at))
    }

    /// Distance and position, -1..=1 along `u` and `v`, at which a ray hits the front.
    fn intersect(&self, ray: &Ray) -> Option<(f32, Vec2)> {
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
