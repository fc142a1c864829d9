//! Materials of the atrium and the textures they show.

use crate::noise::{clouds, hash, mix, smooth_step, wrapped};
use crate::painting;
use glam::{Vec2, Vec3};
use lumel_scene::{Encoding, Material, MaterialId, Sides, Texture, TextureId, TextureRef};

pub(super) const MASONRY: MaterialId = MaterialId(0);
pub(super) const TRIM: MaterialId = MaterialId(1);
pub(super) const COLUMN: MaterialId = MaterialId(2);
pub(super) const PLASTER: MaterialId = MaterialId(3);
pub(super) const MARBLE: MaterialId = MaterialId(4);
pub(super) const DOOR: MaterialId = MaterialId(5);
pub(super) const ROOF: MaterialId = MaterialId(6);
pub(super) const BANNERS: [MaterialId; 3] = [MaterialId(7), MaterialId(8), MaterialId(9)];

/// Name of a material, its albedo over the texture, the texture.
const MATERIALS: [(&str, Vec3, u32); 10] = [
    ("masonry", Vec3::ONE, 0),
    ("trim", Vec3::ONE, 1),
    ("column", Vec3::new(1.0, 0.97, 0.92), 1),
    ("plaster", Vec3::ONE, 2),
    ("marble", Vec3::ONE, 3),
    ("door", Vec3::ONE, 4),
    ("roof", Vec3::ONE, 5),
    ("red banner", Vec3::new(0.75, 0.06, 0.05), 6),
    ("blue banner", Vec3::new(0.07, 0.14, 0.60), 6),
    ("green banner", Vec3::new(0.06, 0.38, 0.11), 6),
];

pub(super) fn materials() -> Vec<Material> {
    let material = |(name, albedo, texture): (&str, Vec3, u32)| Material {
        albedo_texture: Some(TextureRef::plain(TextureId(texture))),
        sides: if name.ends_with("banner") { Sides::Both } else { Sides::Front },
        ..Material::diffuse(name, albedo)
    };
    MATERIALS.map(material).into()
}

/// The sRGB colour at a texture coordinate.
type Painter = fn(Vec2) -> Vec3;

pub(super) fn textures() -> Vec<Texture> {
    let paintings: [(&str, u32, Painter); 7] = [
        ("masonry", 512, masonry),
        ("limestone", 256, limestone),
        ("plaster", 256, plaster),
        ("marble", 512, marble),
        ("wood", 256, wood),
        ("roof tiles", 256, roof_tiles),
        ("fabric", 256, fabric),
    ];
    let paint = |(name, size, paint)| painting::texture(name, [size; 2], Encoding::Srgb, paint);
    paintings.into_iter().filter_map(paint).collect()
}

/// A wall of cut stone: eight courses of four stones, every other course shifted by half a stone.
fn masonry(uv: Vec2) -> Vec3 {
    let (course, y) = cell(uv.y, 8);
    let (stone, x) = cell(uv.x + 0.125 * (course % 2) as f32, 4);
    let tone = hash(stone, course, 21);
    // Joints are a centimetre wide: stones are 0.7 m by 0.35 m.
    let joint = smooth_step(0.0, 0.012, edge(x)).min(smooth_step(0.0, 0.024, edge(y)));
    let worn = clouds(uv, [8, 8], 22) - 0.5 + 0.4 * (clouds(uv, [64, 64], 23) - 0.5);
    let stone = Vec3::new(0.80, 0.725, 0.61).lerp(Vec3::new(0.84, 0.79, 0.70), tone);
    stone * mix(0.72, 1.0, joint) * (0.94 + 0.06 * tone + 0.14 * worn)
}

/// Pale limestone with faint beds.
fn limestone(uv: Vec2) -> Vec3 {
    let beds = clouds(uv, [3, 16], 31) - 0.5;
    let grain = clouds(uv, [48, 48], 32) - 0.5;
    Vec3::new(0.84, 0.80, 0.72) * (1.0 + 0.10 * beds + 0.08 * grain)
}

/// Lime plaster, brushed on unevenly.
fn plaster(uv: Vec2) -> Vec3 {
    let patches = clouds(uv, [4, 4], 41) - 0.5;
    let strokes = clouds(uv, [12, 40], 42) - 0.5;
    Vec3::new(0.87, 0.835, 0.76) * (1.0 + 0.10 * patches + 0.05 * strokes)
}

/// Two by two polished tiles, cream and rose, with veins that end at the joints.
fn marble(uv: Vec2) -> Vec3 {
    let ((column, x), (row, y)) = (cell(uv.x, 2), cell(uv.y, 2));
    let seed = 50 + 10 * (column + 2 * row);
    let bend = Vec2::new(clouds(uv, [8, 8], seed), clouds(uv, [8, 8], seed + 5));
    let vein = (clouds(uv + 0.25 * bend, [5, 5], seed + 7) - 0.5).abs();
    let veins = 1.0 - smooth_step(0.0, 0.035, vein);
    let (body, line) = if (column + row) % 2 == 0 {
        (Vec3::new(0.83, 0.80, 0.74), Vec3::new(0.68, 0.63, 0.56))
    } else {
        (Vec3::new(0.66, 0.50, 0.43), Vec3::new(0.80, 0.68, 0.60))
    };
    let joint = smooth_step(0.0, 0.008, edge(x).min(edge(y)));
    body.lerp(line, 0.7 * veins) * mix(0.6, 1.0, joint) * (0.96 + 0.08 * bend.x)
}

/// Planks with nailed rails.
fn wood(uv: Vec2) -> Vec3 {
    let (plank, x) = cell(uv.x, 12);
    let (rail, y) = cell(uv.y, 3);
    let fibre = clouds(Vec2::new(uv.x, uv.y + hash(plank, 0, 61)), [48, 2], 62);
    let groove = smooth_step(0.0, 0.07, edge(x));
    let nail = Vec2::new(x - 0.5, 4.0 * (y - 0.5)).length() < 0.13;
    let tone = 0.85 + 0.2 * hash(plank, 1, 61) + 0.02 * hash(rail, 2, 61);
    let wood = Vec3::new(0.43, 0.28, 0.17).lerp(Vec3::new(0.30, 0.18, 0.10), fibre);
    if nail { Vec3::splat(0.2) } else { wood * groove.max(0.4) * tone }
}

/// Rows of rounded terracotta tiles.
fn roof_tiles(uv: Vec2) -> Vec3 {
    let (row, y) = cell(uv.y, 8);
    let (tile, x) = cell(uv.x, 14);
    let arch = (4.0 * x * (1.0 - x)).max(0.0).sqrt();
    let tone = 0.85 + 0.3 * hash(tile, row, 71);
    Vec3::new(0.68, 0.37, 0.26) * mix(0.45, 1.0, arch) * mix(0.7, 1.0, smooth_step(0.0, 0.2, y)) * tone
}

/// Woven cloth with stripes along it and a pale border; coloured by the material.
fn fabric(uv: Vec2) -> Vec3 {
    let (_, x) = cell(uv.x, 5);
    let stripe = mix(0.72, 1.0, smooth_step(0.22, 0.25, edge(x)));
    let border = uv.y.min(1.0 - uv.y).min(uv.x).min(1.0 - uv.x);
    let thread = 0.06 * (hash((uv.x * 256.0) as u32, (uv.y * 256.0) as u32, 81) - 0.5);
    let tone = if (0.03..0.05).contains(&border) { 0.4 } else { stripe };
    Vec3::splat(0.92 * tone + thread)
}

/// Which of `n` cells a coordinate is in, and where in it.
fn cell(coordinate: f32, n: u32) -> (u32, f32) {
    let position = wrapped(coordinate) * n as f32;
    (position as u32 % n, position.fract())
}

/// Distance to the nearer end of the unit interval.
fn edge(x: f32) -> f32 {
    x.min(1.0 - x)
}
