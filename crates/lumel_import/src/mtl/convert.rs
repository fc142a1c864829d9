//! From MTL materials to diffuse ones.

use super::bumps;
use super::map::MapStatement;
use super::statements::MtlMaterial;
use crate::image::{Budget, TextureCache, TextureKey, read_texture};
use crate::paths::Resolver;
use crate::text::name_list;
use glam::{Vec2, Vec3};
use lumel_scene::{
    Encoding, Filter, Material, NormalMap, Radiance, Sides, Texture, TextureId, TextureRef, Transparency,
    Warnings,
};
use std::path::Path;

/// Warnings about single materials beyond this number are only counted: a scene without its textures would
/// cause thousands.
const MOST_WARNINGS: usize = 100;

/// Illumination models of glass.
const GLASS: [u8; 4] = [4, 6, 7, 9];

/// Whether a material is glass that nothing else says how transparent it is.
fn is_glass(mtl: &MtlMaterial) -> bool {
    let is_opaque = mtl.opacity.is_none_or(|opacity| opacity >= 1.0) && mtl.opacity_map.is_none();
    is_opaque && mtl.illumination.is_some_and(|model| GLASS.contains(&model))
}

/// The share of light that passes through glass: `Tf` if it says something, else the colour `Kd`, black being none.
fn glass_color(mtl: &MtlMaterial) -> Vec3 {
    let filter = mtl.filter.filter(|&filter| filter != Vec3::ONE);
    filter.or(mtl.albedo.filter(|&albedo| albedo != Vec3::ZERO)).unwrap_or(Vec3::ONE)
}

/// Converts materials one by one; reports at the end what a diffuse solver ignores.
pub(super) struct Converter<'a> {
    textures: &'a mut TextureCache,
    warnings: &'a mut Warnings,
    n_warnings: usize,
    displaced: Vec<String>,
    glass: Vec<String>,
    shiny: Vec<String>,
}

impl<'a> Converter<'a> {
    pub(super) fn new(textures: &'a mut TextureCache, warnings: &'a mut Warnings) -> Self {
        let (displaced, glass, shiny) = Default::default();
        Self { textures, warnings, n_warnings: 0, displaced, glass, shiny }
    }

    /// The diffuse part of a material.
    ///
    /// A colour multiplies its map. Without a colour, or if it is black, the map is used alone: many
    /// exporters write zero beside a map. Without either, the albedo is 0.5 and there is no emission.
    pub(super) fn material(&mut self, mtl: &MtlMaterial, resolver: &Resolver) -> Material {
        let name = &mtl.name;
        let mut material = Material { name: name.clone(), sides: Sides::Shape, ..Material::default() };
        material.albedo_texture = self.texture(name, mtl.albedo_map.as_ref(), Encoding::Srgb, resolver);
        let albedo = self.factor(name, "Kd", mtl.albedo, material.albedo_texture);
        // A black that stood beside a map which cannot be had was not meant.
        let lost_map = mtl.albedo_map.is_some() && material.albedo_texture.is_none();
        material.albedo = albedo.filter(|a| !(lost_map && *a == Vec3::ZERO)).unwrap_or(material.albedo);
        material.emission_texture = self.texture(name, mtl.emission_map.as_ref(), Encoding::Srgb, resolver);
        let emission = self.factor(name, "Ke", mtl.emission, material.emission_texture);
        material.emission = Radiance(emission.unwrap_or_default());
        material.normal_texture = self.normals(mtl, resolver);
        self.note_what_is_lost(mtl);
        material.transparency = self.alpha(mtl, material.albedo_texture, resolver);
        if is_glass(mtl) && !material.emits() {
            // All that it does not absorb passes.
            material.transparency.transmission = glass_color(mtl);
            material.albedo = Vec3::ZERO;
            self.glass.push(name.clone());
        }
        material
    }

    /// The opacity of a material: `d`, times `map_d`.
    ///
    /// The fourth channel of `map_Kd` counts where the material is transparent anyway: beside a `d` below 1, or where
    /// `map_d` names the same image.
    fn alpha(
        &mut self,
        mtl: &MtlMaterial,
        albedo_texture: Option<TextureRef>,
        resolver: &Resolver,
    ) -> Transparency {
        let opacity = mtl.opacity.map_or(1.0, |opacity| opacity.clamp(0.0, 1.0));
        let has_alpha = |used: &TextureRef| self.textures.get(used.texture).alpha_range() != [1.0; 2];
        let of_albedo = albedo_texture.filter(has_alpha);
        let same_image = |map: &MapStatement| mtl.albedo_map.as_ref().is_some_and(|a| a.file == map.file);
        let texture = match (&mtl.opacity_map, of_albedo) {
            (Some(map), Some(albedo)) if same_image(map) => {
                Some(TextureRef { transform: map.transform(), ..albedo })
            }
            (Some(map), _) => self.opacity_texture(&mtl.name, map, resolver),
            (None, of_albedo) => of_albedo.filter(|_| opacity < 1.0),
        };
        match opacity >= 1.0 && texture.is_none() {
            true => Transparency::default(),
            false => Transparency { texture, ..Transparency::blend(opacity) },
        }
    }

    fn factor(
        &mut self,
        name: &str,
        statement: &str,
        color: Option<Vec3>,
        map: Option<TextureRef>,
    ) -> Option<Vec3> {
        match (color, map) {
            (None, Some(_)) => Some(Vec3::ONE),
            (Some(Vec3::ZERO), Some(_)) => {
                let message = format!("{statement} is 0 beside map_{statement}: the map is used as it is");
                self.warn(name, message);
                Some(Vec3::ONE)
            }
            (color, _) => color,
        }
    }

    fn texture(
        &mut self,
        material: &str,
        map: Option<&MapStatement>,
        encoding: Encoding,
        resolver: &Resolver,
    ) -> Option<TextureRef> {
        let map = map?;
        let loaded = resolver.resolve(&map.file).map_err(|error| error.to_string()).and_then(|path| {
            let (source, filter) = (path.clone(), Filter::Linear);
            let key = TextureKey { source, encoding, wrap_u: map.wrap, wrap_v: map.wrap, filter };
            let texture = self.textures.get_or_load(key, |budget| read_texture(&path, encoding, budget));
            texture.map_err(|error| error.to_string())
        });
        self.bound(material, map, loaded)
    }

    /// `norm`; without it, or if its image cannot be had, what `map_bump` makes of normals. `-bm` is a scale of either.
    fn normals(&mut self, mtl: &MtlMaterial, resolver: &Resolver) -> Option<NormalMap> {
        let scaled = |map: &MapStatement, image| NormalMap { image, scale: Vec2::splat(map.bump) };
        let named = self.texture(&mtl.name, mtl.normal_map.as_ref(), Encoding::Linear, resolver);
        if let (Some(map), Some(image)) = (&mtl.normal_map, named) {
            return Some(scaled(map, image));
        }
        let map = mtl.bump_map.as_ref()?;
        let image = self.derived(&mtl.name, map, resolver, "normals", bumps::into_normals)?;
        Some(scaled(map, image))
    }

    /// An image whose alpha, or if it has none whose brightness, is that of the surface.
    fn opacity_texture(
        &mut self,
        material: &str,
        map: &MapStatement,
        resolver: &Resolver,
    ) -> Option<TextureRef> {
        self.derived(material, map, resolver, "opacity", Texture::into_opacity)
    }

    /// What is made of an image: a texture of its own, beside that of the image as it is.
    fn derived(
        &mut self,
        material: &str,
        map: &MapStatement,
        resolver: &Resolver,
        what: &str,
        make: impl Fn(Texture) -> Texture,
    ) -> Option<TextureRef> {
        let loaded = resolver.resolve(&map.file).map_err(|error| error.to_string()).and_then(|path| {
            // No file inside a file.
            let source = path.join(what);
            let (encoding, filter) = (Encoding::Linear, Filter::Linear);
            let key = TextureKey { source, encoding, wrap_u: map.wrap, wrap_v: map.wrap, filter };
            let load = |budget: &mut Budget| read_texture(&path, encoding, budget).map(&make);
            self.textures.get_or_load(key, load).map_err(|error| error.to_string())
        });
        self.bound(material, map, loaded)
    }

    fn bound(
        &mut self,
        material: &str,
        map: &MapStatement,
        loaded: Result<TextureId, String>,
    ) -> Option<TextureRef> {
        if map.changes_values {
            self.warn(material, format!("option -mm of \"{}\" is ignored", map.file));
        }
        match loaded {
            Ok(texture) => Some(TextureRef { texture, transform: map.transform() }),
            Err(problem) => {
                self.warn(material, format!("going on without a texture: {problem}"));
                None
            }
        }
    }

    fn warn(&mut self, material: &str, message: String) {
        self.n_warnings += 1;
        if self.n_warnings <= MOST_WARNINGS {
            self.warnings.push(format!("material \"{material}\""), message);
        }
    }

    fn note_what_is_lost(&mut self, mtl: &MtlMaterial) {
        if mtl.is_displaced {
            self.displaced.push(mtl.name.clone());
        }
        // From 3 on, illumination models trace rays into mirrors and through glass; 10 is for shadows on photographs.
        if mtl.illumination.is_some_and(|model| (3..10).contains(&model) && !GLASS.contains(&model)) {
            self.shiny.push(mtl.name.clone());
        }
    }

    /// Warns about what was lost, once for all materials.
    pub(super) fn report(self, obj: &Path) {
        if let Some(more @ 1..) = self.n_warnings.checked_sub(MOST_WARNINGS) {
            let message = format!("{more} more warnings about materials");
            self.warnings.push(obj.display().to_string(), message);
        }
        let kinds = [
            (self.displaced, "displacement is ignored, materials"),
            (self.glass, "light passes straight through materials that refract"),
            (self.shiny, "materials that mirror or refract are treated as diffuse"),
        ];
        for (names, what) in kinds {
            if !names.is_empty() {
                self.warnings.push(obj.display().to_string(), format!("{what}: {}", name_list(&names)));
            }
        }
    }
}
