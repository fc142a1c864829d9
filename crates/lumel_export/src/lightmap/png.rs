//! Pages as PNG images of linear light.

use super::{Curve, check, dithered_over, largest, lumels_of};
use crate::{ExportError, write_atomically};
use ::png::{BitDepth, ColorType, Encoder};
use lumel_lightmap::Lightmap;
use std::io::{self, Write};
use std::path::Path;

/// Digits of the channels of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PngDepth {
    /// Bytes, dithered: their mean over a few lumels is exact.
    Eight,
    /// Words, rounded.
    Sixteen,
}

/// Writes a page of a lightmap as a PNG image, atomically. Returns the scale: the largest byte or word stands for this
/// irradiance.
///
/// The scale is the smallest power of two that holds all light of the page; a text of the file, `irradiance of 65535` or
/// `irradiance of 255`, has it. Values are linear, words to half a step: 2⁻¹⁷ of the scale. Only the first layer is written.
///
/// # Errors
/// A page that there is not, light that is not finite, and the errors of [`write_atomically`].
pub fn write_lightmap_png(
    path: &Path,
    lightmap: &Lightmap,
    page: usize,
    depth: PngDepth,
) -> Result<f32, ExportError> {
    let lumels = lumels_of(path, lightmap, page)?;
    check(path, lightmap)?;
    let values = &lightmap.layers[0].values[lumels];
    let scale = power_above(largest(values));
    let size = lightmap.atlas.pages()[page];
    let word = |x: f32| (x.max(0.0) / scale * 65535.0).round() as u16;
    let (keyword, depth, bytes) = match depth {
        PngDepth::Eight => {
            ("irradiance of 255", BitDepth::Eight, dithered_over(scale, values, size[0], Curve::Linear))
        }
        PngDepth::Sixteen => {
            let channels = values.iter().flat_map(|value| value.to_array());
            let bytes = channels.flat_map(|x| word(x).to_be_bytes()).collect();
            ("irradiance of 65535", BitDepth::Sixteen, bytes)
        }
    };
    write_atomically(path, |out| encode_rgb(out, size, depth, &bytes, &[(keyword, &*scale.to_string())]))?;
    Ok(scale)
}

/// The smallest power of two that is not less; 1 for 0.
fn power_above(value: f32) -> f32 {
    if value <= 0.0 {
        return 1.0;
    }
    let power = value.log2().ceil().exp2();
    // Logarithms round. Beyond 2¹²⁷ there is no larger power.
    let power = if power < value { 2.0 * power } else { power };
    power.min(f32::from_bits(0x7f00_0000))
}

/// Encodes three channels. What is to be shown by a browser has no chunk about colour: it would be converted.
pub(crate) fn encode_rgb(
    out: impl Write,
    [width, height]: [u32; 2],
    depth: BitDepth,
    bytes: &[u8],
    texts: &[(&str, &str)],
) -> io::Result<()> {
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(depth);
    for (keyword, text) in texts {
        encoder.add_text_chunk((*keyword).to_owned(), (*text).to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_hold_what_they_are_for() {
        for (value, power) in [(0.0, 1.0), (1.0, 1.0), (1.0001, 2.0), (0.3, 0.5), (4096.0, 4096.0)] {
            assert_eq!(power_above(value), power);
        }
        assert!(power_above(f32::MAX).is_finite());
    }
}
