//! The sphere of directions as an image: longitude and latitude.

use glam::Vec3;
use std::f64::consts::{PI, TAU};

/// Where the texels of an image lie whose width is longitude and whose height is latitude.
///
/// The middle of the image is the direction −z, its right half +x, its top +y. `turn` turns it counter-clockwise about +y,
/// radians: by a quarter turn, the middle becomes −x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equirectangular {
    size: [u32; 2],
    turn: f64,
}

impl Equirectangular {
    /// An image of so many columns and rows, at least one each.
    #[must_use]
    pub fn new(size: [u32; 2], turn: f32) -> Self {
        Self { size: size.map(|n| n.max(1)), turn: f64::from(turn) }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The column and row of a direction of any length; row 0 is at the top.
    #[inline]
    #[must_use]
    pub fn texel(&self, direction: Vec3) -> [u32; 2] {
        let [x, y, z] = direction.as_dvec3().to_array();
        let longitude = (x.atan2(-z) + self.turn) / TAU + 0.5;
        let latitude = x.hypot(z).atan2(y) / PI;
        let place = [longitude - longitude.floor(), latitude];
        [0, 1].map(|axis| ((place[axis] * f64::from(self.size[axis])) as u32).min(self.size[axis] - 1))
    }

    /// The unit direction at `offset` within a texel, uniform in solid angle for uniform offsets in the unit square.
    #[inline]
    #[must_use]
    pub fn direction(&self, [column, row]: [u32; 2], offset: [f32; 2]) -> Vec3 {
        let longitude = (f64::from(column) + f64::from(offset[0])) / f64::from(self.size[0]) - 0.5;
        let (sin, cos) = (longitude * TAU - self.turn).sin_cos();
        let [top, bottom] = self.heights(row);
        let height = top + (bottom - top) * f64::from(offset[1]);
        let radius = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
        Vec3::new((radius * sin) as f32, height as f32, (-radius * cos) as f32)
    }

    /// Solid angle of each texel of a row, sr.
    #[inline]
    #[must_use]
    pub fn solid_angle(&self, row: u32) -> f64 {
        let [top, bottom] = self.heights(row);
        (top - bottom) * TAU / f64::from(self.size[0])
    }

    /// The y of unit directions at the upper and the lower edge of a row.
    #[inline]
    fn heights(&self, row: u32) -> [f64; 2] {
        [row, row + 1].map(|edge| (f64::from(edge) / f64::from(self.size[1]) * PI).cos())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_lie_where_they_should() {
        let map = Equirectangular::new([8, 4], 0.0);
        // Just beside the edges between texels, to be sure of the side.
        let at = |x: f32, y: f32, z: f32| map.texel(Vec3::new(x, y, z));
        assert_eq!([at(-0.01, 0.01, -1.0), at(0.01, -0.01, -1.0)], [[3, 1], [4, 2]], "the middle is -z");
        assert_eq!([at(1.0, 0.01, -0.01), at(1.0, 0.01, 0.01)], [[5, 1], [6, 1]], "+x to the right");
        assert_eq!([at(0.01, 1.0, -0.01)[1], at(0.01, -1.0, 0.01)[1]], [0, 3]);
        let turned = Equirectangular::new([8, 4], std::f32::consts::FRAC_PI_2);
        assert_eq!(turned.texel(Vec3::new(-1.0, 0.01, 0.01)), map.texel(Vec3::new(-0.01, 0.01, -1.0)));
    }

    #[test]
    fn directions_lead_back_to_their_texel() {
        for turn in [0.0, 1.0, -70.0] {
            let map = Equirectangular::new([37, 19], turn);
            for row in 0..19 {
                for column in 0..37 {
                    for offset in [[0.01, 0.01], [0.5, 0.5], [0.99, 0.2]] {
                        let direction = map.direction([column, row], offset);
                        assert!((direction.length() - 1.0).abs() < 1e-6);
                        assert_eq!(map.texel(direction), [column, row], "{turn} {offset:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn texels_cover_the_sphere() {
        let map = Equirectangular::new([64, 32], 0.3);
        let all: f64 = (0..32).map(|row| 64.0 * map.solid_angle(row)).sum();
        assert!((all - 2.0 * TAU).abs() < 1e-12);
        assert!(map.solid_angle(0) < 0.1 * map.solid_angle(16));
    }
}
