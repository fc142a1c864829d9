//! Pictures of atlases.

use crate::{ExportError, write_png};
use glam::{DVec2, Vec3};
use lumel_scene::TriId;
use lumel_uv::{Atlas, Coverage};
use std::path::Path;

/// The longest side that a picture is enlarged to, pixels, and by how much at most.
const ENLARGED: u32 = 2048;
const MOST_ENLARGED: u32 = 8;

/// What no chart is at.
const EMPTY: [u8; 3] = [20, 20, 24];

/// Edges are drawn where triangles are wider than this on average, pixels: they would cover smaller ones.
const EDGES_FROM: f64 = 5.0;

/// Writes a picture of a page of an atlas, atomically: a colour for each chart, lines along the edges of triangles, dark
/// where reading between lumels reaches beyond a chart. Small pages are enlarged.
///
/// # Errors
/// A page that the atlas does not have, and the errors of [`write_png`].
pub fn write_atlas_png(path: &Path, atlas: &Atlas, page: usize) -> Result<(), ExportError> {
    let Some(&[width, height]) = atlas.pages().get(page) else {
        return Err(ExportError::content(path, format!("the atlas has no page {page}")));
    };
    let scale = (ENLARGED / width.max(height)).clamp(1, MOST_ENLARGED);
    let mut picture = Picture::new(width * scale, height * scale);
    let coverage = Coverage::new(atlas);
    let first = atlas.first_lumel(page);
    for (place, &lumel) in coverage.lumels().iter().enumerate() {
        let Some(lumel) = (lumel as usize).checked_sub(first).filter(|&l| l < (width * height) as usize)
        else {
            continue;
        };
        let share = coverage.shares(place)[0];
        let shade = if share.area > 0.0 { 0.45 } else { 0.2 };
        let [x, y] = [lumel as u32 % width, lumel as u32 / width].map(|k| k * scale);
        picture.fill_square([x, y], scale, shaded(chart_color(atlas.chart(share.tri)), shade));
    }
    let tris = || (0..atlas.triangle_count() as u32).map(TriId).filter(|&tri| atlas.page(tri) == page);
    let corners = |tri: TriId| atlas.corners(tri).map(|c| c.as_dvec2() * f64::from(scale));
    for tri in tris() {
        picture.fill_triangle(corners(tri), shaded(chart_color(atlas.chart(tri)), 1.0));
    }
    for tri in tris() {
        let [a, b, c] = corners(tri);
        if (b - a).perp_dot(c - a) > EDGES_FROM * EDGES_FROM {
            let dark = shaded(chart_color(atlas.chart(tri)), 0.7);
            [(a, b), (b, c), (c, a)].into_iter().for_each(|(from, to)| picture.line(from, to, dark));
        }
    }
    write_png(path, picture.width, picture.height, &picture.pixels, &[("Title", "atlas")])
}

/// The colour of a chart in pictures, by its number: neighbouring numbers have hues far apart.
pub fn chart_color(chart: usize) -> Vec3 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let hue = (chart as f64 * GOLDEN).fract() as f32 * 6.0;
    let channel = |shift: f32| (((hue + shift) % 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
    let pure = Vec3::new(channel(0.0), channel(4.0), channel(2.0));
    // Three lightnesses, so that charts of similar hue still differ.
    let lightness = [0.35, 0.5, 0.2][chart % 3];
    pure * (1.0 - lightness) * 0.8 + lightness
}

fn shaded(color: Vec3, shade: f32) -> [u8; 3] {
    (color * shade * 255.0).to_array().map(|x| x as u8)
}

struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![EMPTY; width as usize * height as usize] }
    }

    fn row(&mut self, y: u32) -> &mut [[u8; 3]] {
        &mut self.pixels[y as usize * self.width as usize..][..self.width as usize]
    }

    fn fill_square(&mut self, [x, y]: [u32; 2], side: u32, color: [u8; 3]) {
        for y in y..y + side {
            self.row(y)[x as usize..(x + side) as usize].fill(color);
        }
    }

    /// Fills the pixels whose centres lie in a triangle.
    fn fill_triangle(&mut self, corners: [DVec2; 3], color: [u8; 3]) {
        let ys = corners.map(|c| c.y);
        let first = (ys[0].min(ys[1]).min(ys[2]) - 0.5).ceil().max(0.0) as u32;
        let end = (ys[0].max(ys[1]).max(ys[2]) + 0.5).floor().min(f64::from(self.height)) as u32;
        for y in first..end {
            let at = f64::from(y) + 0.5;
            let mut span = [f64::INFINITY, f64::NEG_INFINITY];
            for k in 0..3 {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                if (from.y <= at) != (to.y <= at) {
                    let x = from.x + (to.x - from.x) * (at - from.y) / (to.y - from.y);
                    span = [span[0].min(x), span[1].max(x)];
                }
            }
            let [begin, end] =
                [span[0] - 0.5, span[1] - 0.5].map(|x| x.ceil().clamp(0.0, f64::from(self.width)));
            if begin < end {
                self.row(y)[begin as usize..end as usize].fill(color);
            }
        }
    }

    fn line(&mut self, from: DVec2, to: DVec2, color: [u8; 3]) {
        let steps = (to - from).abs().max_element().ceil().max(1.0);
        for step in 0..=steps as u32 {
            let at = from.lerp(to, f64::from(step) / steps);
            if at.x >= 0.0 && at.y >= 0.0 && at.x < f64::from(self.width) && at.y < f64::from(self.height) {
                self.row(at.y as u32)[at.x as usize] = color;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_fills_half_of_its_square() {
        let mut picture = Picture::new(10, 10);
        let corners = [DVec2::ZERO, DVec2::X * 10.0, DVec2::Y * 10.0];
        picture.fill_triangle(corners, [255; 3]);
        let n_white = picture.pixels.iter().filter(|pixel| **pixel == [255; 3]).count();
        assert!((45..=55).contains(&n_white), "{n_white}");
        picture.line(DVec2::new(-5.5, 5.5), DVec2::new(49.5, 5.5), [1; 3]);
        assert!(picture.row(5).iter().all(|pixel| *pixel == [1; 3]));
    }

    #[test]
    fn neighbouring_charts_have_colours_that_differ() {
        for chart in 0..100 {
            assert!(chart_color(chart).distance(chart_color(chart + 1)) > 0.2, "{chart}");
            assert!(chart_color(chart).min_element() >= 0.0 && chart_color(chart).max_element() <= 1.0);
        }
    }
}
