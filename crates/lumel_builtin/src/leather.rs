//! The Cornell box with its back wall upholstered: tufted leather, as on a Chesterfield.

use crate::noise::{clouds, mix, nearest_points, smooth_step};
use crate::{cornell, painting};
use glam::{Vec2, Vec3};
use lumel_scene::{
    Encoding, Material, MaterialId, NormalMap, SceneBuilder, Texture, TextureId, TextureRef, UvTransform,
};

/// Texels along a side of the textures.
const SIZE: u32 = 512;

/// Buttons stand on every second point of a grid with this many columns and rows to a tile.
const GRID: f32 = 4.0;

/// Height of a cushion, in tiles: with cushions a quarter of a tile apart they slope by up to 45° and more.
const RELIEF: f32 = 0.085;

/// Tiles over the back wall: diamonds of 111 mm × 137 mm.
const REPEAT: Vec2 = Vec2::new(2.5, 2.0);

/// The Cornell box with a back wall of tufted leather; albedo and normals come from one height field.
pub(crate) fn cornell_leather(subdivide: u32) -> SceneBuilder {
    let mut builder = cornell::cornell_box(subdivide);
    builder.name = "cornell-leather".to_owned();
    builder.textures = [albedo(), normals()].into_iter().flatten().collect();
    let used = |index| {
        let transform = UvTransform { scale: REPEAT, ..UvTransform::default() };
        Some(TextureRef { texture: TextureId(index), transform })
    };
    let mut leather = Material::diffuse("leather", Vec3::ONE);
    leather.albedo_texture = used(0);
    leather.normal_texture = used(1).map(NormalMap::new);
    let id = MaterialId(builder.materials.len() as u32);
    builder.materials.push(leather);
    for wall in builder.objects.iter_mut().filter(|o| o.name == cornell::BACK_WALL) {
        wall.faces.iter_mut().for_each(|face| face.material = id);
    }
    builder
}

/// Brown leather, worn lighter on the cushions and dark in the creases.
fn albedo() -> Option<Texture> {
    let (dark, light) = (Vec3::new(0.17, 0.08, 0.045), Vec3::new(0.74, 0.45, 0.25));
    painting::texture("leather", [SIZE; 2], Encoding::Srgb, |uv| {
        let Tuft { pillow, rise, button, .. } = Tuft::at(uv);
        let cavity = smooth_step(0.0, 0.55, pillow) * mix(0.7, 1.0, rise);
        let worn = 0.22 * (clouds(uv, [6, 6], 11) - 0.5) + 0.1 * (clouds(uv, [48, 48], 12) - 0.5);
        let pores = 0.12 * (1.0 - smooth_step(0.0, 0.25, grain(uv)));
        let brightness = mix(mix(0.25, 0.85, cavity), 0.5, button) + worn - pores;
        dark.lerp(light, brightness.clamp(0.0, 1.0))
    })
}

/// Tangent-space normals of the height field, green up.
fn normals() -> Option<Texture> {
    painting::texture("leather normals", [SIZE; 2], Encoding::Linear, |uv| 0.5 * (normal(uv) + Vec3::ONE))
}

/// Unit normal: x along `u`, y against `v` (up in the picture), z out of the surface.
fn normal(uv: Vec2) -> Vec3 {
    // Differences over a texel: steeper detail could not be shown.
    let step = 0.5 / SIZE as f32;
    let slope = |d: Vec2| (height(uv + d) - height(uv - d)) / (2.0 * step);
    let [along_u, along_v] = [slope(Vec2::X * step), slope(Vec2::Y * step)];
    Vec3::new(-along_u, along_v, 1.0).try_normalize().unwrap_or(Vec3::Z)
}

/// Height of the leather, in tiles.
fn height(uv: Vec2) -> f32 {
    let Tuft { pillow, rise, button, gathers } = Tuft::at(uv);
    let leather = 0.72 * pillow + 0.28 * rise + gathers;
    // The leather of a button is stretched over it and has no crease.
    let tuft = mix(leather, 0.1, (4.0 * button).min(1.0)) + 0.16 * button;
    RELIEF * (tuft + 0.012 * smooth_step(0.0, 0.3, grain(uv)))
}

/// Zero in the furrows between the pebbles of the leather's grain.
fn grain(uv: Vec2) -> f32 {
    let [first, second] = nearest_points(uv, [90, 90], 13);
    second - first
}

/// What shapes the leather at a point.
struct Tuft {
    /// 0 in the creases between buttons, 1 in the middle of a cushion.
    pillow: f32,
    /// 0 at a button, 1 away from it.
    rise: f32,
    /// 1 on top of a button, 0 beside it.
    button: f32,
    /// Small folds that run into a button.
    gathers: f32,
}

impl Tuft {
    fn at(uv: Vec2) -> Self {
        // Axes along the creases: buttons are at whole numbers, a cushion fills the square between four of them.
        let (x, y) = (uv.x * GRID, uv.y * GRID);
        let along = Vec2::new(0.5 * (x + y), 0.5 * (x - y));
        let to_button = along - along.round();
        let arch = |d: f32| 1.0 - 4.0 * d * d;
        let across = along - along.floor() - Vec2::splat(0.5);
        let [p, q] = [arch(across.x), arch(across.y)];
        let r = to_button.length();
        let angle = to_button.y.atan2(to_button.x);
        // The power makes the leather fall steeply into the creases, as if pulled; a fold has no width of its own.
        let pillow = (p * q).max(0.0).powf(0.42);
        let near = (-(r / 0.22).powi(2)).exp() * smooth_step(0.08, 0.14, r);
        Self {
            pillow,
            rise: 1.0 - (1.0 - p) * (1.0 - q),
            button: (1.0 - (r / 0.11).powi(2)).max(0.0).sqrt(),
            gathers: 0.02 * near * (12.0 * angle).cos(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::TriId;

    #[test]
    fn normals_are_unit_point_out_and_are_straight_on_the_whole() {
        let texture = normals().unwrap();
        assert_eq!(texture.size(), (SIZE, SIZE));
        let mut mean = Vec3::ZERO;
        for y in 0..SIZE {
            for x in 0..SIZE {
                let n = 2.0 * texture.texel(x, y) - Vec3::ONE;
                // Bytes round each part by up to 1/255.
                assert!((n.length() - 1.0).abs() < 0.008 && n.z > 0.0, "{n}");
                mean += n / (SIZE * SIZE) as f32;
            }
        }
        assert!(mean.x.abs() < 0.01 && mean.y.abs() < 0.01 && mean.z > 0.8, "{mean}");
    }

    #[test]
    fn green_is_up() {
        // Above the middle of a cushion the leather falls away upwards.
        let middle = Vec2::new(1.0, 0.0) / GRID;
        // A mean over some texels, so that the grain does not count.
        let mean = |at: Vec2| {
            let near =
                (0..64).map(|k| Vec2::new((k % 8) as f32, (k / 8) as f32) / 256.0 - Vec2::splat(1.0 / 64.0));
            near.map(|d| normal(at + d)).sum::<Vec3>() / 64.0
        };
        assert!(mean(middle - 0.12 * Vec2::Y).y > 0.2 && mean(middle + 0.12 * Vec2::Y).y < -0.2);
        assert!(mean(middle + 0.12 * Vec2::X).x > 0.2 && mean(middle - 0.12 * Vec2::X).x < -0.2);
    }

    #[test]
    fn the_leather_tiles() {
        for k in 0..100 {
            let y = k as f32 / 100.0;
            assert!((height(Vec2::new(0.0, y)) - height(Vec2::new(1.0, y))).abs() < 1e-4);
            assert!((height(Vec2::new(y, 0.0)) - height(Vec2::new(y, 1.0))).abs() < 1e-4);
        }
    }

    #[test]
    fn creases_are_darker_than_cushions() {
        let texture = albedo().unwrap();
        let at = |x: f32, y: f32| {
            let around =
                [[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0]].map(|[dx, dy]| Vec2::new(dx, dy) / SIZE as f32);
            around.iter().map(|d| texture.sample(Vec2::new(x, y) / GRID + *d).y).sum::<f32>()
        };
        assert!(at(1.0, 0.0) > 2.0 * at(0.5, 0.5));
        assert!(texture.max().max_element() < 0.6 && texture.texel(3, 5).min_element() > 0.0);
    }

    #[test]
    fn only_the_back_wall_is_upholstered() {
        let (scene, _) = cornell_leather(0).build().unwrap();
        let tris = (0..scene.triangle_count() as u32).map(TriId);
        let leather: Vec<_> = tris.filter(|&t| scene.material(t).name == "leather").collect();
        assert_eq!(leather.len(), 2 * 40 * 40);
        assert!(leather.iter().all(|&t| scene.geometric_normal(t).z < -0.99));
        assert!(scene.material(leather[0]).normal_texture.is_some());
    }
}
