//! Mipmaps of a texture, averaged in linear light.

use crate::shaders::MAX_F16;
use half::f16;
use lumel_render_cpu::srgb_byte;
use lumel_scene::{Encoding, Texture};
use std::sync::LazyLock;

/// One size of a texture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Level {
    pub(crate) size: [u32; 2],
    /// Row by row from the top, in the format of the pyramid.
    pub(crate) bytes: Vec<u8>,
}

/// A texture in all sizes, the largest first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pyramid {
    pub(crate) format: wgpu::TextureFormat,
    pub(crate) levels: Vec<Level>,
}

/// Texels in linear light, with alpha.
struct Linear {
    size: [u32; 2],
    texels: Vec<[f32; 4]>,
}

impl Pyramid {
    /// A white texel.
    pub(crate) fn white() -> Self {
        let level = Level { size: [1, 1], bytes: vec![u8::MAX; 4] };
        Self { format: wgpu::TextureFormat::Rgba8Unorm, levels: vec![level] }
    }

    /// A texture in its own size, or the largest one that is at most `limit` wide and high.
    pub(crate) fn largest(texture: &Texture, limit: u32) -> Self {
        let (width, height) = texture.size();
        if width.max(height) > limit {
            let mut pyramid = Self::new(texture, limit);
            pyramid.levels.truncate(1);
            return pyramid;
        }
        let level = Level { size: [width, height], bytes: original(texture) };
        Self { format: format_of(texture), levels: vec![level] }
    }

    /// All sizes of a texture down to one texel, except those wider or higher than `limit`.
    pub(crate) fn new(texture: &Texture, limit: u32) -> Self {
        let encoding = texture.bytes().map(|(_, encoding)| encoding);
        let format = format_of(texture);
        let (width, height) = texture.size();
        let mut levels = Vec::new();
        if width.max(height) <= limit {
            levels.push(Level { size: [width, height], bytes: original(texture) });
        }
        let at = |x, y| texture.texel(x, y).extend(texture.texel_alpha(x, y)).to_array();
        let mut next = smaller([width, height], at);
        while let Some(level) = next {
            if level.size[0].max(level.size[1]) <= limit {
                levels.push(Level { size: level.size, bytes: encode(&level.texels, encoding) });
            }
            let at = |x: u32, y: u32| level.texels[(y * level.size[0] + x) as usize];
            next = smaller(level.size, at);
        }
        Self { format, levels }
    }
}

fn format_of(texture: &Texture) -> wgpu::TextureFormat {
    match texture.bytes() {
        Some((_, Encoding::Srgb)) => wgpu::TextureFormat::Rgba8UnormSrgb,
        Some((_, Encoding::Linear)) => wgpu::TextureFormat::Rgba8Unorm,
        None => wgpu::TextureFormat::Rgba16Float,
    }
}

/// The texels as they are stored.
fn original(texture: &Texture) -> Vec<u8> {
    if let Some((rgba, _)) = texture.bytes() {
        return rgba.as_flattened().to_vec();
    }
    let (width, height) = texture.size();
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels: Vec<_> = rows.map(|(x, y)| texture.texel(x, y).extend(1.0).to_array()).collect();
    encode(&texels, None)
}

/// An image of half the width and height, rounded down; `None` for a single texel.
fn smaller(size: [u32; 2], at: impl Fn(u32, u32) -> [f32; 4]) -> Option<Linear> {
    if size == [1, 1] {
        return None;
    }
    let half = size.map(|n| (n / 2).max(1));
    let [columns, rows] = [0, 1].map(|axis| shares(size[axis], half[axis]));
    let mut texels = Vec::with_capacity(half[0] as usize * half[1] as usize);
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0; 4];
            for &(y, share_y) in row {
                for &(x, share_x) in column {
                    let texel = at(x, y);
                    for (sum, channel) in sum.iter_mut().zip(texel) {
                        *sum += share_x * share_y * channel;
                    }
                }
            }
            texels.push(sum);
        }
    }
    Some(Linear { size: half, texels })
}

/// The texels that each texel of a smaller row covers, with their weights.
fn shares(from: u32, to: u32) -> Vec<Vec<(u32, f32)>> {
    let (from, to) = (u64::from(from), u64::from(to));
    // In steps of 1/(from·to): a texel is `to` long, one of the smaller row `from`.
    let covered = |k: u64| {
        let (start, end) = (k * from, (k + 1) * from);
        let share = |texel: u64| {
            let overlap = end.min((texel + 1) * to) - start.max(texel * to);
            (texel as u32, overlap as f32 / from as f32)
        };
        (start / to..end.div_ceil(to)).map(share).collect()
    };
    (0..to).map(covered).collect()
}

/// Entries of [`SRGB`] per unit of light: in the dark, where the curve is steepest, an entry is 0.8 codes.
const SRGB_STEPS: usize = 4095;

/// A table instead of the exact curve: mipmaps need not be exact, and there are many texels.
static SRGB: LazyLock<Vec<u8>> =
    LazyLock::new(|| (0..=SRGB_STEPS).map(|i| srgb_byte(i as f32 / SRGB_STEPS as f32)).collect());

fn encode(texels: &[[f32; 4]], encoding: Option<Encoding>) -> Vec<u8> {
    let unit = |x: f32, steps: f32| (x.clamp(0.0, 1.0) * steps + 0.5) as usize;
    match encoding {
        Some(Encoding::Srgb) => {
            let table = &*SRGB;
            let code = |x| table[unit(x, SRGB_STEPS as f32)];
            let bytes = |[r, g, b, alpha]: [f32; 4]| [code(r), code(g), code(b), unit(alpha, 255.0) as u8];
            texels.iter().flat_map(|&texel| bytes(texel)).collect()
        }
        Some(Encoding::Linear) => texels.as_flattened().iter().map(|&x| unit(x, 255.0) as u8).collect(),
        None => {
            let halves = texels.as_flattened().iter().map(|&x| finite_f16(x));
            halves.flat_map(f16::to_ne_bytes).collect()
        }
    }
}

/// The nearest 16-bit float from 0 to 65504: an infinity would spread over its neighbours when it is filtered.
fn finite_f16(value: f32) -> f16 {
    // NaN becomes zero.
    f16::from_f32(if value > 0.0 { value.min(MAX_F16) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(pyramid: &Pyramid) -> Vec<[u32; 2]> {
        pyramid.levels.iter().map(|level| level.size).collect()
    }

    #[test]
    fn levels_go_down_to_one_texel_and_leave_out_what_is_too_large() {
        let texture = Texture::from_bytes("t", 5, 2, vec![[9; 4]; 10], Encoding::Linear).unwrap();
        assert_eq!(sizes(&Pyramid::new(&texture, 8192)), [[5, 2], [2, 1], [1, 1]]);
        assert_eq!(sizes(&Pyramid::new(&texture, 4)), [[2, 1], [1, 1]]);
        assert_eq!(sizes(&Pyramid::new(&texture, 1)), [[1, 1]]);
    }

    #[test]
    fn the_largest_level_has_the_bytes_of_the_texture() {
        let rgba = vec![[1, 2, 3, 4], [5, 6, 7, 8]];
        let texture = Texture::from_bytes("t", 2, 1, rgba.clone(), Encoding::Srgb).unwrap();
        assert_eq!(Pyramid::new(&texture, 8192).levels[0].bytes, rgba.as_flattened());
    }

    #[test]
    fn srgb_texels_are_averaged_in_linear_light() {
        let rgba = vec![[0, 0, 0, 255], [255; 4]];
        let texture = Texture::from_bytes("t", 2, 1, rgba.clone(), Encoding::Srgb).unwrap();
        assert_eq!(Pyramid::new(&texture, 8192).levels[1].bytes, [188, 188, 188, 255]);
        let texture = Texture::from_bytes("t", 2, 1, rgba, Encoding::Linear).unwrap();
        assert_eq!(Pyramid::new(&texture, 8192).levels[1].bytes, [128, 128, 128, 255]);
    }

    #[test]
    fn alpha_is_averaged_too() {
        let texture =
            Texture::from_bytes("t", 2, 1, vec![[9, 9, 9, 0], [9, 9, 9, 200]], Encoding::Srgb).unwrap();
        assert_eq!(Pyramid::new(&texture, 8192).levels[1].bytes[3], 100);
    }

    #[test]
    fn every_texel_has_the_same_weight_in_images_of_odd_size() {
        for (from, to) in [(1, 1), (3, 1), (7, 3), (8, 4), (9, 4)] {
            let mut total = vec![0.0; from as usize];
            for covered in shares(from, to) {
                assert!((covered.iter().map(|(_, share)| share).sum::<f32>() - 1.0).abs() < 1e-6);
                covered.iter().for_each(|&(texel, share)| total[texel as usize] += share);
            }
            let expected = to as f32 / from as f32;
            assert!(total.iter().all(|share| (share - expected).abs() < 1e-6), "{from} to {to}: {total:?}");
        }
    }

    #[test]
    fn float_textures_keep_numbers_above_one() {
        let texture = Texture::from_floats("t", 2, 1, vec![[1.0, 0.0, 8.0], [3.0, 0.0, 0.0]]).unwrap();
        let small = &Pyramid::new(&texture, 8192).levels[1];
        let expected = [2.0, 0.0, 4.0, 1.0].map(f16::from_f32).map(f16::to_ne_bytes);
        assert_eq!(small.bytes, expected.as_flattened());
    }

    #[test]
    fn numbers_that_16_bit_floats_do_not_hold_become_the_nearest_one() {
        let halves = [-1.0, f32::NAN, 65_519.0, 65_520.0, 1e9, f32::INFINITY].map(finite_f16);
        assert_eq!(halves.map(f16::to_f32), [0.0, 0.0, 65_504.0, 65_504.0, 65_504.0, 65_504.0]);
    }
}
