//! Images on surfaces and lights.

use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// How the stored numbers of a texture become linear light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// sRGB transfer curve.
    Srgb,
    /// Linear.
    Linear,
}

/// What a texture shows outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image mirrored.
    Mirror,
    /// Its last texel.
    Clamp,
}

/// What a texture shows between the centres of its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The four texels around, mixed bilinearly.
    #[default]
    Linear,
    /// The texel in which the point lies.
    Nearest,
}

#[derive(Clone, Debug, PartialEq)]
enum Texels {
    Bytes { rgba: Vec<[u8; 4]>, encoding: Encoding },
    Floats(Vec<[f32; 3]>),
}

/// An image with texel (0, 0) at the top left; `v` of a texture coordinate points down, as in glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// File or generator it came from.
    pub name: String,
    width: u32,
    height: u32,
    texels: Texels,
    /// Behaviour left and right of the image.
    pub wrap_u: Wrap,
    /// Behaviour above and below it.
    pub wrap_v: Wrap,
    /// Behaviour between the centres of texels.
    pub filter: Filter,
}

static SRGB_TO_LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|byte| {
        let c = byte as f64 / 255.0;
        (if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }) as f32
    })
});

impl Texture {
    /// A texture of bytes, row by row from the top. `None` unless `rgba.len() == width * height > 0`.
    pub fn from_bytes(
        name: &str,
        width: u32,
        height: u32,
        rgba: Vec<[u8; 4]>,
        encoding: Encoding,
    ) -> Option<Self> {
        let fits = rgba.len() == width as usize * height as usize && !rgba.is_empty();
        fits.then(|| Self::new(name, width, height, Texels::Bytes { rgba, encoding }))
    }

    /// A texture of linear floats, row by row from the top. `None` unless `rgb.len() == width * height > 0`.
    ///
    /// Texels that are negative or not finite become zero.
    pub fn from_floats(name: &str, width: u32, height: u32, mut rgb: Vec<[f32; 3]>) -> Option<Self> {
        let fits = rgb.len() == width as usize * height as usize && !rgb.is_empty();
        for channel in rgb.as_flattened_mut() {
            if !(channel.is_finite() && *channel >= 0.0) {
                *channel = 0.0;
            }
        }
        fits.then(|| Self::new(name, width, height, Texels::Floats(rgb)))
    }

    fn new(name: &str, width: u32, height: u32, texels: Texels) -> Self {
        Self {
            name: name.to_owned(),
            width,
            height,
            texels,
            wrap_u: Wrap::default(),
            wrap_v: Wrap::default(),
            filter: Filter::default(),
        }
    }

    /// The texture whose alpha is its brightness, unless it has an alpha.
    #[must_use]
    pub fn into_opacity(mut self) -> Self {
        if self.alpha_range() != [1.0; 2] {
            return self;
        }
        let rgba = match &self.texels {
            Texels::Bytes { rgba, .. } => {
                rgba.iter().map(|&[r, g, b, _]| mean_byte([r, g, b].map(f32::from))).collect()
            }
            Texels::Floats(rgb) => rgb.iter().map(|rgb| mean_byte(rgb.map(|c| 255.0 * c))).collect(),
        };
        self.texels = Texels::Bytes { rgba, encoding: Encoding::Linear };
        self
    }

    /// Width and height in texels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The stored bytes and their encoding, for writing the image out again; `None` for float textures.
    pub fn bytes(&self) -> Option<(&[[u8; 4]], Encoding)> {
        match &self.texels {
            Texels::Bytes { rgba, encoding } => Some((rgba, *encoding)),
            Texels::Floats(_) => None,
        }
    }

    /// One texel, linear. `x` and `y` must be inside the image.
    #[inline]
    pub fn texel(&self, x: u32, y: u32) -> Vec3 {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Bytes { rgba, encoding: Encoding::Srgb } => from_srgb(rgba[index], &SRGB_TO_LINEAR),
            Texels::Bytes { rgba, encoding: Encoding::Linear } => from_linear(rgba[index]),
            Texels::Floats(rgb) => Vec3::from_array(rgb[index]),
        }
    }

    /// Alpha of one texel; 1 in images without. `x` and `y` must be inside the image.
    #[inline]
    pub fn texel_alpha(&self, x: u32, y: u32) -> f32 {
        match &self.texels {
            Texels::Bytes { rgba, .. } => alpha(rgba[y as usize * self.width as usize + x as usize]),
            Texels::Floats(_) => 1.0,
        }
    }

    /// The smallest and the largest alpha.
    pub fn alpha_range(&self) -> [f32; 2] {
        let Texels::Bytes { rgba, .. } = &self.texels else { return [1.0; 2] };
        let (low, high) = rgba.iter().fold((255, 0), |(low, high), t| (t[3].min(low), t[3].max(high)));
        [low, high].map(|alpha| f32::from(alpha) / 255.0)
    }

    /// The value at a texture coordinate by the texture's wrapping and filter, linear.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        match &self.texels {
            Texels::Bytes { rgba, encoding: Encoding::Srgb } => {
                let table = &*SRGB_TO_LINEAR;
                self.look_up(uv, rgba, |texel| from_srgb(texel, table))
            }
            Texels::Bytes { rgba, encoding: Encoding::Linear } => self.look_up(uv, rgba, from_linear),
            Texels::Floats(rgb) => self.look_up(uv, rgb, Vec3::from_array),
        }
    }

    /// Alpha at a texture coordinate by the texture's wrapping and filter; 1 in images without.
    pub fn alpha(&self, uv: Vec2) -> f32 {
        match &self.texels {
            Texels::Bytes { rgba, .. } => self.look_up(uv, rgba, |texel| Vec3::splat(alpha(texel))).x,
            Texels::Floats(_) => 1.0,
        }
    }

    /// The value of `texels`, which are this texture's, at a texture coordinate.
    #[inline(always)]
    fn look_up<T: Copy>(&self, uv: Vec2, texels: &[T], value: impl Fn(T) -> Vec3) -> Vec3 {
        let texel = |x: u32, y: u32| value(texels[y as usize * self.width as usize + x as usize]);
        if !uv.is_finite() {
            return texel(0, 0);
        }
        if self.filter == Filter::Nearest {
            let [x, y] = [(uv.x, self.width, self.wrap_u), (uv.y, self.height, self.wrap_v)]
                .map(|(coordinate, size, wrap)| nearest(coordinate, size, wrap));
            return texel(x, y);
        }
        let (x0, x1, fx) = neighbours(uv.x, self.width, self.wrap_u);
        let (y0, y1, fy) = neighbours(uv.y, self.height, self.wrap_v);
        let top = texel(x0, y0).lerp(texel(x1, y0), fx);
        let bottom = texel(x0, y1).lerp(texel(x1, y1), fx);
        top.lerp(bottom, fy)
    }

    /// The largest texel in each channel.
    pub fn max(&self) -> Vec3 {
        self.all_texels().fold(Vec3::ZERO, Vec3::max)
    }

    /// The mean texel.
    pub fn mean(&self) -> Vec3 {
        let sum = self.all_texels().fold(glam::DVec3::ZERO, |sum, texel| sum + texel.as_dvec3());
        (sum / (self.width as f64 * self.height as f64)).as_vec3()
    }

    fn all_texels(&self) -> impl Iterator<Item = Vec3> + '_ {
        (0..self.height).flat_map(move |y| (0..self.width).map(move |x| self.texel(x, y)))
    }
}

#[inline]
fn from_srgb([r, g, b, _]: [u8; 4], table: &[f32; 256]) -> Vec3 {
    Vec3::new(table[r as usize], table[g as usize], table[b as usize])
}

#[inline]
fn from_linear([r, g, b, _]: [u8; 4]) -> Vec3 {
    Vec3::new(r as f32, g as f32, b as f32) / 255.0
}

#[inline]
fn alpha([.., alpha]: [u8; 4]) -> f32 {
    f32::from(alpha) / 255.0
}

/// White whose alpha is the mean of channels, 0..=255.
fn mean_byte([r, g, b]: [f32; 3]) -> [u8; 4] {
    [255, 255, 255, ((r + g + b) / 3.0 + 0.5).min(255.0) as u8]
}

/// A coordinate inside the image or, of a mirrored one, inside the image and its mirror image.
///
/// Wrapping first keeps the texel position small, so that far-away coordinates lose no precision.
#[inline]
fn wrapped(coordinate: f32, wrap: Wrap) -> f32 {
    match wrap {
        Wrap::Repeat => coordinate - floor(coordinate),
        Wrap::Mirror => coordinate - 2.0 * floor(0.5 * coordinate),
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
    }
}

/// The texel in which a coordinate lies.
fn nearest(coordinate: f32, size: u32, wrap: Wrap) -> u32 {
    let index = (wrapped(coordinate, wrap) * size as f32) as u32;
    match wrap {
        Wrap::Mirror if index >= size => (2 * size - 1).saturating_sub(index),
        // Just below a whole number, wrapping rounds up to 1.
        _ => index.min(size - 1),
    }
}

/// The two texels around a coordinate and the weight of the second.
#[inline]
fn neighbours(coordinate: f32, size: u32, wrap: Wrap) -> (u32, u32, f32) {
    let position = wrapped(coordinate, wrap) * size as f32 - 0.5;
    let first = floor(position);
    let n = i64::from(size);
    // At most one texel beyond the ends.
    let fold = |index: i64| match wrap {
        Wrap::Repeat if index < 0 => n - 1,
        Wrap::Repeat if index >= n => 0,
        Wrap::Mirror if index >= 2 * n => 0,
        Wrap::Mirror if index >= n => 2 * n - 1 - index,
        _ => index.clamp(0, n - 1),
    };
    let index = first as i64;
    (fold(index) as u32, fold(index + 1) as u32, position - first)
}

/// `x.floor()`, which is a call of the C library where the processor is not known to have it.
#[inline]
fn floor(x: f32) -> f32 {
    // From here on all numbers are whole.
    const WHOLE: f32 = (1 << 23) as f32;
    if x.abs() >= WHOLE {
        return x;
    }
    let towards_zero = x as i32 as f32;
    if towards_zero > x { towards_zero - 1.0 } else { towards_zero }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(wrap: Wrap) -> Texture {
        let rgb = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        let mut texture = Texture::from_floats("ramp", 4, 1, rgb).unwrap();
        texture.wrap_u = wrap;
        texture
    }

    #[test]
    fn texel_centres_return_their_texel() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for x in 0..4 {
                let uv = Vec2::new((x as f32 + 0.5) / 4.0, 0.5);
                assert!((ramp(wrap).sample(uv).x - x as f32).abs() < 1e-5, "{wrap:?} {x}");
            }
        }
    }

    #[test]
    fn wrapping_follows_its_rule_beyond_the_edge() {
        let beyond = Vec2::new(1.0 + 0.5 / 4.0, 0.5);
        assert!((ramp(Wrap::Repeat).sample(beyond).x - 0.0).abs() < 1e-5);
        assert!((ramp(Wrap::Mirror).sample(beyond).x - 3.0).abs() < 1e-5);
        assert!((ramp(Wrap::Clamp).sample(beyond).x - 3.0).abs() < 1e-5);
        let seam = Vec2::new(0.0, 0.5);
        assert!((ramp(Wrap::Repeat).sample(seam).x - 1.5).abs() < 1e-5);
        assert!((ramp(Wrap::Clamp).sample(seam).x - 0.0).abs() < 1e-5);
    }

    #[test]
    fn the_nearest_texel_fills_its_whole_cell_under_every_wrapping() {
        let inside = [(0.0, 0), (0.24, 0), (0.26, 1), (0.74, 2), (0.76, 3), (0.999, 3)];
        let [repeat, mirror, clamp] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        let beyond =
            [(repeat, 1.3, 1), (repeat, -0.1, 3), (repeat, -1e-9, 3), (mirror, 1.3, 2), (mirror, -0.3, 1)];
        let far = [(mirror, 2.3, 1), (mirror, 1.0, 3), (mirror, -1e-9, 0), (clamp, 1.0, 3), (clamp, -5.0, 0)];
        let within = [repeat, mirror, clamp].into_iter().flat_map(|wrap| inside.map(|(u, x)| (wrap, u, x)));
        for (wrap, u, x) in within.chain(beyond).chain(far).chain([(clamp, 7.0, 3)]) {
            let texture = Texture { filter: Filter::Nearest, ..ramp(wrap) };
            assert_eq!(texture.sample(Vec2::new(u, 0.3)).x, x as f32, "{wrap:?} {u}");
        }
    }

    #[test]
    fn floors_are_those_of_the_standard_library() {
        let near = [0.0f32, -0.0, 0.5, 1.0, 8e6, 8_388_607.5, 1e9, 3e38, 1e-40];
        for x in near.into_iter().flat_map(|x| [x, -x, x.next_up(), -x.next_up()]) {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
    }

    #[test]
    fn srgb_bytes_become_linear() {
        let texture = Texture::from_bytes("grey", 1, 1, vec![[188, 0, 255, 255]], Encoding::Srgb).unwrap();
        let value = texture.sample(Vec2::ZERO);
        assert!((value.x - 0.502_886).abs() < 1e-5 && value.y == 0.0 && value.z == 1.0);
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused_and_bad_floats_become_zero() {
        assert!(Texture::from_bytes("x", 2, 2, vec![[0; 4]; 3], Encoding::Srgb).is_none());
        assert!(Texture::from_floats("x", 0, 0, vec![]).is_none());
        let texture = Texture::from_floats("x", 1, 1, vec![[f32::NAN, -1.0, 2.0]]).unwrap();
        assert_eq!(texture.texel(0, 0), Vec3::new(0.0, 0.0, 2.0));
        assert!(texture.sample(Vec2::splat(f32::NAN)).is_finite());
        assert!(texture.sample(Vec2::splat(1e30)).is_finite());
    }
}
