//! Stanford PLY: one mesh of polygons or triangle strips, as text or binary.

mod ascii;
mod elements;
mod header;
mod look;
mod source;

use crate::imported::scene_name;
use crate::paths::Resolver;
use crate::polygon::{CROSSES, MAX_CORNERS, Triangulator};
use crate::tally::Tally;
use crate::{ImportError, ImportOptions, Imported};
use elements::{IndexList, PlyColor, PlyVertex, Skipped};
use glam::{DVec3, Vec3};
use look::Comments;
use lumel_scene::{
    Face, Material, MaterialId, ObjectMesh, SceneBuilder, Sides, Smoothing, TextureRef, Transparency,
    Warnings, origin_for, rounding_of,
};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};
use source::Source;
use std::path::Path;

/// The mark between two strips of a `tristrips` list: -1.
const RESTART: u32 = u32::MAX;

/// Reads a PLY file as one object.
///
/// Vertices keep their order; their alpha is that of the surface. Colours of vertices and faces are the albedo: integers are sRGB, floating-point numbers
/// linear. Without any, the albedo is 0.5. Vertex colours of files that lumel has written are light and left out. The
/// file that a comment `TextureFile` names multiplies them where vertices have texture coordinates; these are flipped,
/// because lumel's have `v` down.
///
/// # Errors
/// A damaged file, indices out of range, or no faces.
pub(crate) fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let resolver = Resolver::new(path, options.paths).map_err(ImportError::io(path))?;
    let mut warnings = Warnings::default();
    let (header, source) = Source::open(path)?;
    let comments = Comments::of(&header);
    let mut file = PlyFile::read(path, &header, source)?;
    file.has_colors &= !(file.has_colors && comments.colors_are_baked(path, &mut warnings));
    file.alphas = look::alphas(file.alphas, path, &mut warnings);
    let (albedo_texture, textures) = comments.texture(path, &resolver, file.has_uvs, &mut warnings);
    let (ids, materials) = file.materials(path, albedo_texture, &mut warnings);
    let mut dropped = Tally::default();
    file.origin = origin_for(file.vertices.iter().map(|vertex| vertex.position));
    let faces = file.triangles(path, &ids, &mut dropped)?;
    if faces.is_empty() {
        return Err(dropped.nothing_left(path));
    }
    dropped.report(path, &mut warnings);
    let objects = vec![file.mesh(path, scene_name(path), faces, &mut warnings)];
    let (name, origin) = (scene_name(path), file.origin);
    let scene = SceneBuilder { name, origin, objects, materials, textures, ..SceneBuilder::default() };
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
    has_face_colors: bool,
    has_uvs: bool,
    /// Of vertices; empty where they are all opaque.
    alphas: Vec<f32>,
    /// Whether coordinates are stored in single precision.
    is_single: bool,
    /// Where the coordinates of the mesh have their zero.
    origin: DVec3,
}

/// Whether an element has all channels of a colour.
fn has_colors(element: &ElementDef) -> bool {
    let has = |names: &[&str; 3]| names.iter().all(|&name| element.properties.contains_key(name));
    PlyColor::NAMES.iter().any(has)
}

impl PlyFile {
    fn read(path: &Path, header: &Header, mut source: Source<'_>) -> Result<Self, ImportError> {
        let mut file = Self::default();
        for element in header.elements.values() {
            match element.name.as_str() {
                "vertex" => {
                    file.note_attributes(path, element)?;
                    file.is_single &= header.encoding != Encoding::Ascii;
                    file.vertices = source.elements(element)?;
                    if elements::ALPHA_NAMES.iter().any(|&name| element.properties.contains_key(name)) {
                        file.alphas = file.vertices.iter().map(|vertex| vertex.alpha).collect();
                    }
                }
                "face" | "tristrips" => {
                    header::check_indices(path, element)?;
                    file.has_face_colors |= element.name == "face" && has_colors(element);
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
        let is_single =
            |name: &str| element.properties[name].data_type == PropertyType::Scalar(ScalarType::Float);
        self.is_single = ["x", "y", "z"].into_iter().any(is_single);
        self.has_normals = has(&["nx", "ny", "nz"]);
        self.has_colors = has_colors(element);
        self.has_uvs = elements::UV_NAMES.iter().any(|names| has(names));
        Ok(())
    }

    /// The material of each face, where faces have colours, and all materials.
    fn materials(
        &self,
        path: &Path,
        albedo_texture: Option<TextureRef>,
        warnings: &mut Warnings,
    ) -> (Vec<MaterialId>, Vec<Material>) {
        let colored = self.has_colors || self.has_face_colors || albedo_texture.is_some();
        let plain = Material { sides: Sides::Shape, ..Material::default() };
        let albedo = if colored { Vec3::ONE } else { plain.albedo };
        let transparency =
            if self.alphas.is_empty() { Transparency::default() } else { Transparency::blend(1.0) };
        let common = Material { albedo, albedo_texture, transparency, ..plain };
        if !self.has_face_colors || self.faces.is_empty() {
            return (Vec::new(), vec![common]);
        }
        if self.has_colors {
            let message = "its vertices and faces have colours: they are multiplied";
            warnings.push(path.display().to_string(), message);
        }
        let colors = self.faces.iter().map(|face| face.color).collect();
        let colors = look::linear("faces", colors, path, warnings);
        let (ids, mut materials) = look::by_color(&colors, &common, path, warnings);
        if !self.strips.is_empty() {
            materials.push(common);
        }
        (ids, materials)
    }

    /// The triangles of faces with these materials, or the first; those of strips have the last.
    fn triangles(
        &self,
        path: &Path,
        ids: &[MaterialId],
        dropped: &mut Tally,
    ) -> Result<Vec<Face>, ImportError> {
        let mut faces = Vec::with_capacity(self.faces.len());
        let mut push = |vertices, material| {
            faces.push(Face { vertices, material, smoothing: Smoothing::Crease });
        };
        let after_last = ids.iter().map(|id| id.0 + 1).max().map_or(MaterialId(0), MaterialId);
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
            outline.extend(list.indices.iter().map(|&index| self.position(index as usize)));
            let material = ids.get(number).copied().unwrap_or(MaterialId(0));
            let place = || format!("face {number}");
            match triangulator.triangulate(&outline) {
                Ok(triangles) => (triangles.iter())
                    .for_each(|t| push(t.map(|corner| list.indices[corner as usize]), material)),
                Err(reason) => dropped.note(reason, place),
            }
            if triangulator.crosses() {
                dropped.note(CROSSES, place);
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
                        push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] }, after_last);
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

    fn position(&self, vertex: usize) -> Vec3 {
        (self.vertices[vertex].position - self.origin).as_vec3()
    }

    /// By how much coordinates were rounded when the file was written, metres.
    fn rounding(&self) -> f64 {
        let largest = self.vertices.iter().map(|v| v.position.abs().max_element()).filter(|c| c.is_finite());
        if self.is_single { rounding_of(largest.fold(0.0, f64::max) as f32) } else { 0.0 }
    }

    fn mesh(&self, path: &Path, name: String, faces: Vec<Face>, warnings: &mut Warnings) -> ObjectMesh {
        fn all<T>(wanted: bool, vertices: &[PlyVertex], attribute: impl Fn(&PlyVertex) -> T) -> Vec<T> {
            if wanted { vertices.iter().map(attribute).collect() } else { Vec::new() }
        }
        ObjectMesh {
            name,
            positions: (0..self.vertices.len()).map(|vertex| self.position(vertex)).collect(),
            normals: all(self.has_normals, &self.vertices, |v| v.normal),
            uvs: all(self.has_uvs, &self.vertices, PlyVertex::uv_down),
            tints: look::linear(
                "vertices",
                all(self.has_colors, &self.vertices, |v| v.color),
                path,
                warnings,
            ),
            alphas: self.alphas.clone(),
            faces,
            rounding: self.rounding(),
            ..ObjectMesh::default()
        }
    }
}

#[cfg(test)]
mod tests;
