//! Scenes that stand far from the origin of their world.

use crate::{Camera, Light, Scene, SceneBuilder};
use glam::{DVec3, Vec3};

/// A scene is far from the origin of its world if its centre is as many diagonals away from it.
///
/// Up to there, coordinates in single precision resolve at least a millionth of the diagonal.
const FAR: f64 = 4.0;

/// The same for positions that were given in single precision, which gain no digits: whoever gave them would rather have them
/// back. Up to there, they resolve a hundred-thousandth of the diagonal.
const FAR_IF_ROUNDED: f64 = 64.0;

/// The origin for a scene with vertices at these points in world space, metres: zero, unless they are far from there.
///
/// Far is more than four times the diagonal of their bounds. The origin is then near their centre, at multiples of a
/// power of two that is at least the diagonal: differences to it are exact in single precision. Points that are not
/// finite do not count.
pub fn origin_for(points: impl IntoIterator<Item = DVec3>) -> DVec3 {
    origin_beyond(FAR, points)
}

fn origin_beyond(diagonals: f64, points: impl IntoIterator<Item = DVec3>) -> DVec3 {
    let finite = points.into_iter().filter(|p| p.is_finite());
    let (min, max) = finite.fold((DVec3::MAX, DVec3::MIN), |(min, max), p| (min.min(p), max.max(p)));
    let (center, diagonal) = (0.5 * min + 0.5 * max, (max - min).length());
    if min.x > max.x || center.length() <= diagonals * diagonal {
        return DVec3::ZERO;
    }
    // Of what single precision has made a point, the place is known as well as that.
    let grid = diagonal.max(rounding_of(center.length() as f32)).log2().ceil().exp2();
    let origin = (center / grid).round() * grid;
    if origin.is_finite() { origin } else { DVec3::ZERO }
}

impl SceneBuilder {
    /// Gives a scene that is very far from its [origin](Self::origin), by 64 times its diagonal, one that is near as
    /// [`origin_for`] does.
    ///
    /// All positions are then relative to that. [`SceneBuilder::tessellate`] and [`SceneBuilder::build`] do it first.
    pub fn recenter(&mut self) {
        let positions = self.objects.iter().flat_map(|object| object.positions.iter().copied());
        // Lights count: what they shine on may be measured at points that are near them alone.
        let lights = self.lights.iter().filter_map(Light::position);
        let shift = origin_beyond(FAR_IF_ROUNDED, positions.chain(lights).map(|p| p.as_dvec3()));
        if shift == DVec3::ZERO {
            return;
        }
        for object in &mut self.objects {
            let finite = object.positions.iter().filter(|p| p.is_finite());
            let largest = finite.map(|p| p.abs().max_element()).fold(0.0, f32::max);
            object.rounding = object.rounding.max(rounding_of(largest));
            object.positions.iter_mut().for_each(|p| *p = moved(*p, -shift));
        }
        self.lights.iter_mut().for_each(|light| *light = light.moved(-shift));
        self.cameras.iter_mut().for_each(|camera| *camera = camera.moved(-shift));
        self.origin += shift;
    }

    /// A point in world space in the coordinates of the scene.
    pub fn to_local(&self, world: DVec3) -> Vec3 {
        (world - self.origin).as_vec3()
    }
}

impl Scene {
    /// A point in world space in the coordinates of the scene: see [`Scene::origin`].
    pub fn to_local(&self, world: DVec3) -> Vec3 {
        (world - self.origin()).as_vec3()
    }

    /// A point of the scene in world space: see [`Scene::origin`].
    pub fn to_world(&self, local: Vec3) -> DVec3 {
        // Adding zero would turn -0 into 0, and other bytes into files.
        if self.origin() == DVec3::ZERO { local.as_dvec3() } else { local.as_dvec3() + self.origin() }
    }
}

impl Light {
    /// The light elsewhere.
    #[must_use]
    pub fn moved(mut self, by: DVec3) -> Self {
        if let Some(position) = self.position_mut() {
            *position = moved(*position, by);
        }
        self
    }
}

impl Camera {
    /// The camera elsewhere.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        Self { position: moved(self.position, by), ..self.clone() }
    }
}

fn moved(p: Vec3, by: DVec3) -> Vec3 {
    (p.as_dvec3() + by).as_vec3()
}

/// By how much a coordinate of this size is rounded in single precision, at most.
pub fn rounding_of(coordinate: f32) -> f64 {
    0.5 * f64::from(f32::EPSILON) * f64::from(coordinate.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::quad;
    use crate::{Material, RectLight};

    fn origin_of_unit_cube_at(shift: DVec3) -> DVec3 {
        origin_for([shift - 0.5, shift + 0.5, DVec3::NAN])
    }

    #[test]
    fn scenes_near_their_origin_keep_it() {
        assert_eq!(origin_for([]), DVec3::ZERO);
        assert!((origin_for([DVec3::splat(1e9)]) - 1e9).length() < 1e3, "nor may it do with a point");
        assert_eq!(origin_of_unit_cube_at(DVec3::splat(3.9)), DVec3::ZERO);
        assert_eq!(origin_of_unit_cube_at(DVec3::X * 6.9), DVec3::ZERO);
        assert_eq!(origin_for([DVec3::MIN, DVec3::MAX]), DVec3::ZERO);
    }

    #[test]
    fn the_origin_of_far_scenes_is_near_and_differences_to_it_are_exact() {
        for shift in [DVec3::X * 7.1, DVec3::new(1e3, -1e4, 7.3), DVec3::splat(1e6 + 0.125)] {
            for scale in [1e-3, 1.0, 1e4] {
                let origin = origin_for([shift * scale - 0.5 * scale, shift * scale + 0.5 * scale]);
                assert!((origin - shift * scale).abs().max_element() <= 2.0 * scale, "{origin}");
                let given = (shift * scale + 0.3 * scale).as_vec3();
                let local = (given.as_dvec3() - origin).as_vec3();
                assert_eq!(local.as_dvec3() + origin, given.as_dvec3(), "{shift} {scale}");
            }
        }
    }

    #[test]
    fn all_of_a_scene_is_moved_and_nothing_in_the_world() {
        let mut far = quad("far");
        far.positions.iter_mut().for_each(|p| *p += 1024.0);
        let lamp = RectLight::new([1024.5, 1024.5, 1026.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [1.0; 3]);
        let camera = Camera::looking_at("c", Vec3::splat(1025.0), Vec3::splat(1024.0), 1.0);
        let mut builder = SceneBuilder {
            objects: vec![far.clone()],
            materials: vec![Material::default()],
            lights: vec![lamp.into()],
            cameras: vec![camera.clone()],
            ..SceneBuilder::default()
        };
        builder.recenter();
        let again = builder.origin;
        builder.recenter();
        assert_eq!((again, builder.origin), (DVec3::splat(1024.0), again));
        let (scene, _) = builder.build().unwrap();
        assert_eq!(scene.origin(), again);
        assert_eq!(scene.positions(), quad("near").positions);
        for (&local, given) in scene.positions().iter().zip(&far.positions) {
            assert_eq!(scene.to_world(local), given.as_dvec3());
            assert_eq!(scene.to_local(given.as_dvec3()), local);
        }
        let Light::Rect(moved) = scene.lights()[0] else { panic!("another light") };
        assert_eq!((moved.center, moved.u), (Vec3::new(0.5, 0.5, 2.0), lamp.u));
        assert_eq!(scene.cameras()[0], Camera { position: Vec3::ONE, ..camera });
    }
}
