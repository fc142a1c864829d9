//! From flat arrays to objects.

use super::statements::{Corner, ObjFile, Section};
use crate::ImportError;
use crate::color::linear_from_srgb;
use crate::polygon::{CROSSES, MAX_CORNERS, Triangulator};
use crate::tally::Tally;
use glam::{DVec3, Vec2, Vec3};
use lumel_scene::{Face, MaterialId, ObjectMesh, Smoothing, Warnings, origin_for};
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

const ABSENT_NORMALS: &str = "faces refer to normals that the file lacks; they are made instead";

/// Where the coordinates of a file's objects have their zero, metres: vertices that no face uses do not count.
pub(super) fn origin(file: &ObjFile) -> DVec3 {
    origin_for(file.corners.iter().filter_map(|corner| file.positions.get(corner.position as usize)).copied())
}

/// The objects of a file, in the order of their first faces, relative to its origin. `default_name` is for faces outside
/// any object.
///
/// Material ids are those of the file's names; faces without `usemtl` get the id after the last.
///
/// # Errors
/// Indices out of range, or no faces.
pub(super) fn objects(
    file: &ObjFile,
    path: &Path,
    default_name: &str,
    warnings: &mut Warnings,
) -> Result<Vec<ObjectMesh>, ImportError> {
    let mut assembler = Assembler {
        file,
        origin: origin(file),
        path,
        triangulator: Triangulator::new(),
        oddities: Tally::default(),
    };
    let objects: Result<Vec<_>, _> =
        parts(file, default_name).into_iter().map(|part| assembler.object(&part)).collect();
    if let Ok(objects) = &objects
        && objects.iter().all(|object| object.faces.is_empty())
    {
        return Err(assembler.oddities.nothing_left(path));
    }
    assembler.oddities.report(path, warnings);
    if file.colors.iter().any(|color| color.max_element() > 1.0) {
        let message = "vertex colours above 1 are clamped: they must run from 0 to 1";
        warnings.push(path.display().to_string(), message);
    }
    objects
}

/// An object under construction.
struct Part<'a> {
    name: &'a str,
    sections: Vec<(Section, Range<usize>)>,
}

/// Sections by the object they belong to.
fn parts<'a>(file: &'a ObjFile, default_name: &'a str) -> Vec<Part<'a>> {
    let has_objects = file.sections.iter().any(|section| section.object.is_some());
    let mut parts: Vec<Part<'_>> = Vec::new();
    let mut known: HashMap<Option<u32>, usize> = HashMap::new();
    for (i, section) in file.sections.iter().enumerate() {
        let end = file.sections.get(i + 1).map_or(file.faces.len(), |next| next.first_face);
        let key = if has_objects { section.object } else { section.group };
        let part = *known.entry(key).or_insert_with(|| {
            let name = key.map(|index| file.names.name(index)).filter(|name| !name.is_empty());
            parts.push(Part { name: name.unwrap_or(default_name), sections: Vec::new() });
            parts.len() - 1
        });
        parts[part].sections.push((*section, section.first_face..end));
    }
    parts
}

struct Assembler<'a> {
    file: &'a ObjFile,
    origin: DVec3,
    path: &'a Path,
    triangulator: Triangulator,
    oddities: Tally,
}

impl<'a> Assembler<'a> {
    fn object(&mut self, part: &Part<'_>) -> Result<ObjectMesh, ImportError> {
        let file = self.file;
        let mut vertices = VertexTable::default();
        let mut faces = Vec::new();
        let mut outline = Vec::new();
        for (section, range) in &part.sections {
            let material = MaterialId(section.material.unwrap_or(file.materials.len()));
            let unsmoothed = if file.has_smoothing { Smoothing::Flat } else { Smoothing::Crease };
            let smoothing = section.smoothing.unwrap_or(unsmoothed);
            for index in range.clone() {
                let line = file.faces[index].line;
                let corners = self.corners(index, part.name)?;
                outline.clear();
                outline.extend(corners.iter().map(|corner| self.position(corner)));
                if corners.iter().any(|c| c.normal != Corner::NONE && c.normal as usize >= file.normals.len())
                {
                    // Files stripped of their normals but not of the references to them are common.
                    self.oddities.note(ABSENT_NORMALS, || format!("line {line}, object \"{}\"", part.name));
                }
                let place = || format!("line {line}, object \"{}\"", part.name);
                match self.triangulator.triangulate(&outline) {
                    Ok(triangles) => faces.extend(triangles.iter().map(|triangle| {
                        let vertices = triangle.map(|i| vertices.index(corners[i as usize]));
                        Face { vertices, material, smoothing }
                    })),
                    Err(reason) => self.oddities.note(reason, place),
                }
                if self.triangulator.crosses() {
                    self.oddities.note(CROSSES, place);
                }
            }
        }
        Ok(self.mesh(part.name, vertices, faces))
    }

    fn position(&self, corner: &Corner) -> Vec3 {
        (self.file.positions[corner.position as usize] - self.origin).as_vec3()
    }

    /// The corners of a face, their positions and texture coordinates checked.
    fn corners(&self, face: usize, object: &str) -> Result<&'a [Corner], ImportError> {
        let file = self.file;
        let start = face.checked_sub(1).map_or(0, |previous| file.faces[previous].corners_end);
        let corners = &file.corners[start..file.faces[face].corners_end];
        let fail = |message| Err(ImportError::at_line(self.path, file.faces[face].line, message));
        if corners.len() > MAX_CORNERS {
            let n = corners.len();
            return fail(format!(
                "face has {n} corners, more than {MAX_CORNERS}; split it, object \"{object}\""
            ));
        }
        for corner in corners {
            let references = [
                ("vertex", corner.position, file.positions.len()),
                ("texture coordinate", corner.uv, file.uvs.len()),
            ];
            for (what, index, count) in references {
                if index != Corner::NONE && index as usize >= count {
                    let number = u64::from(index) + 1;
                    return fail(format!("face refers to {what} {number} of {count}, object \"{object}\""));
                }
            }
        }
        Ok(corners)
    }

    fn mesh(&self, name: &str, vertices: VertexTable, mut faces: Vec<Face>) -> ObjectMesh {
        let file = self.file;
        let (corners, new_index) = vertices.in_file_order();
        for face in &mut faces {
            face.vertices = face.vertices.map(|old| new_index[old as usize]);
        }
        let uv = |corner: &Corner| match file.uvs.get(corner.uv as usize) {
            Some(uv) => Vec2::new(uv.x, 1.0 - uv.y),
            None => Vec2::ZERO,
        };
        let normal =
            |corner: &Corner| file.normals.get(corner.normal as usize).copied().unwrap_or(Vec3::ZERO);
        let tint = |corner: &Corner| {
            let color = file.colors.get(corner.position as usize).copied().unwrap_or(Vec3::ONE);
            linear_from_srgb(color.clamp(Vec3::ZERO, Vec3::ONE))
        };
        let has_uvs = corners.iter().any(|corner| corner.uv != Corner::NONE);
        let has_normals = corners.iter().any(|corner| corner.normal != Corner::NONE);
        let positions = corners.iter().map(|corner| self.position(corner)).collect();
        ObjectMesh {
            name: name.to_owned(),
            positions,
            normals: if has_normals { corners.iter().map(normal).collect() } else { Vec::new() },
            uvs: if has_uvs { corners.iter().map(uv).collect() } else { Vec::new() },
            tints: if file.colors.is_empty() { Vec::new() } else { corners.iter().map(tint).collect() },
            faces,
            ..ObjectMesh::default()
        }
    }
}

/// The distinct corners of an object in the order of their first use.
#[derive(Default)]
struct VertexTable {
    corners: Vec<Corner>,
    indices: HashMap<Corner, u32>,
}

impl VertexTable {
    fn index(&mut self, corner: Corner) -> u32 {
        *self.indices.entry(corner).or_insert_with(|| {
            self.corners.push(corner);
            self.corners.len() as u32 - 1
        })
    }

    /// The corners in the order of the file's positions, those of one position by first use, and the new index for
    /// each old one.
    fn in_file_order(self) -> (Vec<Corner>, Vec<u32>) {
        let mut order: Vec<u32> = (0..self.corners.len() as u32).collect();
        order.sort_by_key(|&old| self.corners[old as usize].position);
        let mut new_index = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            new_index[old as usize] = new as u32;
        }
        (order.iter().map(|&old| self.corners[old as usize]).collect(), new_index)
    }
}
