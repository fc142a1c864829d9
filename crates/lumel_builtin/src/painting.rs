//! Textures painted by functions.

use glam::{Vec2, Vec3};
use lumel_scene::{Encoding, Texture};

/// A texture of bytes whose texels show `paint` at their centres; `v` points down.
///
/// Colours are given as they are stored: sRGB values for [`Encoding::Srgb`], 0..=1. `None` for a size of zero.
pub(crate) fn texture(
    name: &str,
    [width, height]: [u32; 2],
    encoding: Encoding,
    paint: impl Fn(Vec2) -> Vec3,
) -> Option<Texture> {
    let size = Vec2::new(width as f32, height as f32);
    let texel = |x: u32, y: u32| {
        let colour = paint(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size);
        let [r, g, b] = colour.to_array().map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
        [r, g, b, 255]
    };
    let rgba = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
    Texture::from_bytes(name, width, height, rgba, encoding)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_show_the_paint_at_their_centres() {
        let texture = texture("t", [4, 2], Encoding::Linear, |uv| Vec3::new(uv.x, uv.y, 2.0)).unwrap();
        assert_eq!(texture.bytes().unwrap().0[6], [159, 191, 255, 255]);
    }
}
