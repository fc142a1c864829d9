//! What the faces of a PLY file look like: colours of vertices and faces, and a texture.

use super::elements::PlyColor;
use crate::image::{TextureCache, TextureKey, read_texture};
use crate::imported::BAKED_COLORS;
use crate::paths::Resolver;
use glam::Vec3;
use lumel_scene::{Encoding, Filter, Material, MaterialId, Texture, TextureRef, Warnings, Wrap};
use ply_rs_bw::ply::Header;
use std::collections::HashMap;
use std::path::Path;

/// The most materials that face colours make. Beyond it, colours are rounded to 32 steps, which make no more.
const MAX_COLORS: usize = 1 << 16;

/// What the comments of a header say.
pub(super) struct Comments<'a> {
    /// Whether lumel has written the file.
    is_own: bool,
    /// Files that `TextureFile` names.
    textures: Vec<&'a str>,
}

impl<'a> Comments<'a> {
    pub(super) fn of(header: &'a Header) -> Self {
        let words = header.comments.iter().map(|comment| comment.trim());
        let texture = |comment: &'a str| {
            let (keyword, name) = comment.split_once(char::is_whitespace)?;
            keyword.eq_ignore_ascii_case("TextureFile").then_some(name.trim())
        };
        let is_own = words.clone().any(|comment| comment.starts_with("lumel "));
        Self { is_own, textures: words.filter_map(texture).collect() }
    }

    /// Whether colours of vertices are light; says so.
    pub(super) fn colors_are_baked(&self, path: &Path, warnings: &mut Warnings) -> bool {
        if self.is_own {
            warnings.push(path.display().to_string(), BAKED_COLORS);
        }
        self.is_own
    }

    /// The texture, if there is one that can be used. `has_uvs`: whether vertices have coordinates.
    pub(super) fn texture(
        &self,
        path: &Path,
        resolver: &Resolver,
        has_uvs: bool,
        warnings: &mut Warnings,
    ) -> (Option<TextureRef>, Vec<Texture>) {
        let mut warn = |message| warnings.push(path.display().to_string(), message);
        let Some((name, others)) = self.textures.split_first() else { return Default::default() };
        if !others.is_empty() {
            warn(format!("of its textures, only {name} is used; left out: {}", others.join(", ")));
        }
        if !has_uvs {
            warn(format!("texture {name} left out: the vertices have no coordinates s and t; export them"));
            return Default::default();
        }
        let mut cache = TextureCache::default();
        let (encoding, wrap, filter) = (Encoding::Srgb, Wrap::Repeat, Filter::Linear);
        let loaded = resolver.resolve(name).map_err(|error| error.to_string()).and_then(|file| {
            let key = TextureKey { source: file.clone(), encoding, wrap_u: wrap, wrap_v: wrap, filter };
            let id = cache.get_or_load(key, |budget| read_texture(&file, encoding, budget));
            id.map_err(|error| error.to_string())
        });
        match loaded {
            Ok(id) => (Some(TextureRef::plain(id)), cache.into_textures()),
            Err(problem) => {
                warn(format!("texture {name} left out: {problem}"));
                Default::default()
            }
        }
    }
}

/// Linear colours; floating-point ones above 1 that are all whole numbers are taken as bytes.
pub(super) fn linear(what: &str, colors: Vec<PlyColor>, path: &Path, warnings: &mut Warnings) -> Vec<Vec3> {
    let largest = colors.iter().map(PlyColor::largest_float).fold(0.0, f32::max);
    if largest <= 1.0 {
        return colors.iter().map(PlyColor::linear).collect();
    }
    let bytes = largest > 2.0;
    let taken = if bytes { "they are taken as sRGB from 0 to 255" } else { "they are clamped to 1" };
    warnings.push(path.display().to_string(), format!("colours of {what} reach {largest}: {taken}"));
    colors.iter().map(|color| if bytes { color.of_bytes().linear() } else { color.linear() }).collect()
}

/// Alphas that say anything: none where all are 1, or where all are 0, which hides the whole file.
pub(super) fn alphas(found: Vec<f32>, path: &Path, warnings: &mut Warnings) -> Vec<f32> {
    // Floating-point alphas that run to 255 are bytes.
    let largest = found.iter().copied().fold(0.0, f32::max);
    let whole = if largest > 2.0 { 255.0 } else { 1.0 };
    if largest <= 0.0 && !found.is_empty() {
        let message = "alpha is 0 at all vertices: it is left out, and the surface is opaque";
        warnings.push(path.display().to_string(), message);
        return Vec::new();
    }
    let says_nothing = found.iter().all(|&alpha| alpha >= whole);
    if says_nothing {
        Vec::new()
    } else {
        found.iter().map(|alpha| (alpha / whole).clamp(0.0, 1.0)).collect()
    }
}

/// The material of each face and all materials: one for each colour, the same for all if there are no colours.
pub(super) fn by_color(
    colors: &[Vec3],
    common: &Material,
    path: &Path,
    warnings: &mut Warnings,
) -> (Vec<MaterialId>, Vec<Material>) {
    let fine = |color: Vec3| (color * 65_535.0).round().to_array().map(|c| c as u32);
    let coarse = |color: Vec3| (color * 31.0).round().to_array().map(|c| c as u32);
    let (ids, materials) = grouped(colors, common, fine, MAX_COLORS);
    if ids.len() == colors.len() {
        return (ids, materials);
    }
    let message = format!("its faces have more than {MAX_COLORS} colours: they are rounded to 32 steps");
    warnings.push(path.display().to_string(), message);
    grouped(colors, common, coarse, usize::MAX)
}

/// As [`by_color`], for colours that have the same key; ends early if there are more than `most`.
fn grouped(
    colors: &[Vec3],
    common: &Material,
    key: impl Fn(Vec3) -> [u32; 3],
    most: usize,
) -> (Vec<MaterialId>, Vec<Material>) {
    let mut known = HashMap::new();
    let (mut ids, mut materials) = (Vec::with_capacity(colors.len()), Vec::new());
    for &color in colors {
        let id = *known.entry(key(color)).or_insert_with(|| {
            let id = MaterialId(materials.len() as u32);
            let name = format!("face colour {}", materials.len());
            materials.push(Material { name, albedo: color, ..common.clone() });
            id
        });
        if materials.len() > most {
            break;
        }
        ids.push(id);
    }
    (ids, materials)
}
