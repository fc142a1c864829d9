//! The material library of an OBJ file, and its textures.

use super::name::printable;
use crate::pixels::{largest, opacity_pixels, srgb_pixels};
use crate::{ExportError, write_png};
use glam::{Vec2, Vec3};
use lumel_scene::{
    AlphaMode, Material, MaterialId, Scene, Texture, TextureId, TextureRef, Transparency, UvTransform, Wrap,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// The longest part of a texture's name that its file name keeps, characters.
const MAX_STEM: usize = 40;

/// The materials in use, ready to be written.
pub(super) struct Materials {
    by_id: BTreeMap<MaterialId, Entry>,
    /// File names of the textures they use.
    textures: BTreeMap<TextureId, String>,
    /// File names of the textures whose alpha they use.
    opacities: BTreeMap<TextureId, String>,
    /// Name of the folder they are in.
    folder: String,
}

struct Entry {
    name: String,
    albedo: Vec3,
    albedo_map: Option<Map>,
    emission: Vec3,
    emission_map: Option<Map>,
    /// Glass as the share of it that is not clear.
    opacity: f32,
    opacity_map: Option<Map>,
    /// What texture coordinates go through where the format has no words for it.
    turned: Option<OnSurface>,
}

/// A texture in a statement: `scale * uv + offset`, `v` up.
struct Map {
    texture: TextureId,
    scale: Vec2,
    offset: Vec2,
    clamped: bool,
}

/// How a texture is mapped to the surface.
///
/// Mirrored textures become repeating images of twice the size.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct OnSurface {
    transform: UvTransform,
    doubled: [bool; 2],
}

impl OnSurface {
    fn new(scene: &Scene, texture: TextureRef) -> Self {
        Self { transform: texture.transform, doubled: mirrored(&scene.textures()[texture.texture.index()]) }
    }

    /// The coordinate in the image, `v` down.
    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        self.transform.apply(uv) * self.shrink()
    }

    fn shrink(&self) -> Vec2 {
        let [u, v] = self.doubled.map(|doubled| if doubled { 0.5 } else { 1.0 });
        Vec2::new(u, v)
    }

    fn is_turned(&self) -> bool {
        self.transform.rotation != 0.0
    }
}

fn mirrored(texture: &Texture) -> [bool; 2] {
    [texture.wrap_u, texture.wrap_v].map(|wrap| wrap == Wrap::Mirror)
}

impl Materials {
    /// The materials of these ids, with texture files in a folder of this name.
    pub(super) fn new(scene: &Scene, ids: impl Iterator<Item = MaterialId>, folder: &str) -> Self {
        let (by_id, textures, opacities) = Default::default();
        let mut all = Self { by_id, textures, opacities, folder: folder.to_owned() };
        let mut names = BTreeSet::new();
        for id in ids.collect::<BTreeSet<_>>() {
            let material = &scene.materials()[id.index()];
            let entry = Entry::new(scene, material, unique(&printable(&material.name), &mut names));
            for map in [&entry.albedo_map, &entry.emission_map].into_iter().flatten() {
                let texture = &scene.textures()[map.texture.index()];
                all.textures.entry(map.texture).or_insert_with(|| file_name(texture, map.texture));
            }
            if let Some(Map { texture, .. }) = entry.opacity_map {
                let name = file_name(&scene.textures()[texture.index()], texture);
                all.opacities.entry(texture).or_insert_with(|| format!("opacity_{name}"));
            }
            all.by_id.insert(id, entry);
        }
        all
    }

    /// Its name in the library.
    pub(super) fn name(&self, id: MaterialId) -> &str {
        &self.by_id[&id].name
    }

    /// What texture coordinates of its faces go through, if anything.
    pub(super) fn turned(&self, id: MaterialId) -> Option<OnSurface> {
        self.by_id[&id].turned
    }

    /// Whether any of them has a texture.
    pub(super) fn have_textures(&self) -> bool {
        !(self.textures.is_empty() && self.opacities.is_empty())
    }

    /// Writes the library.
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        for entry in self.by_id.values() {
            writeln!(out, "\nnewmtl {}\nillum 1", entry.name)?;
            self.write_part(out, "Kd", entry.albedo, entry.albedo_map.as_ref())?;
            if entry.emission != Vec3::ZERO {
                self.write_part(out, "Ke", entry.emission, entry.emission_map.as_ref())?;
            }
            if entry.opacity < 1.0 {
                writeln!(out, "d {}", entry.opacity)?;
            }
            if let Some(map) = &entry.opacity_map {
                self.write_map(out, "d", map, &self.opacities[&map.texture])?;
            }
        }
        Ok(())
    }

    fn write_part(&self, out: &mut impl Write, part: &str, color: Vec3, map: Option<&Map>) -> io::Result<()> {
        writeln!(out, "{part} {} {} {}", color.x, color.y, color.z)?;
        match map {
            Some(map) => self.write_map(out, part, map, &self.textures[&map.texture]),
            None => Ok(()),
        }
    }

    fn write_map(&self, out: &mut impl Write, part: &str, map: &Map, file: &str) -> io::Result<()> {
        let Map { scale, offset, clamped, .. } = map;
        write!(out, "map_{part}")?;
        if *scale != Vec2::ONE {
            write!(out, " -s {} {} 1", scale.x, scale.y)?;
        }
        if *offset != Vec2::ZERO {
            write!(out, " -o {} {} 0", offset.x, offset.y)?;
        }
        if *clamped {
            write!(out, " -clamp on")?;
        }
        writeln!(out, " {}/{file}", self.folder)
    }

    /// Writes the images into a folder, which is created if there are any.
    pub(super) fn write_textures(&self, scene: &Scene, folder: &Path) -> Result<(), ExportError> {
        if self.have_textures() {
            create_folder(folder)?;
        }
        for (id, name) in &self.textures {
            let texture = &scene.textures()[id.index()];
            let (width, height, pixels) = picture(texture, srgb_pixels(texture));
            write_png(&folder.join(name), width, height, &pixels, &[])?;
        }
        for (id, name) in &self.opacities {
            let texture = &scene.textures()[id.index()];
            let (width, height, pixels) = picture(texture, opacity_pixels(texture));
            write_png(&folder.join(name), width, height, &pixels, &[])?;
        }
        Ok(())
    }
}

impl Entry {
    fn new(scene: &Scene, material: &Material, name: String) -> Self {
        let on_surface = |texture: &TextureRef| OnSurface::new(scene, *texture);
        // A black factor hides its texture, and readers take one beside a map for an oversight.
        let albedo_texture = material.albedo_texture.filter(|_| material.albedo != Vec3::ZERO);
        let mut emission_texture = material.emission_texture.filter(|_| material.emits());
        let mut surfaces = albedo_texture.iter().chain(&emission_texture).map(on_surface);
        let any_is_turned = surfaces.clone().any(|surface| surface.is_turned());
        let turned = surfaces.next().filter(|_| any_is_turned);
        let brightness = |texture: TextureRef| largest(&scene.textures()[texture.texture.index()]);
        let mut emission = material.emission.0 * emission_texture.map_or(1.0, brightness);
        if let (Some(turned), Some(texture)) = (turned, emission_texture)
            && albedo_texture.is_some()
            && on_surface(&texture) != turned
        {
            emission_texture = None;
            emission = material.emission.0 * scene.textures()[texture.texture.index()].mean();
        }
        let Transparency { mode, alpha, texture, transmission } = material.transparency;
        let alpha = if mode == AlphaMode::Blend { alpha } else { 1.0 };
        let opacity = alpha * (1.0 - transmission.element_sum() / 3.0);
        let opacity_texture = texture.filter(|_| mode != AlphaMode::Opaque);
        let map = |texture: TextureRef| Map::new(scene, texture, turned);
        Self {
            name,
            albedo: material.albedo * albedo_texture.map_or(1.0, brightness),
            albedo_map: albedo_texture.map(map),
            emission,
            emission_map: emission_texture.map(map),
            opacity,
            opacity_map: opacity_texture
                .filter(|t| turned.is_none_or(|turned| on_surface(t) == turned))
                .map(map),
            turned,
        }
    }
}

impl Map {
    fn new(scene: &Scene, texture: TextureRef, turned: Option<OnSurface>) -> Self {
        let image = &scene.textures()[texture.texture.index()];
        let clamped = [image.wrap_u, image.wrap_v] == [Wrap::Clamp; 2];
        let texture_id = texture.texture;
        let on_surface = OnSurface::new(scene, texture);
        // Coordinates of turned textures are those of the picture.
        if turned.is_some() {
            return Self { texture: texture_id, scale: Vec2::ONE, offset: Vec2::ZERO, clamped };
        }
        let scale = on_surface.transform.scale * on_surface.shrink();
        let down = on_surface.transform.offset * on_surface.shrink();
        // Turning both sides of `v' = scale v + down` over, as the importer does the other way.
        let offset = Vec2::new(down.x, 1.0 - scale.y - down.y);
        Self { texture: texture_id, scale, offset, clamped }
    }
}

/// A name that no other material has: libraries are searched by name.
fn unique(name: &str, names: &mut BTreeSet<String>) -> String {
    let name = if name.is_empty() { "material" } else { name };
    let numbered = (2..).map(|n| format!("{name} {n}"));
    let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
    // There are more numbers than materials.
    candidates.find(|candidate| names.insert(candidate.clone())).unwrap_or_default()
}

/// The name of a texture's file, in characters that every program accepts.
fn file_name(texture: &Texture, id: TextureId) -> String {
    let file = texture.name.rsplit(['/', '\\']).next().unwrap_or_default();
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    let plain = stem.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' });
    let plain: String = plain.take(MAX_STEM).collect();
    format!("{}_{plain}.png", id.0)
}

/// Width, height and pixels; twice as many in directions in which the texture is mirrored.
fn picture(texture: &Texture, pixels: Vec<[u8; 3]>) -> (u32, u32, Vec<[u8; 3]>) {
    let (width, height) = texture.size();
    let [twice_u, twice_v] = mirrored(texture);
    let mut rows: Vec<Vec<[u8; 3]>> = pixels.chunks(width as usize).map(<[_]>::to_vec).collect();
    if twice_u {
        rows.iter_mut().for_each(|row| row.extend(row.clone().into_iter().rev()));
    }
    if twice_v {
        rows.extend(rows.clone().into_iter().rev());
    }
    let times = |doubled| 1 + u32::from(doubled);
    (width * times(twice_u), height * times(twice_v), rows.concat())
}

/// Creates a folder unless it exists.
fn create_folder(folder: &Path) -> Result<(), ExportError> {
    match fs::create_dir(folder) {
        Err(error) if !folder.is_dir() => Err(ExportError::io(folder, error)),
        _ => Ok(()),
    }
}
