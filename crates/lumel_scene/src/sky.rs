//! Light from outside the scene.

use crate::{Radiance, Texture};
use glam::{DVec3, Vec3};
use lumel_sample::Equirectangular;
use std::sync::Arc;

/// Light that arrives from outside the scene. Up is +Y.
#[derive(Clone, Debug)]
pub enum Sky {
    /// The same from all directions.
    Uniform(Radiance),
    /// Changing with the height above the horizon.
    Gradient(SkyGradient),
    /// An image of all directions.
    Image(Arc<SkyImage>),
}

/// Radiance that changes linearly with the sine of the elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyGradient {
    /// From straight above.
    pub zenith: Radiance,
    /// From the horizon.
    pub horizon: Radiance,
    /// From straight below.
    pub ground: Radiance,
}

/// An equirectangular image, each texel of which is a patch of constant radiance.
///
/// The middle of the image is the direction −Z, its right half +X, its top +Y. Texels are not interpolated, so that a sun
/// of one texel keeps its power.
#[derive(Clone, Debug)]
pub struct SkyImage {
    rotation: f32,
    strength: f32,
    map: Equirectangular,
    mean: Vec3,
    texture: Arc<Texture>,
}

/// Texels are looked at last, and those that are shared not at all.
impl PartialEq for SkyImage {
    fn eq(&self, other: &Self) -> bool {
        let placed = |sky: &Self| (sky.rotation, sky.strength, sky.map, sky.mean);
        placed(self) == placed(other) && (self.has_texels_of(other) || self.texture == other.texture)
    }
}

/// Images that are shared are not looked at.
impl PartialEq for Sky {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Uniform(a), Self::Uniform(b)) => a == b,
            (Self::Gradient(a), Self::Gradient(b)) => a == b,
            (Self::Image(a), Self::Image(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

impl Default for Sky {
    fn default() -> Self {
        Self::Uniform(Radiance::ZERO)
    }
}

impl From<Radiance> for Sky {
    fn from(radiance: Radiance) -> Self {
        Self::Uniform(radiance)
    }
}

impl From<SkyGradient> for Sky {
    fn from(gradient: SkyGradient) -> Self {
        Self::Gradient(gradient)
    }
}

impl From<SkyImage> for Sky {
    fn from(image: SkyImage) -> Self {
        Self::Image(Arc::new(image))
    }
}

impl Sky {
    /// Radiance from a direction, unit length.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Radiance {
        match self {
            Self::Uniform(radiance) => *radiance,
            Self::Gradient(gradient) => gradient.radiance(direction),
            Self::Image(image) => image.radiance(direction),
        }
    }

    /// The radiance, if it is the same from all directions.
    pub fn uniform(&self) -> Option<Radiance> {
        if let Self::Uniform(radiance) = self { Some(*radiance) } else { None }
    }

    /// The image, if it is one.
    pub fn image(&self) -> Option<&Arc<SkyImage>> {
        if let Self::Image(image) = self { Some(image) } else { None }
    }

    /// The mean over all directions.
    pub fn mean(&self) -> Radiance {
        match self {
            Self::Uniform(radiance) => *radiance,
            Self::Gradient(SkyGradient { zenith, horizon, ground }) => {
                Radiance(0.5 * horizon.0 + 0.25 * (zenith.0 + ground.0))
            }
            Self::Image(image) => Radiance(image.mean * image.strength),
        }
    }

    /// Whether it is black.
    pub fn is_zero(&self) -> bool {
        self.mean().is_zero()
    }

    /// Whether every radiance is finite and not negative.
    pub(crate) fn is_sound(&self) -> bool {
        let sound = |radiance: Vec3| radiance.is_finite() && radiance.min_element() >= 0.0;
        match self {
            Self::Uniform(radiance) => sound(radiance.0),
            Self::Gradient(SkyGradient { zenith, horizon, ground }) => {
                [zenith, horizon, ground].iter().all(|radiance| sound(radiance.0))
            }
            Self::Image(image) => {
                let brightest = image.texture.max() * image.strength;
                image.rotation.is_finite() && sound(brightest) && sound(image.mean)
            }
        }
    }
}

impl SkyGradient {
    #[inline]
    fn radiance(&self, direction: Vec3) -> Radiance {
        let end = if direction.y > 0.0 { self.zenith } else { self.ground };
        Radiance(self.horizon.0.lerp(end.0, direction.y.abs().min(1.0)))
    }
}

impl SkyImage {
    /// The sky of an image that is multiplied by `strength` and turned counter-clockwise about +Y by `rotation`, radians.
    pub fn new(texture: Texture, rotation: f32, strength: f32) -> Self {
        let (width, height) = texture.size();
        let map = Equirectangular::new([width, height], rotation);
        let (mut sum, mut sphere) = (DVec3::ZERO, 0.0);
        for row in 0..height {
            let texels = (0..width).map(|column| texture.texel(column, row).as_dvec3());
            sum += texels.sum::<DVec3>() * map.solid_angle(row);
            sphere += map.solid_angle(row) * f64::from(width);
        }
        Self { rotation, strength, map, mean: (sum / sphere).as_vec3(), texture: Arc::new(texture) }
    }

    /// The same image turned by `rotation`, radians, and multiplied by `strength` in place of what it is now.
    #[must_use]
    pub fn with(&self, rotation: f32, strength: f32) -> Self {
        let (width, height) = self.texture.size();
        let map = Equirectangular::new([width, height], rotation);
        Self { rotation, strength, map, mean: self.mean, texture: Arc::clone(&self.texture) }
    }

    /// Whether it shares the texels of another one, made by [`Self::with`].
    pub fn has_texels_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.texture, &other.texture)
    }

    /// The image, without its strength.
    pub fn texture(&self) -> &Texture {
        &self.texture
    }

    /// How far it is turned about +Y, radians.
    pub fn rotation(&self) -> f32 {
        self.rotation
    }

    /// What multiplies it.
    pub fn strength(&self) -> f32 {
        self.strength
    }

    /// Where its texels lie.
    pub fn map(&self) -> &Equirectangular {
        &self.map
    }

    /// Radiance of a texel.
    #[inline]
    pub fn texel(&self, [column, row]: [u32; 2]) -> Radiance {
        Radiance(self.texture.texel(column, row) * self.strength)
    }

    #[inline]
    fn radiance(&self, direction: Vec3) -> Radiance {
        self.texel(self.map.texel(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_pass_through_their_three_colours() {
        let gradient = SkyGradient {
            zenith: Radiance::splat(3.0),
            horizon: Radiance::splat(1.0),
            ground: Radiance::splat(0.5),
        };
        let sky = Sky::from(gradient);
        let at = |y: f32| sky.radiance(Vec3::new((1.0 - y * y).sqrt(), y, 0.0)).0.x;
        assert_eq!([at(1.0), at(0.5), at(0.0), at(-0.5), at(-1.0)], [3.0, 2.0, 1.0, 0.75, 0.5]);
        // The mean of a linear function of y over each half.
        assert_eq!(sky.mean(), Radiance::splat(0.5 * 2.0 + 0.5 * 0.75));
    }

    #[test]
    fn images_are_turned_and_multiplied() {
        let mut texels = vec![[0.0; 3]; 8 * 4];
        texels[8 + 4] = [2.0, 1.0, 0.0];
        let sky = |rotation: f32| {
            let texture = Texture::from_floats("sky", 8, 4, texels.clone()).expect("it has texels");
            Sky::from(SkyImage::new(texture, rotation, 3.0))
        };
        let ahead = Vec3::new(0.3, 0.4, -0.9);
        assert_eq!(sky(0.0).radiance(ahead), Radiance(Vec3::new(6.0, 3.0, 0.0)));
        let quarter = std::f32::consts::FRAC_PI_2;
        assert!(sky(quarter).radiance(ahead).is_zero());
        assert!(!sky(quarter).radiance(Vec3::new(-0.9, 0.4, -0.3)).is_zero(), "-z turned to -x");
        let image = sky(0.0);
        let map = *image.image().expect("it is one").map();
        let share = map.solid_angle(1) / (0..4).map(|row| 8.0 * map.solid_angle(row)).sum::<f64>();
        assert!((f64::from(image.mean().0.x) / (6.0 * share) - 1.0).abs() < 1e-6);
        let turned = image.image().expect("it is one").with(quarter, 3.0);
        assert!(turned.has_texels_of(image.image().expect("it is one")));
        assert_eq!(Sky::from(turned), sky(quarter));
    }
}
