//! Images of the sky.

use crate::image::{Budget, TextureError, decode_file, into_texture};
use image::DynamicImage;
use lumel_scene::{Encoding, Texture, Warnings};
use std::path::Path;

/// Reads an equirectangular image of the sky: HDR or EXR, whose numbers are radiance, or any other image.
///
/// Texels that are negative or not finite are black. A warning says how many there are, and if the image is not twice as wide
/// as high.
///
/// # Errors
/// See [`TextureError`].
pub fn load_sky(path: &Path, warnings: &mut Warnings) -> Result<Texture, TextureError> {
    let name = path.display().to_string();
    let image = decode_file(path, &mut Budget::default())?;
    let bad = bad_texels(&image);
    if bad > 0 {
        let texels = if bad == 1 { "1 texel" } else { &format!("{bad} texels") };
        let text = format!("{texels} of the sky negative or not finite; taken for black");
        warnings.push(&name, text);
    }
    let (width, height) = (image.width(), image.height());
    if u64::from(width) != 2 * u64::from(height) {
        let text = format!(
            "the image of the sky has {width} x {height} texels and is stretched over all directions; an \
             equirectangular image is twice as wide as high"
        );
        warnings.push(&name, text);
    }
    into_texture(image, &name, Encoding::Srgb)
}

/// Texels of which a channel is no light.
fn bad_texels(image: &DynamicImage) -> usize {
    let bad = |channels: &[f32]| channels.iter().any(|value| !(value.is_finite() && *value >= 0.0));
    match image {
        DynamicImage::ImageRgb32F(image) => image.pixels().filter(|texel| bad(&texel.0)).count(),
        DynamicImage::ImageRgba32F(image) => image.pixels().filter(|texel| bad(&texel.0[..3])).count(),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{folder, png};
    use glam::Vec3;
    use image::{ImageFormat, Rgb, Rgb32FImage};
    use std::io::Cursor;

    fn bytes(texels: &[[f32; 3]], width: u32, format: ImageFormat) -> Vec<u8> {
        let mut image = Rgb32FImage::new(width, texels.len() as u32 / width);
        image.pixels_mut().zip(texels).for_each(|(pixel, texel)| *pixel = Rgb(*texel));
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
        bytes
    }

    /// The texture, and the warnings without the folder.
    fn read(name: &str, bytes: &[u8]) -> (Result<Texture, String>, Vec<String>) {
        let folder = folder(&[(name, bytes)]);
        let mut warnings = Warnings::default();
        let texture = load_sky(&folder.path().join(name), &mut warnings);
        let short = |text: String| text.replace(&format!("{}/", folder.path().display()), "");
        (
            texture.map_err(|error| short(error.to_string())),
            warnings.iter().map(|warning| short(warning.to_string())).collect(),
        )
    }

    #[test]
    fn hdr_and_exr_hold_the_same_radiance_beyond_one() {
        let texels = [[0.25, 0.5, 1000.0], [0.0; 3]];
        for (name, format) in [("a.hdr", ImageFormat::Hdr), ("a.exr", ImageFormat::OpenExr)] {
            let (texture, warnings) = read(name, &bytes(&texels, 2, format));
            let texel = texture.unwrap().texel(0, 0);
            // HDR shares one exponent: what is far below the largest channel is lost.
            assert!((texel.z / 1000.0 - 1.0).abs() < 0.01, "{name}: {texel}");
            assert!(format == ImageFormat::Hdr || texel == Vec3::new(0.25, 0.5, 1000.0), "{name}: {texel}");
            assert!(warnings.is_empty(), "{warnings:?}");
        }
        assert!(read("a.png", &png([255, 0, 0, 255])).0.is_ok());
    }

    #[test]
    fn texels_that_are_no_light_are_black_and_counted() {
        let texels = [[f32::NAN, 1.0, 1.0], [f32::INFINITY, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0; 3]];
        let mut all = texels.to_vec();
        all.extend([[1.0; 3]; 4]);
        let (texture, warnings) = read("a.exr", &bytes(&all, 4, ImageFormat::OpenExr));
        let texture = texture.unwrap();
        assert_eq!([0, 1, 2, 3].map(|x| texture.texel(x, 0).x), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(
            warnings,
            [
                "a.exr: 3 texels of the sky negative or not finite; taken for black",
                "a.exr: the image of the sky has 4 x 2 texels and is stretched over all directions; an equirectangular \
             image is twice as wide as high"
            ][..1]
        );
        let (_, warnings) = read("a.exr", &bytes(&[[-0.1; 3], [1.0; 3]], 2, ImageFormat::OpenExr));
        assert_eq!(warnings, ["a.exr: 1 texel of the sky negative or not finite; taken for black"]);
    }

    #[test]
    fn an_image_of_another_shape_is_stretched_with_a_warning() {
        let (texture, warnings) = read("a.exr", &bytes(&[[1.0; 3]; 9], 3, ImageFormat::OpenExr));
        assert_eq!(texture.unwrap().size(), (3, 3));
        assert!(warnings[0].starts_with("a.exr: the image of the sky has 3 x 3 texels"), "{warnings:?}");
    }

    #[test]
    fn what_is_no_image_is_refused_by_name() {
        let good = bytes(&[[1.0; 3]; 32], 8, ImageFormat::OpenExr);
        for (name, content) in
            [("a.exr", &good[..good.len() / 2]), ("b.hdr", b"#?RADIANCE\n"), ("c.txt", b"sky")]
        {
            let error = read(name, content).0.unwrap_err();
            assert!(error.contains(name), "{error}");
        }
        let missing = load_sky(Path::new("no-such.hdr"), &mut Warnings::default()).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read image no-such.hdr"), "{missing}");
    }
}
