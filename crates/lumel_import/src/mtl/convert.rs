//! From MTL materials to diffuse ones.

use super::map::MapStatement;
use super::statements::MtlMaterial;
use crate::image::{TextureCache, TextureKey, read_texture};
use crate::paths::Resolver;
use crate::text::name_list;
use glam::Vec3;
use lumel_scene::{Encoding, Filter, Material, Radiance, TextureRef, Warnings};
use std::path::Path;

/// Warnings about single materials beyond this number are only counted: a scene without its textures would
/// cause thousands.
const MOST_WARNINGS: usize = 100;

/// Converts materials one by one; reports at the end what a diffuse solver ignores.
pub(super) struct Converter<'a> {
    textures: &'a mut TextureCache,
    warnings: &'a mut Warnings,
    n_warnings: usize,
    height_maps: Vec<String>,
    transparent: Vec<String>,
    shiny: Vec<String>,
}

impl<'a> Converter<'a> {
    pub(super) fn new(textures: &'a mut TextureCache, warnings: &'a mut Warnings) -> Self {
        let (height_maps, transparent, shiny) = Default::default();
        Self { textures, warnings, n_warnings: 0, height_maps, transparent, shiny }
    }

    /// The diffuse part of a material.
    ///
    /// A colour multiplies its map. Without a colour, or if it is black, the map is used alone: many
    /// exporters write zero beside a map. Without either, the albedo is 0.5 and there is no emission.
    pub(super) fn material(&mut self, mtl: &MtlMaterial, resolver: &Resolver) -> Material {
        let name = &mtl.name;
        let mut material = Material { name: name.clone(), ..Material::default() };
        material.albedo_texture = self.texture(name, mtl.albedo_map.as_ref(), Encoding::Srgb, resolver);
        let albedo = self.factor(name, "Kd", mtl.albedo, material.albedo_texture);
        // A black that stood beside a map which cannot be had was not meant.
        let lost_map = mtl.albedo_map.is_some() && material.albedo_texture.is_none();
        material.albedo = albedo.filter(|a| !(lost_map && *a == Vec3::ZERO)).unwrap_or(material.albedo);
        material.emission_texture = self.texture(name, mtl.emission_map.as_ref(), Encoding::Srgb, resolver);
        let emission = self.factor(name, "Ke", mtl.emission, material.emission_texture);
        material.emission = Radiance(emission.unwrap_or_default());
        material.normal_texture = self.texture(name, mtl.normal_map.as_ref(), Encoding::Linear, resolver);
        self.note_what_is_lost(mtl);
        material
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
        if mtl.has_height_map {
            self.height_maps.push(mtl.name.clone());
        }
        if mtl.opacity.is_some_and(|opacity| opacity < 1.0) || mtl.has_opacity_map {
            self.transparent.push(mtl.name.clone());
        }
        // From 3 on, illumination models trace rays into mirrors and through glass; 10 is for shadows on photographs.
        if mtl.illumination.is_some_and(|model| (3..10).contains(&model)) {
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
            (self.height_maps, "height maps are ignored (a normal map is named by norm), materials"),
            (self.transparent, "transparent materials are treated as opaque"),
            (self.shiny, "materials that mirror or refract are treated as diffuse"),
        ];
        for (names, what) in kinds {
            if !names.is_empty() {
                self.warnings.push(obj.display().to_string(), format!("{what}: {}", name_list(&names)));
            }
        }
    }
}
