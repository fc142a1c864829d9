//! Mean brightness of any part of a texture.

use glam::{DVec2, Vec3};
use lumel_scene::{Filter, Texture, Wrap};

/// Brightness is counted in this many steps: sums of whole numbers leave exactly nothing where all texels are black.
const STEPS: f64 = (1u64 << 31) as f64;

/// How much wider a part is taken than it is, in texels and of its coordinates, so that rounding leaves no texel out.
const MARGIN: [f64; 2] = [1e-2, 1e-6];

/// A texture's running sums of brightness.
///
/// Crow, *Summed-Area Tables for Texture Mapping*, 1984.
pub(crate) struct TexelSums {
    size: [u32; 2],
    wraps: [Wrap; 2],
    filter: Filter,
    /// Of the texels above and left of each corner, row by row.
    sums: Vec<u64>,
    /// The brightness of one step.
    step: f64,
}

impl TexelSums {
    /// `None` if all texels are black.
    pub(crate) fn new(texture: &Texture, brightness: impl Fn(Vec3) -> f32) -> Option<Self> {
        let (width, height) = texture.size();
        let of = |x, y| f64::from(brightness(texture.texel(x, y)));
        let brightest = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| of(x, y))
            .filter(|texel| texel.is_finite())
            .fold(0.0, f64::max);
        if brightest <= 0.0 {
            return None;
        }
        let step = brightest / STEPS;
        let mut above = vec![0; width as usize + 1];
        let mut sums = above.clone();
        for y in 0..height {
            let mut row = 0;
            for (x, above) in (0..width).zip(&mut above[1..]) {
                // Rounded up: a texel that is lit counts. What is not finite is as bright as can be.
                row += (of(x, y) / step).ceil().min(STEPS) as u64;
                *above += row;
            }
            sums.extend_from_slice(&above);
        }
        let wraps = [texture.wrap_u, texture.wrap_v];
        Some(Self { size: [width, height], wraps, filter: texture.filter, sums, step })
    }

    /// The mean brightness of all texels that have a part in a rectangle of texture coordinates; zero only if all are black.
    pub(crate) fn mean(&self, low: DVec2, high: DVec2) -> f64 {
        let [columns, rows] = [0, 1].map(|axis| self.covered(axis, low[axis], high[axis]));
        let (mut sum, mut texels) = (0, 0);
        for rows in &rows {
            for columns in &columns {
                sum += self.sum(*columns, *rows);
                texels += u64::from(columns[1] - columns[0]) * u64::from(rows[1] - rows[0]);
            }
        }
        sum as f64 * self.step / texels.max(1) as f64
    }

    /// Texels across and down.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Of texels from the first of columns and rows to before the second.
    fn sum(&self, [left, right]: [u32; 2], [top, bottom]: [u32; 2]) -> u64 {
        let at = |x: u32, y: u32| self.sums[y as usize * (self.size[0] as usize + 1) + x as usize];
        at(right, bottom) + at(left, top) - at(left, bottom) - at(right, top)
    }

    /// The texels along an axis that an interval of texture coordinates shows, as up to two ranges.
    fn covered(&self, axis: usize, low: f64, high: f64) -> [[u32; 2]; 2] {
        let size = i64::from(self.size[axis]);
        let scale = f64::from(self.size[axis]);
        let margin = MARGIN[0] + MARGIN[1] * scale * low.abs().max(high.abs());
        let (shift, beside) = match self.filter {
            Filter::Linear => (0.5, 1),
            Filter::Nearest => (0.0, 0),
        };
        let first = (low * scale - shift - margin).floor() as i64;
        let end = ((high * scale - shift + margin).floor() as i64).saturating_add(1 + beside);
        let length = end.saturating_sub(first);
        let range = |first: i64, end: i64| [first, end].map(|texel| texel.clamp(0, size) as u32);
        match self.wraps[axis] {
            Wrap::Clamp => {
                let first = first.clamp(0, size - 1);
                [range(first, end.max(first + 1)), [0; 2]]
            }
            _ if length >= size => [range(0, size), [0; 2]],
            Wrap::Repeat => {
                let first = first.rem_euclid(size);
                [range(first, first + length), range(0, first + length - size)]
            }
            Wrap::Mirror => {
                let first = first.rem_euclid(2 * size);
                let end = first + length;
                let mirrored = range(2 * size - end.min(2 * size), 2 * size - first.max(size));
                let straight =
                    if first < size { range(first, end) } else { range(0, (end - 2 * size).max(0)) };
                [straight, if end > size { mirrored } else { [0; 2] }]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn sums(wrap: Wrap, filter: Filter) -> (Texture, TexelSums) {
        let texel = |i: u32| [if i.is_multiple_of(3) { 0.0 } else { i as f32 }; 3];
        let mut texture = Texture::from_floats("t", 8, 4, (0..32).map(texel).collect()).unwrap();
        (texture.wrap_u, texture.wrap_v, texture.filter) = (wrap, wrap, filter);
        let sums = TexelSums::new(&texture, |texel| texel.x).unwrap();
        (texture, sums)
    }

    #[test]
    fn the_mean_of_the_whole_is_that_of_all_texels() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let (texture, sums) = sums(wrap, Filter::Nearest);
            let mean = sums.mean(DVec2::ZERO, DVec2::ONE);
            assert!((mean / f64::from(texture.mean().x) - 1.0).abs() < 1e-6, "{wrap:?} {mean}");
        }
    }

    #[test]
    fn no_lit_point_lies_in_a_rectangle_of_mean_zero() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Linear, Filter::Nearest] {
                let mut texels = vec![[0.0; 3]; 64];
                texels[29] = [1e-6; 3];
                let mut texture = Texture::from_floats("t", 8, 8, texels).unwrap();
                (texture.wrap_u, texture.wrap_v, texture.filter) = (wrap, wrap, filter);
                let sums = TexelSums::new(&texture, |texel| texel.x).unwrap();
                let mut dark = 0;
                for i in -50..50 {
                    for j in -50..50 {
                        let low = DVec2::new(f64::from(i), f64::from(j)) * 0.071;
                        let mean = sums.mean(low, low + 0.071);
                        dark += i32::from(mean == 0.0);
                        for k in 0..9 {
                            let within = DVec2::new(f64::from(k % 3), f64::from(k / 3)) * 0.0355;
                            let at: Vec2 = (low + within).as_vec2();
                            assert!(texture.sample(at).x == 0.0 || mean > 0.0, "{wrap:?} {filter:?} {at}");
                        }
                    }
                }
                assert!(dark > 5000, "{wrap:?} {filter:?}: {dark}");
            }
        }
    }

    #[test]
    fn a_black_texture_has_no_sums() {
        let texture = Texture::from_floats("t", 2, 1, vec![[0.0; 3]; 2]).unwrap();
        assert!(TexelSums::new(&texture, |texel| texel.x).is_none());
    }
}
