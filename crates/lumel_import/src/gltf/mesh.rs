//! Meshes in world space.

use super::accessor::{Accessors, Elements};
use super::document::Document;
use super::fault::Fault;
use super::materials::Materials;
use super::nodes::Placed;
use super::topology::{self, triangle_count};
use glam::{DAffine3, DMat3, Mat3, Vec2, Vec3};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use lumel_scene::{Face, ObjectMesh, Smoothing, Warnings};

/// The largest number of triangles of a file. Many nodes may instance one mesh, so a few kilobytes can describe any
/// number.
const MAX_TRIANGLES: u64 = 1 << 27;

/// Each primitive counts as this many additional triangles: it takes time even if it has none.
const PRIMITIVE_COST: u64 = 64;

/// Places meshes at their nodes.
pub(super) struct MeshReader<'a> {
    document: &'a Document,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
}

/// The data of a primitive.
struct Corners<'a> {
    mode: Mode,
    positions: Elements<'a>,
    /// `None` means all vertices in order.
    indices: Option<Elements<'a>>,
}

/// The triangles of a primitive.
struct Shape<'a> {
    positions: Elements<'a>,
    /// The vertices that triangles use, in the order of the file.
    vertices: Vec<u32>,
    /// Indices into `vertices`, counter-clockwise in the mesh's own space.
    triangles: Vec<[u32; 3]>,
}

impl<'a> MeshReader<'a> {
    pub(super) fn new(document: &'a Document, accessors: Accessors<'a>, materials: Materials<'a>) -> Self {
        Self { document, accessors, materials }
    }

    /// The materials in use.
    pub(super) fn into_materials(self) -> Materials<'a> {
        self.materials
    }

    /// The mesh at a node; `None` if it has none, or none with triangles.
    pub(super) fn object_at(
        &mut self,
        placed: Placed,
        warnings: &mut Warnings,
    ) -> Result<Option<ObjectMesh>, Fault> {
        let document = self.document;
        let node = &document.nodes[placed.node];
        let Some(index) = node.mesh.map(|mesh| mesh.value()) else { return Ok(None) };
        let node_label = document.node_label(placed.node);
        let Some(mesh) = document.meshes.get(index) else {
            return Err(Fault::absent(node_label, "mesh", index, document.meshes.len()));
        };
        if node.skin.is_some() {
            warnings.push(&node_label, "skinning is not supported: the mesh is shown in its base pose");
        }
        let instancing =
            |e: &gltf_json::extensions::scene::Node| e.others.contains_key("EXT_mesh_gpu_instancing");
        if node.extensions.as_ref().is_some_and(instancing) {
            warnings.push(&node_label, "EXT_mesh_gpu_instancing is not supported: one instance is shown");
        }
        let weights = node.weights.as_ref().or(mesh.weights.as_ref());
        if weights.is_some_and(|weights| weights.iter().any(|&weight| weight != 0.0)) {
            warnings.push(&node_label, "morph targets are not supported: the mesh is shown in its base form");
        }
        let mesh_label = document.mesh_label(index);
        let names = [&node.name, &mesh.name].into_iter().flatten();
        let name = names.into_iter().find(|name| !name.is_empty()).cloned().unwrap_or(mesh_label.clone());
        let mut object = ObjectMesh { name, ..ObjectMesh::default() };
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("{mesh_label}, primitive {number}");
            if let Some(shape) = self.shape(primitive, &mesh_label, &place, warnings)? {
                self.append(&mut object, primitive, &shape, placed.world, &place, warnings)?;
            }
        }
        Ok(Some(object).filter(|object| !object.faces.is_empty()))
    }

    /// Refuses scenes of excessive size before anything is allocated.
    pub(super) fn check_size(&self, placed: &[Placed]) -> Result<(), Fault> {
        let mut costs = vec![None; self.document.meshes.len()];
        let mut total = 0_u64;
        for node in placed.iter().map(|placed| placed.node) {
            let mesh = self.document.nodes[node].mesh.map(|mesh| mesh.value());
            let Some((mesh, cost)) = mesh.and_then(|mesh| Some((mesh, costs.get_mut(mesh)?))) else {
                continue;
            };
            total = total.saturating_add(match *cost {
                Some(cost) => cost,
                None => *cost.insert(self.cost(mesh)?),
            });
            if total > MAX_TRIANGLES {
                let problem =
                    format!("with it, the scene has more than the {MAX_TRIANGLES} triangles lumel reads");
                return Err(Fault::at(self.document.node_label(node), problem));
            }
        }
        Ok(())
    }

    fn cost(&self, mesh: usize) -> Result<u64, Fault> {
        let label = self.document.mesh_label(mesh);
        let mut cost = 0_u64;
        for (number, primitive) in self.document.meshes[mesh].primitives.iter().enumerate() {
            let corners = self.corners(primitive, &format!("{label}, primitive {number}"))?;
            let triangles = corners.and_then(|corners| triangle_count(corners.mode, corners.count()));
            cost = cost.saturating_add(PRIMITIVE_COST).saturating_add(triangles.unwrap_or(0) as u64);
        }
        Ok(cost)
    }

    /// What a primitive is made of; `None` without positions.
    fn corners(&self, primitive: &Primitive, place: &str) -> Result<Option<Corners<'a>>, Fault> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(Fault::at(place, "its mode is none of 0 to 6"));
        };
        let Some(positions) = self.attribute(primitive, &Semantic::Positions, &[3], None, place)? else {
            return Ok(None);
        };
        let indices = primitive.indices.map(|accessor| {
            let elements = self.accessors.elements(accessor.value(), place)?;
            let problem = format_args!("its indices, accessor {accessor}, are not unsigned integers");
            if elements.are_indices() { Ok(elements) } else { Err(Fault::at(place, problem)) }
        });
        Ok(Some(Corners { mode, positions, indices: indices.transpose()? }))
    }

    /// The triangles of a primitive, none of which leads outside its vertices; `None` if it has no surface.
    fn shape(
        &self,
        primitive: &Primitive,
        mesh: &str,
        place: &str,
        warnings: &mut Warnings,
    ) -> Result<Option<Shape<'a>>, Fault> {
        let Some(corners) = self.corners(primitive, place)? else {
            warnings.push(place, "it has no POSITION and is ignored");
            return Ok(None);
        };
        let Corners { mode, positions, indices } = corners;
        let n_corners = corners.count();
        let Some(n_triangles) = triangle_count(mode, n_corners) else {
            warnings.push(mesh, "its points and lines have no surface and are ignored");
            return Ok(None);
        };
        if mode == Mode::Triangles && n_corners % 3 != 0 {
            warnings.push(place, format!("{n_corners} corners do not make triangles; the last are ignored"));
        }
        let n_vertices = u32::try_from(positions.count())
            .map_err(|_| Fault::at(place, format_args!("it has {} vertices", positions.count())))?;
        let mut list: Vec<u32> = match indices {
            Some(indices) => (0..n_corners).map(|i| indices.index(i)).collect(),
            None => (0..n_vertices).collect(),
        };
        if let Some(&index) = list.iter().find(|&&index| index >= n_vertices) {
            return Err(Fault::at(place, format_args!("refers to vertex {index} of {n_vertices}")));
        }
        let vertices = compact(&mut list, n_vertices);
        let triangles = (0..n_triangles).map(|i| topology::corners(mode, i).map(|corner| list[corner]));
        // Strips turn back by repeating corners: such triangles are meant to have no area.
        let intended = |&[a, b, c]: &[u32; 3]| mode == Mode::Triangles || a != b && b != c && c != a;
        let triangles: Vec<_> = triangles.filter(intended).collect();
        Ok((!triangles.is_empty()).then_some(Shape { positions, vertices, triangles }))
    }

    /// An attribute of a primitive, with one element of one of these `widths` for each of `count` vertices.
    fn attribute(
        &self,
        primitive: &Primitive,
        semantic: &Semantic,
        widths: &[usize],
        count: Option<usize>,
        place: &str,
    ) -> Result<Option<Elements<'a>>, Fault> {
        let Some(accessor) = primitive.attributes.get(&Checked::Valid(semantic.clone())) else {
            return Ok(None);
        };
        let name = semantic.to_string();
        let elements = self.accessors.elements(accessor.value(), &format!("{place}, {name}"))?;
        let problem = match count {
            _ if !widths.contains(&elements.width()) => format!("has {} components", elements.width()),
            Some(count) if count != elements.count() => {
                format!("has {} elements for {count} vertices", elements.count())
            }
            _ => return Ok(Some(elements)),
        };
        Err(Fault::at(place, format_args!("its {name}, accessor {accessor}, {problem}")))
    }

    fn append(
        &mut self,
        object: &mut ObjectMesh,
        primitive: &Primitive,
        shape: &Shape<'a>,
        world: DAffine3,
        place: &str,
        warnings: &mut Warnings,
    ) -> Result<(), Fault> {
        let material = primitive.material.map(|material| material.value());
        let material = self.materials.get(material, place, warnings)?;
        let count = Some(shape.positions.count());
        let normals = self.attribute(primitive, &Semantic::Normals, &[3], count, place)?;
        let uv_set = Semantic::TexCoords(material.uv_set.unwrap_or(0));
        let uvs = self.attribute(primitive, &uv_set, &[2], count, place)?;
        if uvs.is_none() && material.uv_set.is_some() {
            let message =
                format!("it has no {}, for which its material asks: zero is used", uv_set.to_string());
            warnings.push(place, message);
        }
        let colors = self.attribute(primitive, &Semantic::Colors(0), &[3, 4], count, place)?;
        // The specification wants integer colours normalised; where the flag is missing, nothing else makes sense.
        let colors = colors.map(Elements::normalized);

        let vertices = || shape.vertices.iter().map(|&vertex| vertex as usize);
        let first = object.positions.len();
        let to_world = |p: [f32; 3]| world.transform_point3(Vec3::from(p).as_dvec3()).as_vec3();
        object.positions.extend(vertices().map(|v| to_world(shape.positions.vector(v))));
        let end = object.positions.len();
        let turn = normal_matrix(world.matrix3);
        let normals_given = normals.is_some();
        let normals = normals.map(|n| vertices().map(move |v| turn * Vec3::from(n.vector::<3>(v))));
        fill(&mut object.normals, first, end, Vec3::ZERO, normals);
        let uvs = uvs.map(|uvs| vertices().map(move |v| Vec2::from(uvs.vector::<2>(v))));
        fill(&mut object.uvs, first, end, Vec2::ZERO, uvs);
        let tints = colors
            .map(|c| vertices().map(move |v| Vec3::from(c.vector::<3>(v)).clamp(Vec3::ZERO, Vec3::ONE)));
        fill(&mut object.tints, first, end, Vec3::ONE, tints);

        // A mirrored mesh shows its other side unless its corners run the other way.
        let mirrored = world.matrix3.determinant() < 0.0;
        // The specification asks for flat normals where there are none.
        let smoothing = if normals_given { Smoothing::default() } else { Smoothing::Flat };
        object.faces.extend(shape.triangles.iter().map(|&[a, b, c]| {
            let vertices = if mirrored { [a, c, b] } else { [a, b, c] };
            Face { vertices: vertices.map(|v| v + first as u32), material: material.id, smoothing }
        }));
        Ok(())
    }
}

impl Corners<'_> {
    fn count(&self) -> usize {
        self.indices.as_ref().unwrap_or(&self.positions).count()
    }
}

/// Replaces indices into all `n` vertices by indices into those that are used, and returns these.
fn compact(indices: &mut [u32], n: u32) -> Vec<u32> {
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    if used.len() < n as usize {
        for index in indices {
            // Every index is in `used`, so both arms are its place there.
            *index = used.binary_search(index).unwrap_or_else(|place| place) as u32;
        }
    }
    used
}

/// Appends a part's values to a list that is empty or as long as `first`, and stays empty or gets as long as `end`.
fn fill<T: Copy>(
    list: &mut Vec<T>,
    first: usize,
    end: usize,
    absent: T,
    values: Option<impl Iterator<Item = T>>,
) {
    match values {
        Some(values) => {
            list.resize(first, absent);
            list.extend(values);
        }
        None if list.is_empty() => {}
        None => list.resize(end, absent),
    }
}

/// The transform of normals to world space: the inverse transpose up to a positive factor.
///
/// The matrix of cofactors is the inverse transpose times the determinant; it exists for flat shapes too, where one
/// scale is zero. Its largest element is made 1, so that tiny and huge scales stay within f32.
fn normal_matrix(m: DMat3) -> Mat3 {
    let cofactors =
        DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let largest = cofactors.to_cols_array().into_iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let scale = if largest > 0.0 { sign / largest } else { 1.0 };
    (cofactors * scale).as_mat3()
}

#[cfg(test)]
mod tests;
