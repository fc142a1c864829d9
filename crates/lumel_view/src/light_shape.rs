//! Lights that are no rectangles, edited as the rectangle of their place, direction, size and strength.

use glam::Vec3;
use lumel::{
    DirectionalLight, DiskLight, Light, LightKind, PointLight, RectLight, SphereLight, SpotLight, SunLight,
};
use lumel_scene::Radiance;

/// Half-edge of the rectangle of a light without size, metres.
const HANDLE: f32 = 0.1;
/// Sine of half the angular diameter of a new sun, 0.53°.
const SUN: f32 = 0.004_625;
/// Cosines of the cones of a new spot: 20° and 30°.
const CONES: [f32; 2] = [0.939_692_6, 0.866_025_4];

/// The rectangle that stands for a light: its centre, its direction, its radius as half-edges, and its radiance, intensity or
/// irradiance.
pub(crate) fn frame_of(light: &Light) -> RectLight {
    let (center, direction, half, strength) = match *light {
        Light::Rect(rect) => return rect,
        Light::Disk(disk) => (disk.center, disk.direction, disk.radius, disk.radiance.0),
        Light::Sphere(sphere) => (sphere.center, -Vec3::Y, sphere.radius, sphere.intensity()),
        Light::Point(point) => (point.position, -Vec3::Y, HANDLE, point.intensity),
        Light::Spot(spot) => (spot.point.position, spot.direction, HANDLE, spot.point.intensity),
        Light::Directional(sun) => (Vec3::ZERO, sun.direction, HANDLE, sun.irradiance),
        Light::Sun(sun) => (Vec3::ZERO, sun.parallel.direction, HANDLE, sun.parallel.irradiance),
    };
    let (u, v) = direction.any_orthonormal_pair();
    let radiance = Radiance(strength);
    RectLight { center, u: u * half, v: v * half, radiance, texture: None }
}

/// A light moved, turned, resized and brightened to the rectangle that stands for it. What has not changed keeps its bits.
pub(crate) fn with_frame(light: &Light, frame: &RectLight) -> Light {
    let old = frame_of(light);
    let (center, strength) = (frame.center, frame.radiance.0);
    let turned = (old.u, old.v) != (frame.u, frame.v);
    let direction = |before: Vec3| if turned { frame.normal().unwrap_or(before) } else { before };
    let radius = |before: f32| if turned { frame.u.length() } else { before };
    match *light {
        Light::Rect(_) => Light::Rect(*frame),
        Light::Disk(disk) => Light::Disk(DiskLight {
            center,
            direction: direction(disk.direction),
            radius: radius(disk.radius),
            radiance: frame.radiance,
        }),
        Light::Sphere(sphere) if !turned && strength == old.radiance.0 => {
            Light::Sphere(SphereLight { center, ..sphere })
        }
        Light::Sphere(sphere) => {
            Light::Sphere(SphereLight::of_intensity(center, radius(sphere.radius), strength))
        }
        Light::Point(point) => Light::Point(PointLight { position: center, intensity: strength, ..point }),
        Light::Spot(spot) => Light::Spot(SpotLight {
            point: PointLight { position: center, intensity: strength, ..spot.point },
            direction: direction(spot.direction),
            ..spot
        }),
        Light::Directional(sun) => {
            Light::Directional(DirectionalLight { direction: direction(sun.direction), irradiance: strength })
        }
        Light::Sun(sun) => {
            let direction = direction(sun.parallel.direction);
            Light::Sun(SunLight { parallel: DirectionalLight { direction, irradiance: strength }, ..sun })
        }
    }
}

/// A light of another kind in the place, direction and size of a rectangle, with the numbers of its radiance.
pub(crate) fn of_kind(kind: LightKind, frame: &RectLight) -> Light {
    let direction = frame.normal().unwrap_or(-Vec3::Y);
    let point = PointLight { position: frame.center, intensity: frame.radiance.0, range: f32::INFINITY };
    match kind {
        LightKind::Rect => Light::Rect(*frame),
        LightKind::Disk => Light::Disk(DiskLight {
            center: frame.center,
            direction,
            radius: frame.u.length(),
            radiance: frame.radiance,
        }),
        LightKind::Point => Light::Point(point),
        LightKind::Spot => {
            let [cos_inner, cos_outer] = CONES;
            Light::Spot(SpotLight { point, direction, cos_inner, cos_outer })
        }
        LightKind::Sun => {
            let parallel = DirectionalLight { direction, irradiance: frame.radiance.0 };
            Light::Sun(SunLight { parallel, sin_half_angle: SUN })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> RectLight {
        RectLight::new([1.0, 2.0, 3.0], [0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [8.0, 4.0, 2.0])
    }

    fn all() -> Vec<Light> {
        let sphere = SphereLight::of_intensity(Vec3::ONE, 0.3, Vec3::splat(0.7));
        let sun = DirectionalLight { direction: Vec3::new(0.6, -0.8, 0.0), irradiance: Vec3::ONE };
        let kinds = LightKind::ALL.into_iter().map(|kind| of_kind(kind, &frame()));
        kinds.chain([Light::Sphere(sphere), Light::Directional(sun)]).collect()
    }

    #[test]
    fn a_light_that_is_not_edited_keeps_its_bits() {
        for light in all() {
            assert_eq!(with_frame(&light, &frame_of(&light)), light);
        }
    }

    #[test]
    fn every_light_follows_its_rectangle() {
        for light in all() {
            let mut frame = frame_of(&light);
            frame.center += Vec3::X;
            (frame.u, frame.v) = (Vec3::Z * 0.5, Vec3::X * 0.5);
            frame.radiance = Radiance::splat(3.0);
            let moved = with_frame(&light, &frame);
            assert!((moved.strength().x > 0.0) && moved.problem().is_none(), "{moved:?}");
            assert!(light.position().is_none_or(|p| moved.position() == Some(p + Vec3::X)), "{moved:?}");
            let again = frame_of(&moved);
            assert!((again.radiance.0 - Vec3::splat(3.0)).length() < 1e-5, "{moved:?}");
            let is_round = matches!(light, Light::Point(_) | Light::Sphere(_));
            assert!(is_round || again.normal().is_some_and(|n| n.dot(Vec3::Y) > 0.999), "{moved:?}");
            let has_radius = matches!(light, Light::Disk(_) | Light::Sphere(_));
            assert!(!has_radius || (again.u.length() - 0.5).abs() < 1e-6, "{moved:?}");
        }
    }
}
