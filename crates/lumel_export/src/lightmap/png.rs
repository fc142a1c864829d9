//! Pages as PNG images of linear light.

use super::{check, largest, lumels_of};
use crate::{ExportError, write_atomically};
use ::png::{BitDepth, ColorType, Encoder};
use glam::Vec3;
use lumel_lightmap::Lightmap;
use std::io::{self, Write};
use std::path::Path;

/// Writes a page of a lightmap as a PNG image of 16 bits, atomically. Returns the scale: 65535 stands for this irradiance.
///
/// The scale is the smallest power of two that holds all light of the page; a text of the file, `irradiance of 65535`, has it.
/// Values are linear, to half a step: 2⁻¹⁷ of the scale. Only the first layer is written.
///
/// # Errors
/// A page that there is not, light that is not finite, and the errors of [`write_atomically`].
pub fn write_lightmap_png(path: &Path, lightmap: &Lightmap, page: usize) -> Result<f32, ExportError> {
    let lumels = lumels_of(path, lightmap, page)?;
    check(path, lightmap)?;
    let values = &lightmap.layers[0].values[lumels];
    let scale = power_above(largest(values));
    let word = |x: f32| (x.max(0.0) / scale * 65535.0).round() as u16;
    let bytes: Vec<u8> =
        values.iter().flat_map(|v| v.to_array()).flat_map(|x| word(x).to_be_bytes()).collect();
    let texts = [("irradiance of 65535", &*scale.to_string())];
    write_atomically(path, |out| {
        encode_linear(out, lightmap.atlas.pages()[page], BitDepth::Sixteen, &bytes, &texts)
    })?;
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

/// The largest value, which 255 stands for, and the values as bytes, [dithered](dithered_over).
pub(crate) fn dithered(values: &[Vec3], width: u32) -> (f32, Vec<u8>) {
    let scale = largest(values);
    (scale, dithered_over(scale, values, width))
}

/// Values as bytes, of which 255 stands for `scale`. Their mean over a few lumels is exact: which lumels are rounded up follows
/// a pattern that looks like noise (Jimenez, *Next Generation Post Processing in Call of Duty*, 2014).
pub(crate) fn dithered_over(scale: f32, values: &[Vec3], width: u32) -> Vec<u8> {
    let inverse = if scale > 0.0 { scale.recip() } else { 0.0 };
    let mut bytes = Vec::with_capacity(3 * values.len());
    for (lumel, value) in values.iter().enumerate() {
        let [x, y] = [lumel % width as usize, lumel / width as usize].map(|k| k as f64);
        for (channel, value) in value.to_array().into_iter().enumerate() {
            // Channels are rounded up in different places.
            let x = x + 5.588_238 * channel as f64;
            let threshold = (52.982_918_9 * (0.067_110_56 * x + 0.005_837_15 * y).fract()).fract();
            let exact = 255.0 * f64::from(value.max(0.0) * inverse);
            bytes.push((exact + threshold).floor().min(255.0) as u8);
        }
    }
    bytes
}

/// Encodes three channels of linear values. What is to be shown by a browser has no chunk about colour: it would be
/// converted.
pub(crate) fn encode_linear(
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

    #[test]
    fn dithering_keeps_the_mean_of_any_small_block() {
        let width = 64;
        let mut worst: f64 = 0.0;
        for step in 0..40 {
            let value = 100.0 + step as f32 / 40.0;
            // One lumel of the largest value sets the scale.
            let mut values = vec![Vec3::splat(value / 255.0); 64 * 64];
            values[0] = Vec3::ONE;
            let (scale, bytes) = dithered(&values, width);
            assert_eq!((scale, &bytes[..3]), (1.0, &[255; 3][..]));
            let differ = bytes.chunks(3).filter(|channels| channels[0] != channels[1]).count();
            assert!(step == 0 || differ > 0, "channels are rounded up in different places");
            for (bx, by, channel) in
                (0..8).flat_map(|x| (1..8).flat_map(move |y| (0..3).map(move |c| (x, y, c))))
            {
                let sum: f64 = (0..64)
                    .map(|i| f64::from(bytes[3 * ((8 * by + i / 8) * 64 + 8 * bx + i % 8) + channel]))
                    .sum();
                worst = worst.max((sum / 64.0 - f64::from(value)).abs());
            }
        }
        println!("{worst:.3} of a step");
        assert!(worst < 0.1, "{worst} of a step, in blocks of 8 by 8");
    }

    #[test]
    fn darkness_is_black_and_the_brightest_is_255() {
        assert_eq!(dithered(&[Vec3::ZERO; 2], 1), (0.0, vec![0; 6]));
        let (scale, bytes) = dithered(&[Vec3::splat(0.123), Vec3::new(0.0, -1.0, 0.123)], 2);
        assert_eq!((scale, bytes), (0.123, vec![255, 255, 255, 0, 0, 255]));
    }
}
