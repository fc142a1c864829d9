//! Normals of height maps.

use glam::{Vec2, Vec3};
use lumel_scene::{Encoding, Texture};

/// The height of white above black, in widths of the image.
///
/// Files do not say it. Those of two scenes that have a normal map beside their height map fit best with 0.047 and 0.089.
const RELIEF: f32 = 1.0 / 16.0;

/// The normal map that stands for a bump map: the image itself if it is one already, which many exporters name so, or the
/// normals of its heights.
pub(super) fn into_normals(image: Texture) -> Texture {
    if is_normal_map(&image) { image } else { of_heights(&image) }
}

/// Whether the texels are unit vectors out of the surface, more or less: mostly blue, with a straight mean.
fn is_normal_map(image: &Texture) -> bool {
    let mean = 2.0 * image.mean() - Vec3::ONE;
    mean.z > 0.4 && mean.truncate().length() < 0.5 * mean.z
}

/// Green is up. The image is the same beyond its edges: seams of other images are as wide as a texel.
fn of_heights(image: &Texture) -> Texture {
    let (width, height) = image.size();
    let at = |x: u32, y: u32| image.texel(x % width, y % height).element_sum() / 3.0;
    let steepness = 0.5 * RELIEF * width as f32;
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let slope =
            Vec2::new(at(x + 1, y) - at(x + width - 1, y), at(x, y + 1) - at(x, y + height - 1)) * steepness;
        let normal = Vec3::new(-slope.x, slope.y, 1.0).normalize_or(Vec3::Z);
        let [r, g, b] = (0.5 * (normal + Vec3::ONE)).to_array().map(byte);
        [r, g, b, u8::MAX]
    };
    let texels = (0..width * height).map(texel).collect();
    let normals = Texture::from_bytes(&image.name, width, height, texels, Encoding::Linear);
    normals.unwrap_or_else(|| image.clone())
}

fn byte(share: f32) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(size: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Texture {
        let of = |i: u32| {
            let [r, g, b] = texel(i % size, i / size);
            [r, g, b, 255]
        };
        let texels = (0..size * size).map(of).collect();
        Texture::from_bytes("image", size, size, texels, Encoding::Linear).unwrap()
    }

    /// A hill: bright in the middle.
    fn hill(x: u32, y: u32) -> f32 {
        let [u, v] = [x, y].map(|t| (t as f32 + 0.5) / 16.0 - 0.5);
        1.0 - 1.5 * (u * u + v * v)
    }

    #[test]
    fn normals_lean_away_from_what_is_higher() {
        let normals = into_normals(image(16, |x, y| [byte(hill(x, y)); 3]));
        let at = |x: u32, y: u32| 2.0 * normals.texel(x, y) - Vec3::ONE;
        let [left, right, top, bottom] = [at(3, 8), at(12, 8), at(8, 3), at(8, 12)];
        assert!(left.x < -0.05 && right.x > 0.05 && left.y.abs() < 0.01, "{left} {right}");
        assert!(top.y > 0.05 && bottom.y < -0.05 && top.x.abs() < 0.01, "{top} {bottom}");
        // 3 · (12.5/16 − 1/2) of height in a width, of which a width is a sixteenth.
        let slope = 3.0 * (12.5 / 16.0 - 0.5) * RELIEF;
        // Steps of heights are a 255th, over two texels of which a sixteenth is the width.
        assert!((right.x / right.z - slope).abs() < 0.5 * RELIEF * 16.0 / 255.0 + 0.01, "{right} {slope}");
    }

    #[test]
    fn normal_maps_and_height_maps_are_told_apart() {
        let flat = |_: u32, _: u32| [128, 128, 255];
        let bumpy = |x: u32, y: u32| if (x + y).is_multiple_of(2) { [200, 100, 220] } else { [60, 160, 220] };
        for normals in [image(4, flat), image(4, bumpy)] {
            assert_eq!(into_normals(normals.clone()), normals);
        }
        for heights in [[255; 3], [0; 3], [128; 3], [200, 200, 210]] {
            let normals = into_normals(image(4, |_, _| heights));
            assert_eq!(normals.bytes().unwrap().0[5], [128, 128, 255, 255]);
        }
    }
}
