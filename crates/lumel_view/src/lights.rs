//! Editable lights.

use crate::light_shape::{frame_of, of_kind, with_frame};
use glam::{Vec2, Vec3};
use lumel::{Light, LightEntry, LightKind, RectLight};
use lumel_scene::{Radiance, TextureId, luminance};
use std::path::PathBuf;

/// Half-edges below this share of the scene's diagonal are not offered: shadows could not get sharper to the eye.
const SMALLEST: f32 = 1e-4;

/// Half-edges beyond this share of the scene's diagonal are not offered.
const LARGEST: f32 = 0.5;

/// No half-edge is shorter, metres: the square of an area must still be a number above zero.
const SHORTEST: f32 = 1e-8;

/// What resizing a light preserves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resize {
    /// Radiance stays, so that power grows with the area.
    #[default]
    KeepRadiance,
    /// Power stays.
    KeepPower,
}

/// A light under a name, with what an editor has to know of it.
#[derive(Clone, Debug, PartialEq)]
pub struct EditLight {
    /// Its name in the list.
    pub name: String,
    /// The light, or the rectangle that stands for its place, direction, size and strength.
    pub rect: RectLight,
    /// The light, if it is no rectangle, with its last strength and place but for what `rect` says now.
    pub other: Option<Light>,
    /// Where the image of its texture lies, for project files.
    pub texture_path: Option<PathBuf>,
    /// Whether it shines and is drawn.
    pub on: bool,
    /// What resizing does.
    pub resize: Resize,
    /// Whether both half-edges are kept equal.
    pub square: bool,
}

impl EditLight {
    /// A light as a scene has it.
    pub fn new(name: String, rect: RectLight) -> Self {
        let [a, b] = [rect.u.length(), rect.v.length()];
        let square = (a - b).abs() <= 1e-4 * a.max(b);
        Self { name, rect, other: None, texture_path: None, on: true, resize: Resize::default(), square }
    }

    /// Any light as a scene has it.
    pub fn from_light(name: String, light: &Light) -> Self {
        let other = (!matches!(light, Light::Rect(_))).then_some(*light);
        Self { other, ..Self::new(name, frame_of(light)) }
    }

    /// The light as it is now.
    pub fn light(&self) -> Light {
        self.other.map_or(Light::Rect(self.rect), |light| with_frame(&light, &self.rect))
    }

    /// Its kind.
    pub fn kind(&self) -> LightKind {
        self.other.as_ref().map_or(LightKind::Rect, LightKind::of)
    }

    /// Makes it a light of another kind in the same place.
    pub fn set_kind(&mut self, kind: LightKind) {
        if kind != self.kind() {
            if kind != LightKind::Rect {
                (self.rect.texture, self.texture_path, self.square) = (None, None, true);
            }
            let light = of_kind(kind, &self.rect);
            self.set_light(light);
        }
    }

    /// Makes it another light in the same place.
    pub fn set_light(&mut self, light: Light) {
        let center = self.rect.center;
        self.other = (!matches!(light, Light::Rect(_))).then_some(light);
        // A light without a place stays where its handles are.
        self.rect = RectLight { center, texture: self.rect.texture, ..frame_of(&light) };
    }

    /// A light of a project file; `texture` is its image in the scene.
    pub fn from_entry(index: usize, entry: &LightEntry, texture: Option<TextureId>) -> Self {
        let name = entry.name.clone().unwrap_or_else(|| default_name(index));
        let mut light = entry.light().map_or_else(
            |_| Self::new(name.clone(), RectLight::new(Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::ZERO)),
            |light| Self::from_light(name.clone(), &light),
        );
        light.rect.texture = texture;
        let resize = if entry.constant_power { Resize::KeepPower } else { Resize::KeepRadiance };
        Self { texture_path: entry.texture.clone(), on: !entry.off, resize, ..light }
    }

    /// The light for a project file.
    pub fn entry(&self) -> LightEntry {
        LightEntry {
            name: Some(self.name.clone()),
            texture: self.texture_path.clone(),
            off: !self.on,
            constant_power: self.resize == Resize::KeepPower,
            ..LightEntry::from(&self.light())
        }
    }

    /// Half the lengths of its edges, metres.
    pub fn half_edges(&self) -> Vec2 {
        Vec2::new(self.rect.u.length(), self.rect.v.length())
    }

    /// Gives it other half-edges, metres; both are kept above zero.
    pub fn set_half_edges(&mut self, half: Vec2) {
        let before = self.rect.area();
        let length = |wanted: f32, old: Vec3, other: Vec3| {
            let axis = old.try_normalize().unwrap_or_else(|| other.any_orthonormal_vector());
            axis * wanted.max(SHORTEST)
        };
        let (u, v) = (self.rect.u, self.rect.v);
        self.rect.u = length(half.x, u, v);
        self.rect.v = length(half.y, v, u);
        if self.resize == Resize::KeepPower {
            let scale = before / self.rect.area();
            if scale.is_finite() {
                self.rect.radiance = Radiance(self.rect.radiance.0 * scale);
            }
        }
    }

    /// Power of each channel without its texture, W.
    pub fn power(&self) -> Vec3 {
        self.rect.radiance.power(self.rect.area())
    }

    /// Its radiance as a largest channel and a colour, 0..=1 each.
    pub fn intensity_and_color(&self) -> (f32, Vec3) {
        let radiance = self.rect.radiance.0;
        let intensity = radiance.max_element();
        (intensity, if intensity > 0.0 { radiance / intensity } else { Vec3::ONE })
    }

    /// Sets its radiance from a largest channel and a colour.
    pub fn set_intensity_and_color(&mut self, intensity: f32, color: Vec3) {
        let largest = color.max_element();
        let color = if largest > 0.0 { color / largest } else { Vec3::ONE };
        self.rect.radiance = Radiance(color * intensity.max(0.0));
    }

    /// Puts it somewhere, facing along `forward`, with its edges along `right` and `up`: a camera's axes.
    pub fn place(&mut self, position: Vec3, [right, up, forward]: [Vec3; 3]) {
        let Vec2 { x, y } = self.half_edges();
        self.rect.center = position;
        // Light leaves on the u × v side.
        self.rect.u = -right * x;
        self.rect.v = up * y;
        debug_assert!(self.rect.normal().is_none_or(|n| n.dot(forward) > 0.99));
    }

    /// Turns it towards a point, with its edges level where there is a horizon; nothing for the point where it is.
    pub fn aim_at(&mut self, at: Vec3) {
        let camera = lumel::Camera::looking_at("", self.rect.center, at, 1.0);
        if let Some(axes) = camera.axes() {
            self.place(self.rect.center, axes);
        }
    }

    /// Where it looks: degrees to the left about +Y from -z, and degrees upwards.
    pub fn direction_deg(&self) -> Vec2 {
        let n = self.rect.normal().unwrap_or(Vec3::NEG_Y);
        let elevation = n.y.clamp(-1.0, 1.0).asin().to_degrees().clamp(-90.0, 90.0);
        Vec2::new((-n.x).atan2(-n.z).to_degrees().clamp(-180.0, 180.0), elevation)
    }

    /// Turns it to look there.
    pub fn set_direction_deg(&mut self, Vec2 { x: yaw_deg, y: pitch_deg }: Vec2) {
        let camera = crate::camera::FlyCamera {
            yaw_deg,
            pitch_deg: pitch_deg.clamp(-90.0, 90.0),
            ..Default::default()
        };
        self.place(self.rect.center, [camera.right(), camera.up(), camera.forward()]);
    }

    /// Luminance of its radiance.
    pub fn brightness(&self) -> f32 {
        luminance(self.rect.radiance.0)
    }
}

/// The lights that are on, for the solver.
pub fn shining(lights: &[EditLight]) -> Vec<Light> {
    lights.iter().filter(|light| light.on).map(EditLight::light).collect()
}

/// The rectangles that are on, for the renderer.
pub fn drawn(lights: &[EditLight]) -> Vec<RectLight> {
    lights.iter().filter(|light| light.on && light.other.is_none()).map(|light| light.rect).collect()
}

/// What the light with this index is called until it is renamed.
pub fn default_name(index: usize) -> String {
    format!("Light {}", index + 1)
}

/// The half-edges that sliders offer in a scene of this diagonal, metres.
pub fn half_edge_range(diagonal: f32) -> std::ops::RangeInclusive<f32> {
    SMALLEST * diagonal..=LARGEST * diagonal
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light() -> EditLight {
        let rect = RectLight {
            center: Vec3::ONE,
            u: Vec3::new(0.5, 0.0, 0.0),
            v: Vec3::new(0.0, 0.0, 0.5),
            radiance: Radiance(Vec3::new(8.0, 4.0, 2.0)),
            texture: None,
        };
        EditLight::new("lamp".into(), rect)
    }

    #[test]
    fn constant_power_keeps_power_and_the_default_keeps_radiance() {
        let mut lamp = light();
        let power = lamp.power();
        lamp.set_half_edges(Vec2::new(1.0, 0.5));
        assert_eq!(lamp.rect.radiance.0, Vec3::new(8.0, 4.0, 2.0));
        assert!((lamp.power() - 2.0 * power).length() < 1e-4);
        let mut lamp = EditLight { resize: Resize::KeepPower, ..light() };
        lamp.set_half_edges(Vec2::new(0.1, 2.0));
        assert!((lamp.power() / power - Vec3::ONE).length() < 1e-5);
    }

    #[test]
    fn a_placed_light_faces_where_the_camera_looks() {
        let camera = crate::camera::FlyCamera { yaw_deg: 33.0, pitch_deg: -20.0, ..Default::default() };
        let mut lamp = light();
        lamp.place(Vec3::new(1.0, 2.0, 3.0), [camera.right(), camera.up(), camera.forward()]);
        assert!(lamp.rect.normal().unwrap().dot(camera.forward()) > 0.999_99);
        assert!((lamp.half_edges() - Vec2::splat(0.5)).length() < 1e-6);
        let direction = lamp.direction_deg();
        assert!((direction - Vec2::new(33.0, -20.0)).length() < 1e-3, "{direction}");
        lamp.set_direction_deg(Vec2::new(-120.0, 45.0));
        assert!((lamp.direction_deg() - Vec2::new(-120.0, 45.0)).length() < 1e-2);
    }

    #[test]
    fn lights_survive_project_files() {
        let lamp = EditLight { on: false, resize: Resize::KeepPower, ..light() };
        assert_eq!(EditLight::from_entry(0, &lamp.entry(), None), lamp);
        let nameless = LightEntry { name: None, ..lamp.entry() };
        assert_eq!(EditLight::from_entry(4, &nameless, None).name, "Light 5");
    }

    #[test]
    fn every_kind_stays_in_its_place_and_survives_project_files() {
        for kind in LightKind::ALL {
            let mut lamp = light();
            lamp.rect.center = Vec3::new(1.0, 2.0, 3.0);
            lamp.set_kind(kind);
            assert_eq!((lamp.kind(), lamp.rect.center), (kind, Vec3::new(1.0, 2.0, 3.0)));
            assert!(lamp.light().position().is_none_or(|position| position == lamp.rect.center));
            let normal = lamp.rect.normal().unwrap();
            assert!(kind == LightKind::Point || normal.dot(-Vec3::Y) > 0.999, "{kind:?} keeps its direction");
            let again = EditLight::from_entry(0, &lamp.entry(), None);
            assert_eq!((again.kind(), &again.name), (kind, &lamp.name));
            assert!((again.light().strength() - Vec3::new(8.0, 4.0, 2.0)).length() < 1e-5);
            lamp.set_kind(LightKind::Rect);
            assert!(lamp.rect.normal().is_some() && lamp.other.is_none());
        }
    }

    #[test]
    fn sizes_and_colours_stay_sensible_at_their_limits() {
        let mut lamp = light();
        lamp.set_half_edges(Vec2::ZERO);
        assert!(lamp.rect.area() > 0.0 && lamp.rect.normal().is_some());
        lamp.set_intensity_and_color(3.0, Vec3::ZERO);
        assert_eq!(lamp.rect.radiance.0, Vec3::splat(3.0));
        lamp.set_intensity_and_color(-1.0, Vec3::new(0.2, 0.1, 0.0));
        assert_eq!(lamp.intensity_and_color(), (0.0, Vec3::ONE));
    }
}
