//! Diffuse materials.

use crate::{Gloss, NormalMap, Radiance, TextureId, Transparency};
use glam::{Vec2, Vec3};
use std::fmt;

/// The largest albedo per channel that a surface may have.
///
/// A closed room of albedo 1 has no solution; at 0.98 the Neumann series still converges in a few hundred bounces
/// and no real paint is whiter (fresh barium sulphate reaches about that).
pub const MAX_ALBEDO: f32 = 0.98;

/// An affine map of texture coordinates: `uv' = offset + rotation(scale * uv)`, as KHR_texture_transform has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// Added last.
    pub offset: Vec2,
    /// Counter-clockwise in the glTF convention, radians.
    pub rotation: f32,
    /// Applied first.
    pub scale: Vec2,
}

impl Default for UvTransform {
    fn default() -> Self {
        Self { offset: Vec2::ZERO, rotation: 0.0, scale: Vec2::ONE }
    }
}

impl UvTransform {
    /// The transformed coordinate.
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        if self.rotation == 0.0 {
            return self.offset + uv * self.scale;
        }
        let (sin, cos) = self.rotation.sin_cos();
        let Vec2 { x, y } = uv * self.scale;
        self.offset + Vec2::new(cos * x + sin * y, cos * y - sin * x)
    }
}

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Which texture.
    pub texture: TextureId,
    /// How the mesh's coordinates map to it.
    pub transform: UvTransform,
}

impl TextureRef {
    /// A texture used with the mesh's coordinates as they are.
    pub fn plain(texture: TextureId) -> Self {
        Self { texture, transform: UvTransform::default() }
    }
}

/// Which sides of a surface reflect and emit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Only the side from which the corners run counter-clockwise; the other is black.
    #[default]
    Front,
    /// Both, each with its own light.
    Both,
    /// As the shape tells: the front of what emits and of shells with an inside, such as boxes and rooms, even if they lack a
    /// side; both sides of everything else, such as sheets and pieces whose faces face different ways.
    ///
    /// For files that do not say it. Programs that show them light both sides, but of a solid only one can be seen.
    Shape,
}

/// A colour without what is no number or negative.
pub(crate) fn sound(color: Vec3) -> Vec3 {
    if color.is_finite() { color.max(Vec3::ZERO) } else { Vec3::ZERO }
}

/// A diffuse material.
#[derive(Clone, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// Albedo, 0..=1; multiplies the texture when there is one.
    pub albedo: Vec3,
    /// Albedo over the surface.
    pub albedo_texture: Option<TextureRef>,
    /// Emitted radiance, W·m⁻²·sr⁻¹; multiplies the texture when there is one.
    pub emission: Radiance,
    /// Emission over the surface, relative to `emission`.
    pub emission_texture: Option<TextureRef>,
    /// How normals are tilted over the surface.
    pub normal_texture: Option<NormalMap>,
    /// Which sides it has.
    pub sides: Sides,
    /// How light passes through it.
    pub transparency: Transparency,
    /// How it reflects beside diffusely, for files that are written.
    pub gloss: Gloss,
}

impl fmt::Debug for Material {
    /// All that light depends on: the hashes of scenes are made of this.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Material")
            .field("name", &self.name)
            .field("albedo", &self.albedo)
            .field("albedo_texture", &self.albedo_texture)
            .field("emission", &self.emission)
            .field("emission_texture", &self.emission_texture)
            .field("normal_texture", &self.normal_texture)
            .field("sides", &self.sides)
            .field("transparency", &self.transparency)
            .finish()
    }
}

impl Material {
    /// A one-sided material of constant albedo.
    pub fn diffuse(name: &str, albedo: impl Into<Vec3>) -> Self {
        Self {
            name: name.to_owned(),
            albedo: albedo.into(),
            albedo_texture: None,
            emission: Radiance::ZERO,
            emission_texture: None,
            normal_texture: None,
            sides: Sides::Front,
            transparency: Transparency::default(),
            gloss: Gloss::default(),
        }
    }

    /// Whether it emits light anywhere.
    pub fn emits(&self) -> bool {
        !self.emission.is_zero()
    }
}

impl Default for Material {
    /// Half-grey: what a mesh without materials gets.
    fn default() -> Self {
        Self::diffuse("default", Vec3::splat(0.5))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn uv_transform_scales_rotates_then_moves() {
        let transform =
            UvTransform { offset: Vec2::new(0.5, 0.0), rotation: FRAC_PI_2, scale: Vec2::new(2.0, 3.0) };
        // KHR_texture_transform: rotation turns +u towards -v (v points down), i.e. (x, y) -> (y, -x) for 90 degrees.
        let uv = transform.apply(Vec2::new(1.0, 1.0));
        assert!((uv - Vec2::new(3.5, -2.0)).length() < 1e-6, "{uv}");
    }
}
