//! Stanford PLY: one mesh of polygons or triangle strips, as text or binary.

mod ascii;
mod elements;
mod header;
mod source;

use crate::imported::scene_name;
use crate::polygon::{MAX_CORNERS, NO_AREA, TOO_FEW_CORNERS, Triangulator};
use crate::tally::Tally;
use crate::{ImportError, Imported};
use elements::{IndexList, PlyVertex, Skipped};
use lumel_scene::{Face, Material, MaterialId, ObjectMesh, SceneBuilder, Smoothing, Warnings};
use ply_rs_bw::ply::ElementDef;
use source::Source;
use std::path::Path;

/// The mark between two strips of a `tristrips` list: -1.
const RESTART: u32 = u32::MAX;

/// Reads a PLY file as one object of the default material.
///
/// Vertices keep their order. Colours of integer type are taken as sRGB, floating-point ones as linear; texture
/// coordinates are flipped, because lumel's have `v` down.
///
/// # Errors
/// A damaged file, indices out of range, or no faces.
pub(crate) fn load(path: &Path) -> Result<Imported, ImportError> {
    let file = PlyFile::read(path)?;
    let mut dropped = Tally::default();
    let faces = file.triangles(path, &mut dropped)?;
    if faces.is_empty() {
        return Err(ImportError::Empty { path: path.to_owned() });
    }
    let mut warnings = Warnings::default();
    dropped.report(path, &mut warnings);
    let scene = SceneBuilder {
        name: scene_name(path),
        objects: vec![file.mesh(scene_name(path), faces)],
        materials: vec![Material::default()],
        ..SceneBuilder::default()
    };
    Ok(Imported { scene, warnings })
}

/// The known elements of a file.
#[derive(Default)]
struct PlyFile {
    vertices: Vec<PlyVertex>,
    faces: Vec<IndexList>,
    strips: Vec<IndexList>,
    has_normals: bool,
    has_colors: bool,
    has_uvs: bool,
}

impl PlyFile {
    fn read(path: &Path) -> Result<Self, ImportError> {
        let (header, mut source) = Source::open(path)?;
        let mut file = Self::default();
        for element in header.elements.values() {
            match element.name.as_str() {
                "vertex" => {
                    file.note_attributes(path, element)?;
                    file.vertices = source.elements(element)?;
                }
                "face" | "tristrips" => {
                    header::check_indices(path, element)?;
                    let lists = source.elements(element)?;
                    *(if element.name == "face" { &mut file.faces } else { &mut file.strips }) = lists;
                }
                _ => {
                    source.elements::<Skipped>(element)?;
                }
            }
        }
        Ok(file)
    }

    fn note_attributes(&mut self, path: &Path, element: &ElementDef) -> Result<(), ImportError> {
        let has = |names: &[&str]| names.iter().all(|&name| element.properties.contains_key(name));
        if !has(&["x", "y", "z"]) {
            return Err(ImportError::malformed(path, "the vertices have no x, y and z"));
        }
        self.has_normals = has(&["nx", "ny", "nz"]);
        self.has_colors = has(&["red", "green", "blue"]);
        self.has_uvs = elements::UV_NAMES.iter().any(|names| has(names));
        Ok(())
    }

    fn triangles(&self, path: &Path, dropped: &mut Tally) -> Result<Vec<Face>, ImportError> {
        let mut faces = Vec::with_capacity(self.faces.len());
        let mut push = |vertices| {
            faces.push(Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease });
        };
        let mut triangulator = Triangulator::new();
        let mut outline = Vec::new();
        for (number, list) in self.faces.iter().enumerate() {
            self.check_range(path, "face", number, &list.indices, |_| false)?;
            let n = list.indices.len();
            if n > MAX_CORNERS {
                let message = format!("face {number} has {n} corners, more than {MAX_CORNERS}; split it");
                return Err(ImportError::malformed(path, message));
            }
            outline.clear();
            outline.extend(list.indices.iter().map(|&index| self.vertices[index as usize].position));
            match triangulator.triangulate(&outline) {
                Some(triangles) => {
                    triangles.iter().for_each(|t| push(t.map(|corner| list.indices[corner as usize])));
                }
                None => {
                    let what = if n < 3 { TOO_FEW_CORNERS } else { NO_AREA };
                    dropped.note(what, || format!("face {number}"));
                }
            }
        }
        for (number, list) in self.strips.iter().enumerate() {
            self.check_range(path, "strip", number, &list.indices, |index| index == RESTART)?;
            for strip in list.indices.split(|&index| index == RESTART) {
                for (i, triangle) in strip.windows(3).enumerate() {
                    // Every other triangle of a strip is wound backwards.
                    let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                    // Repeated corners steer the strip and are no triangles.
                    if a != b && b != c && c != a {
                        push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    }
                }
            }
        }
        Ok(faces)
    }

    fn check_range(
        &self,
        path: &Path,
        what: &str,
        number: usize,
        indices: &[u32],
        is_mark: impl Fn(u32) -> bool,
    ) -> Result<(), ImportError> {
        let count = self.vertices.len();
        match indices.iter().find(|&&index| index as usize >= count && !is_mark(index)) {
            None => Ok(()),
            Some(&index) => {
                // Negative indices arrive here as large ones.
                let index = if index > i32::MAX as u32 { i64::from(index as i32) } else { i64::from(index) };
                let message = format!("{what} {number} refers to vertex {index} of {count}, counted from 0");
                Err(ImportError::malformed(path, message))
            }
        }
    }

    fn mesh(&self, name: String, faces: Vec<Face>) -> ObjectMesh {
        fn all<T>(wanted: bool, vertices: &[PlyVertex], attribute: impl Fn(&PlyVertex) -> T) -> Vec<T> {
            if wanted { vertices.iter().map(attribute).collect() } else { Vec::new() }
        }
        ObjectMesh {
            name,
            positions: all(true, &self.vertices, |v| v.position),
            normals: all(self.has_normals, &self.vertices, |v| v.normal),
            uvs: all(self.has_uvs, &self.vertices, PlyVertex::uv_down),
            tints: all(self.has_colors, &self.vertices, PlyVertex::tint),
            faces,
        }
    }
}

#[cfg(test)]
mod tests;
