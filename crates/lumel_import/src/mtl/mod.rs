//! MTL material libraries: diffuse albedo, emission, normal and height maps, and warnings about the rest.
//!
//! Libraries are optional: problems are warnings, and missing materials have an albedo of 0.5.

mod bumps;
mod convert;
mod map;
mod statements;

use crate::image::TextureCache;
use crate::paths::{PathError, Resolver};
use crate::text::{decode, name_list};
use lumel_scene::{Material, Sides, Texture, Warnings};
use statements::MtlMaterial;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// More names than this on one `mtllib` line, and they are not joined into names with blanks.
const MAX_JOINED: usize = 16;

/// Materials and the textures they use.
pub(crate) struct Palette {
    /// One for each requested name.
    pub(crate) materials: Vec<Material>,
    /// What the materials refer to.
    pub(crate) textures: Vec<Texture>,
}

/// The materials of the given names, from the libraries that the statements at `(line, arguments)` name.
///
/// If several libraries define a material, the first definition is used.
pub(crate) fn palette(
    obj: &Path,
    resolver: &Resolver,
    libraries: &[(usize, Vec<u8>)],
    names: Vec<String>,
    warnings: &mut Warnings,
) -> Palette {
    let mut defined: HashMap<String, (MtlMaterial, Resolver)> = HashMap::new();
    for path in library_files(obj, resolver, libraries, warnings) {
        match statements::read(&path, warnings) {
            Ok(materials) => {
                for material in materials {
                    let beside = || (material.clone(), resolver.beside(&path));
                    defined.entry(material.name.clone()).or_insert_with(beside);
                }
            }
            Err(error) => warnings.push(obj.display().to_string(), with_cause(&error)),
        }
    }
    let mut textures = TextureCache::default();
    let mut converter = convert::Converter::new(&mut textures, warnings);
    let mut unknown = Vec::new();
    let mut materials = Vec::with_capacity(names.len());
    for name in names {
        materials.push(match defined.get(&name) {
            Some((material, resolver)) => converter.material(material, resolver),
            None => {
                unknown.push(name.clone());
                Material { name, sides: Sides::Shape, ..Material::default() }
            }
        });
    }
    converter.report(obj);
    if !unknown.is_empty() {
        let message =
            format!("half-grey stands in for materials that no library has: {}", name_list(&unknown));
        warnings.push(obj.display().to_string(), message);
    }
    Palette { materials, textures: textures.into_textures() }
}

/// The library files that exist, each once.
fn library_files(
    obj: &Path,
    resolver: &Resolver,
    statements: &[(usize, Vec<u8>)],
    warnings: &mut Warnings,
) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut known: HashSet<PathBuf> = HashSet::new();
    let mut asked: HashSet<&[u8]> = HashSet::new();
    let mut missing = Vec::new();
    for (_, arguments) in statements {
        if asked.insert(arguments) {
            find_libraries(arguments, resolver, &mut missing, |path| {
                if known.insert(path.clone()) {
                    files.push(path);
                }
            });
        }
    }
    if let [first, rest @ ..] = missing.as_slice() {
        let more = if rest.is_empty() { String::new() } else { format!(" (and {} more)", rest.len()) };
        warnings.push(obj.display().to_string(), format!("material library {first}{more}; going on without"));
    }
    files
}

/// Finds the files that one `mtllib` statement names: all of it as one name, else from each word on the longest run
/// of words that names a file.
fn find_libraries(
    arguments: &[u8],
    resolver: &Resolver,
    missing: &mut Vec<PathError>,
    mut found: impl FnMut(PathBuf),
) {
    let text = decode(arguments);
    let mut rest = text.trim();
    while !rest.is_empty() {
        // Ends of the first words, the longest run first.
        let ends = rest.char_indices().filter(|(i, c)| *i > 0 && c.is_whitespace()).map(|(i, _)| i);
        let mut ends: Vec<usize> = ends.take(MAX_JOINED).collect();
        let first_end = ends.first().copied().unwrap_or(rest.len());
        if ends.len() < MAX_JOINED {
            ends.push(rest.len());
        }
        let named = ends.iter().rev().find_map(|&end| Some((end, resolver.resolve(&rest[..end]).ok()?)));
        let end = match named {
            Some((end, path)) => {
                found(path);
                end
            }
            None => {
                missing.extend(resolver.resolve(&rest[..first_end]).err());
                first_end
            }
        };
        rest = rest[end..].trim_start();
    }
}

/// An error and what caused it, in one line.
fn with_cause(error: &dyn std::error::Error) -> String {
    error.source().map_or_else(|| error.to_string(), |cause| format!("{error}: {cause}"))
}

#[cfg(test)]
mod tests;
