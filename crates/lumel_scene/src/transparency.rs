//! How light passes through surfaces.

use crate::{Material, Texture, TextureRef};
use glam::Vec3;

/// What the alpha of a material means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing: the surface is there everywhere.
    #[default]
    Opaque,
    /// The surface is there where alpha is at least `cutoff`, and has holes elsewhere.
    Mask {
        /// The least alpha of the surface.
        cutoff: f32,
    },
    /// The share of the surface that is there.
    Blend,
}

/// How light passes through a surface: through what is not there, and, tinted, through what is.
///
/// Surfaces are thin: nothing is refracted. The default lets nothing through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transparency {
    /// What alpha means.
    pub mode: AlphaMode,
    /// Alpha, 0..=1; multiplies that of the texture and of the vertices where there are any.
    pub alpha: f32,
    /// Alpha over the surface: the fourth channel.
    pub texture: Option<TextureRef>,
    /// The share of light that passes through what is there, 0..=1; multiplies the albedo texture and the tints of the
    /// vertices. That light is not reflected: the albedo is what remains.
    pub transmission: Vec3,
}

impl Default for Transparency {
    fn default() -> Self {
        Self { mode: AlphaMode::Opaque, alpha: 1.0, texture: None, transmission: Vec3::ZERO }
    }
}

impl Transparency {
    /// A surface of which the share `alpha` is there.
    pub fn blend(alpha: f32) -> Self {
        Self { mode: AlphaMode::Blend, alpha, ..Self::default() }
    }

    /// Whether light can pass, depending on alpha.
    pub(crate) fn is_possible(&self) -> bool {
        self.mode != AlphaMode::Opaque || self.transmission != Vec3::ZERO
    }

    /// The share of the surface that is there, for an alpha of texture and vertices.
    #[inline]
    pub(crate) fn coverage(&self, alpha: f32) -> f32 {
        match self.mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask { cutoff } => f32::from(self.alpha * alpha >= cutoff),
            AlphaMode::Blend => (self.alpha * alpha).clamp(0.0, 1.0),
        }
    }
}

/// The mean of the channels.
#[inline]
pub(crate) fn mean(color: Vec3) -> f32 {
    (color.x + color.y + color.z) / 3.0
}

/// What a triangle is to rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// It is nowhere there.
    Absent,
    /// It lets nothing through anywhere.
    Opaque,
    /// Neither.
    Transparent,
}

/// Tells which triangles of a scene are transparent.
pub(crate) struct Looks(Vec<(Transparency, [f32; 2])>);

impl Looks {
    pub(crate) fn new(materials: &[Material], textures: &[Texture]) -> Self {
        let range = |material: &Material| {
            let transparency = material.transparency;
            let texture = transparency.texture.filter(|_| transparency.mode != AlphaMode::Opaque);
            let range = texture.map_or([1.0; 2], |t| textures[t.texture.index()].alpha_range());
            (transparency, range)
        };
        Self(materials.iter().map(range).collect())
    }

    /// Whether any triangle may be transparent or absent.
    pub(crate) fn vary(&self) -> bool {
        self.0.iter().any(|(transparency, _)| transparency.is_possible())
    }

    /// The look of a triangle with these alphas at its corners.
    pub(crate) fn of(&self, material: usize, corners: [f32; 3]) -> Look {
        let (transparency, [low, high]) = &self.0[material];
        let coverage = |alpha: f32| transparency.coverage(alpha);
        let [a, b, c] = corners;
        if coverage(high * a.max(b).max(c)) <= 0.0 {
            Look::Absent
        } else if coverage(low * a.min(b).min(c)) >= 1.0 && transparency.transmission == Vec3::ZERO {
            Look::Opaque
        } else {
            Look::Transparent
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Encoding, TextureId};

    fn look(transparency: Transparency, texels: &[u8], corners: [f32; 3]) -> Look {
        let rgba = texels.iter().map(|&alpha| [255, 255, 255, alpha]).collect();
        let texture = Texture::from_bytes("t", texels.len() as u32, 1, rgba, Encoding::Srgb).unwrap();
        let texture_ref = Some(TextureRef::plain(TextureId(0)));
        let transparency = Transparency { texture: texture_ref, ..transparency };
        Looks::new(&[Material { transparency, ..Material::default() }], &[texture]).of(0, corners)
    }

    #[test]
    fn triangles_are_transparent_only_where_alpha_can_be_between() {
        let mask = Transparency { mode: AlphaMode::Mask { cutoff: 0.5 }, ..Transparency::default() };
        let half = Transparency { alpha: 0.5, ..mask };
        let none = Transparency::blend(0.0);
        let glass = Transparency { transmission: Vec3::X, ..Transparency::default() };
        let cases = [
            (Transparency::default(), [0, 0], [0.0; 3], Look::Opaque),
            (Transparency::blend(1.0), [255, 255], [1.0; 3], Look::Opaque),
            (Transparency::blend(1.0), [255, 254], [1.0; 3], Look::Transparent),
            (Transparency::blend(1.0), [255, 255], [1.0, 0.5, 1.0], Look::Transparent),
            (Transparency::blend(1.0), [255, 255], [0.0; 3], Look::Absent),
            (Transparency::blend(1.0), [0, 0], [1.0; 3], Look::Absent),
            (none, [255, 255], [1.0; 3], Look::Absent),
            (mask, [128, 255], [1.0; 3], Look::Opaque),
            (mask, [127, 255], [1.0; 3], Look::Transparent),
            (mask, [127, 100], [1.0; 3], Look::Absent),
            (half, [255, 255], [1.0; 3], Look::Opaque),
            (half, [255, 255], [0.9, 0.9, 0.9], Look::Absent),
            (glass, [0, 0], [0.0; 3], Look::Transparent),
        ];
        for (transparency, texels, corners, expected) in cases {
            assert_eq!(
                look(transparency, &texels, corners),
                expected,
                "{transparency:?} {texels:?} {corners:?}"
            );
        }
    }
}
