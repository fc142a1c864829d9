//! glTF 2.0 and GLB.
//!
//! Bytes become parts ([`container`]), a typed document ([`document`]) and checked data ([`buffers`], [`accessor`]);
//! everything else works on nodes, placed relative to the scene's origin: [`nodes`], [`mesh`] with [`morph`], [`skin`] and [`instances`],
//! [`materials`], [`lights`]. What is animated is read as the file shows it at rest.
//!
//! Parts of a document are checked when they are used: a broken part that is not used does no harm. Broken geometry is
//! an error; broken appearance is a warning.
//!
//! Khronos Group, *glTF 2.0 Specification*, version 2.0.1.

mod accessor;
mod buffers;
mod compression;
mod container;
#[cfg(test)]
mod damage;
mod document;
mod extensions;
mod fault;
mod instances;
mod lights;
mod materials;
mod mesh;
mod morph;
mod nodes;
mod own;
mod part;
mod pose;
mod skin;
mod specular_glossiness;
#[cfg(test)]
mod testing;
mod textures;
mod topology;
mod uri;

use crate::imported::scene_name;
use crate::paths::Resolver;
use crate::{ImportError, ImportOptions, Imported};
use accessor::Accessors;
use buffers::Buffers;
use container::Container;
use document::Document;
use fault::Fault;
use glam::DVec3;
use lumel_scene::{SceneBuilder, Warnings, origin_for};
use materials::Materials;
use mesh::MeshReader;
use std::path::Path;
use textures::Textures;

/// Reads a glTF 2.0 file, text or binary.
///
/// Units are not converted: candela, lux and cd/m² in the file give lux in the result.
pub(crate) fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let bytes = std::fs::read(path).map_err(ImportError::io(path))?;
    let resolver = Resolver::new(path, options.paths).map_err(ImportError::io(path))?;
    let mut imported = read(&bytes, &resolver, DVec3::ZERO).map_err(|fault| fault.in_file(path))?;
    let positions = imported.scene.objects.iter().flat_map(|object| &object.positions);
    let origin = origin_for(positions.map(|p| p.as_dvec3()));
    if origin != DVec3::ZERO {
        // Now that it is known where it stands, all of it again with the digits that it has.
        imported = read(&bytes, &resolver, origin).map_err(|fault| fault.in_file(path))?;
    }
    if imported.scene.objects.is_empty() {
        return Err(ImportError::Empty { path: path.to_owned() });
    }
    imported.scene.name = scene_name(path);
    Ok(imported)
}

/// Reads a scene whose coordinates have their zero at `origin`.
fn read(bytes: &[u8], resolver: &Resolver, origin: DVec3) -> Result<Imported, Fault> {
    let mut warnings = Warnings::default();
    let container = Container::open(bytes)?;
    let document = Document::parse(container.json, &mut warnings)?;
    let buffers = Buffers::new(&document, container.bin, resolver);
    let materials = Materials::new(&document, Textures::new(&document, &buffers, resolver));
    let mut meshes = MeshReader::new(&document, Accessors::new(&document, &buffers), materials);
    let mut scene = SceneBuilder { origin, ..SceneBuilder::default() };
    let mut nodes = nodes::place_all(&document, origin, &mut warnings)?;
    let shown: Vec<_> = nodes.placed.iter().filter(|placed| placed.visible).copied().collect();
    meshes.check_size(&shown)?;
    for placed in shown {
        scene.objects.extend(meshes.objects_at(placed, &mut nodes, &mut warnings)?);
        if let Some((name, light)) = lights::light_at(&document, placed, &mut warnings)? {
            scene.add_named_light(name, light);
        }
    }
    for &placed in &nodes.placed {
        scene.cameras.extend(lights::camera_at(&document, placed, &mut warnings)?);
    }
    (scene.materials, scene.textures) = meshes.into_materials().finish(&mut warnings);
    Ok(Imported { scene, warnings })
}
