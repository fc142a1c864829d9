//! Lights that are not surfaces.

use crate::units::disk_area;
use crate::{Radiance, TextureId};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A one-sided rectangle that emits the same radiance in all directions of its front.
///
/// Light leaves on the `u × v` side. It is not geometry: rays pass through it and it reflects nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RectLight {
    /// Centre.
    pub center: Vec3,
    /// Half of the one edge.
    pub u: Vec3,
    /// Half of the other edge, at a right angle to `u`.
    pub v: Vec3,
    /// Emitted radiance, W·m⁻²·sr⁻¹; multiplies the texture when there is one.
    pub radiance: Radiance,
    /// Radiance over the rectangle, relative to `radiance`: the image's right is `+u`, its top `+v`.
    pub texture: Option<TextureId>,
}

impl RectLight {
    /// Area of the rectangle, m².
    pub fn area(&self) -> f32 {
        4.0 * self.u.cross(self.v).length()
    }

    /// Unit vector towards the lit side; `None` for a rectangle without area.
    pub fn normal(&self) -> Option<Vec3> {
        self.u.cross(self.v).try_normalize()
    }

    /// The four corners, counter-clockwise seen from the lit side.
    pub fn corners(&self) -> [Vec3; 4] {
        let Self { center, u, v, .. } = *self;
        [center - u - v, center + u - v, center + u + v, center - u + v]
    }

    /// The point at `(s, t)` of the unit square.
    #[inline]
    pub fn point(&self, [s, t]: [f32; 2]) -> Vec3 {
        self.center + self.u * (2.0 * s - 1.0) + self.v * (2.0 * t - 1.0)
    }
}

/// A point that shines the same in all directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointLight {
    /// Position.
    pub position: Vec3,
    /// Radiant intensity, W·sr⁻¹.
    pub intensity: Vec3,
    /// Distance beyond which it does not reach, metres; infinity for no limit.
    pub range: f32,
}

/// A point that shines into a cone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpotLight {
    /// Position, intensity along the axis and reach.
    pub point: PointLight,
    /// The axis, unit vector away from the light.
    pub direction: Vec3,
    /// Cosine of the angle from the axis where the light begins to fall off.
    pub cos_inner: f32,
    /// Cosine of the angle from the axis where it has faded to nothing; less than `cos_inner`.
    pub cos_outer: f32,
}

/// Parallel light from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectionalLight {
    /// The direction the light travels in, unit vector.
    pub direction: Vec3,
    /// Irradiance on a surface that faces it, W·m⁻².
    pub irradiance: Vec3,
}

/// Light from a disk in the sky: parallel but for its angular size, which makes shadows soft.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SunLight {
    /// Direction, and irradiance on a surface that faces the middle of the disk.
    pub parallel: DirectionalLight,
    /// Sine of half the angular diameter, above 0 and up to 1.
    pub sin_half_angle: f32,
}

/// A one-sided disk that emits the same radiance in all directions of its front. It is not geometry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiskLight {
    /// Centre.
    pub center: Vec3,
    /// The direction of its lit side, unit vector.
    pub direction: Vec3,
    /// Radius, metres.
    pub radius: f32,
    /// Emitted radiance, W·m⁻²·sr⁻¹.
    pub radiance: Radiance,
}

/// A sphere that emits the same radiance in all directions outwards. It is not geometry, and dark inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SphereLight {
    /// Centre.
    pub center: Vec3,
    /// Radius, metres.
    pub radius: f32,
    /// Emitted radiance, W·m⁻²·sr⁻¹.
    pub radiance: Radiance,
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Light {
    /// A rectangle.
    Rect(RectLight),
    /// A point.
    Point(PointLight),
    /// A cone.
    Spot(SpotLight),
    /// A far-away sun without size.
    Directional(DirectionalLight),
    /// A far-away sun with an angular size.
    Sun(SunLight),
    /// A disk.
    Disk(DiskLight),
    /// A sphere.
    Sphere(SphereLight),
}

impl Light {
    /// Radiance, intensity or irradiance, whichever the kind has: zero for a light that does not shine.
    pub fn strength(&self) -> Vec3 {
        match self {
            Self::Rect(light) => light.radiance.0,
            Self::Point(light) => light.intensity,
            Self::Spot(light) => light.point.intensity,
            Self::Directional(light) => light.irradiance,
            Self::Sun(light) => light.parallel.irradiance,
            Self::Disk(light) => light.radiance.0,
            Self::Sphere(light) => light.radiance.0,
        }
    }

    /// Where it is, or its middle; `None` for one that is infinitely far away.
    pub fn position(&self) -> Option<Vec3> {
        let mut light = *self;
        light.position_mut().copied()
    }

    /// The same, to be changed.
    pub(crate) fn position_mut(&mut self) -> Option<&mut Vec3> {
        match self {
            Self::Rect(light) => Some(&mut light.center),
            Self::Point(light) => Some(&mut light.position),
            Self::Spot(light) => Some(&mut light.point.position),
            Self::Disk(light) => Some(&mut light.center),
            Self::Sphere(light) => Some(&mut light.center),
            Self::Directional(_) | Self::Sun(_) => None,
        }
    }
}

impl SunLight {
    /// The radiance of the disk.
    pub fn radiance(&self) -> Radiance {
        Radiance(self.parallel.irradiance / disk_area(self.sin_half_angle))
    }
}

impl DiskLight {
    /// Area, m².
    pub fn area(&self) -> f32 {
        disk_area(self.radius)
    }
}

impl SphereLight {
    /// The sphere of this radius that is as bright from afar as a point of this intensity, W·sr⁻¹.
    pub fn of_intensity(center: Vec3, radius: f32, intensity: Vec3) -> Self {
        Self { center, radius, radiance: Radiance(intensity / disk_area(radius)) }
    }

    /// Intensity seen from afar, W·sr⁻¹.
    pub fn intensity(&self) -> Vec3 {
        self.radiance.0 * disk_area(self.radius)
    }

    /// Area, m².
    pub fn area(&self) -> f32 {
        4.0 * disk_area(self.radius)
    }
}

impl PointLight {
    /// Intensity over squared distance at distance `d`, with the smooth end at `range` that glTF recommends.
    pub fn normal_irradiance(&self, distance: f32) -> Vec3 {
        let window = (1.0 - (distance / self.range).powi(4)).clamp(0.0, 1.0);
        self.intensity * (window / (distance * distance))
    }
}

/// Differences of cosines below this are those of narrow spots or sharp edges: three digits are left of 24 bits.
const NARROW: f32 = 1e-4;

impl SpotLight {
    /// The narrowest cone, an angle from the axis in radians (0.2°): of less, cosines of 24 bits hold too few digits.
    pub const LEAST_OUTER: f32 = 3.49e-3;

    /// Share of the axial intensity towards `direction` (unit vector away from the light).
    pub fn falloff(&self, direction: Vec3) -> f32 {
        let span = self.cos_inner - self.cos_outer;
        let inside = if span < NARROW {
            // One minus the cosine, without the digits that a cosine near 1 loses.
            (1.0 - self.cos_outer) - 0.5 * (self.direction - direction).length_squared()
        } else {
            self.direction.dot(direction) - self.cos_outer
        };
        let share = (inside / span.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        share * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangle_area_is_that_of_its_corners() {
        let light = RectLight {
            center: Vec3::ONE,
            u: Vec3::X * 0.5,
            v: Vec3::Z * 2.0,
            radiance: Radiance::splat(1.0),
            texture: None,
        };
        let [a, b, c, _] = light.corners();
        assert_eq!(light.area(), (b - a).length() * (c - b).length());
        assert_eq!(light.normal(), Some(-Vec3::Y));
        assert_eq!(light.point([0.0, 0.0]), a);
        assert_eq!(light.point([1.0, 1.0]), c);
    }

    #[test]
    fn spot_fades_between_its_cones() {
        let point = PointLight { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let spot = SpotLight { point, direction: Vec3::Z, cos_inner: 0.9, cos_outer: 0.5 };
        assert_eq!(spot.falloff(Vec3::Z), 1.0);
        assert_eq!(spot.falloff(Vec3::X), 0.0);
        assert_eq!(point.normal_irradiance(2.0), Vec3::splat(0.25));
    }
}
