//! Textures as 8-bit images.

use crate::display::srgb_byte;
use lumel_scene::{Encoding, Texture};

/// The divisor that brings all stored texels into the range of an 8-bit image.
pub(crate) fn largest(texture: &Texture) -> f32 {
    if texture.bytes().is_some() { 1.0 } else { texture.max().max_element().max(1.0) }
}

/// The texels over the [`largest`] as sRGB, row by row from the top; sRGB bytes are kept.
pub(crate) fn srgb_pixels(texture: &Texture) -> Vec<[u8; 3]> {
    if let Some((rgba, Encoding::Srgb)) = texture.bytes() {
        return rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    }
    let (width, height) = texture.size();
    let scale = 1.0 / largest(texture);
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| texture.texel(x, y)));
    texels.map(|texel| (texel * scale).to_array().map(srgb_byte)).collect()
}

/// Alpha as grey, row by row from the top.
pub(crate) fn opacity_pixels(texture: &Texture) -> Vec<[u8; 3]> {
    let (width, height) = texture.size();
    let grey = |x, y| [(255.0 * texture.texel_alpha(x, y) + 0.5) as u8; 3];
    (0..height).flat_map(|y| (0..width).map(move |x| grey(x, y))).collect()
}

/// The texels as they are, clamped to 0..=1, row by row from the top: for what is no colour.
pub(crate) fn linear_pixels(texture: &Texture) -> Vec<[u8; 3]> {
    let (width, height) = texture.size();
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| texture.texel(x, y)));
    texels.map(|texel| texel.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8)).collect()
}
