//! Wavefront OBJ, by a reader of our own; docs/decisions/0009 says why.
//!
//! Data flows through three modules: [`statements`] turns lines into flat arrays, [`assemble`] turns those into
//! objects, and [`crate::mtl`] finds the materials they name.

mod assemble;
mod statements;

use crate::imported::{BAKED_COLORS, scene_name};
use crate::mtl::{self, Palette};
use crate::paths::Resolver;
use crate::{ImportError, ImportOptions, Imported};
use lumel_scene::{Material, SceneBuilder, Sides, Warnings};
use std::path::Path;

/// Reads an OBJ file with its material libraries and textures.
///
/// - Each `o` becomes an object, or each `g` in files without `o`; parts of one name are one object. Inside an
///   object, vertices keep the order of the file's `v`.
/// - Faces of files without any `s` are smoothed by angle; elsewhere by their group.
/// - Texture coordinates are flipped, because lumel's have `v` down. Vertex colours are sRGB; those of files that lumel
///   has written are light and left out.
/// - Lines and points are not surfaces and are skipped.
///
/// # Errors
/// Invalid numbers, indices out of range, or no faces.
pub(crate) fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let resolver = Resolver::new(path, options.paths).map_err(ImportError::io(path))?;
    let mut warnings = Warnings::default();
    let file = statements::read(path)?;
    let name = scene_name(path);
    let objects = assemble::objects(&file, path, &name, &mut warnings)?;
    file.skipped.report(path, &mut warnings);
    if file.has_baked_colors {
        warnings.push(path.display().to_string(), BAKED_COLORS);
    }
    let origin = assemble::origin(&file);
    let Palette { mut materials, textures } =
        mtl::palette(path, &resolver, &file.libraries, file.materials.into_names(), &mut warnings);
    if file.sections.iter().any(|section| section.material.is_none()) {
        materials.push(Material { sides: Sides::Shape, ..Material::default() });
    }
    let scene = SceneBuilder { name, origin, objects, materials, textures, ..SceneBuilder::default() };
    Ok(Imported { scene, warnings })
}

#[cfg(test)]
mod tests;
