//! Meshes in the world.

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

/// The most triangles one file may make. Many nodes may show one mesh, so a few kilobytes can ask for any number.
const MAX_TRIANGLES: u64 = 1 << 27;

/// A primitive counts as this many triangles more: it takes time even if it has none.
const PRIMITIVE_COST: u64 = 64;

/// Puts meshes where their nodes are.
pub(super) struct MeshReader<'a> {
    document: &'a Document,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
}

/// What a primitive is made of.
struct Corners<'a> {
    mode: Mode,
    positions: Elements<'a>,
    /// `None` stands for all vertices in their order.
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

    /// The materials that meshes turned out to use.
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

    /// Refuses scenes of absurd size before anything is allocated for them.
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

/// What takes normals to the world: the inverse transpose, but for a positive factor.
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
mod tests {
    use super::*;
    use crate::gltf::testing::{Model, U8, U16, U32, facing, text};
    use serde_json::{Value, json};

    /// A square of four corners in z = 0, drawn in this mode and order.
    fn square(mode: u32, indices: &[u16]) -> Model {
        let mut model = Model::triangle();
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
        let positions = model.floats("VEC3", &corners);
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let indices = model.accessor(U16, "SCALAR", indices.len() as u64, &bytes);
        *model.primitive() =
            json!({ "attributes": { "POSITION": positions }, "indices": indices, "mode": mode });
        model
    }

    fn with_attribute(mut model: Model, name: &str, kind: &str, values: &[f32]) -> Model {
        let accessor = model.floats(kind, values);
        model.primitive()["attributes"][name] = json!(accessor);
        model
    }

    #[test]
    fn a_mirrored_node_flips_the_winding_and_keeps_normals_outside() {
        let normals = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        let mut model = with_attribute(Model::triangle(), "NORMAL", "VEC3", &normals);
        for (scale, outside) in [
            ([-1, 1, 1], Vec3::Z),
            ([1, 1, -1], Vec3::NEG_Z),
            ([-1, -1, 1], Vec3::Z),
            ([-1, -1, -1], Vec3::NEG_Z),
        ] {
            model.json["nodes"][0]["scale"] = json!(scale);
            let object = model.object();
            assert_eq!(facing(&object), [outside], "{scale:?}");
            assert!(object.normals.iter().all(|n| *n == outside), "{scale:?}: {:?}", object.normals);
        }
    }

    #[test]
    fn normals_stay_perpendicular_under_uneven_scale() {
        // The triangle x + y = 1 with its normal along (1, 1, 0), stretched along x.
        let mut model = Model::triangle();
        let positions = model.floats("VEC3", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
        let normals = model.floats("VEC3", &[1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
        model.primitive()["attributes"] = json!({ "POSITION": positions, "NORMAL": normals });
        for scale in [[4.0, 1.0, 1.0], [1.0, -3.0, 2.0], [4e-20, 1e-20, 1e-20], [4e18, 1e18, 1e18]] {
            model.json["nodes"][0]["scale"] = json!(scale);
            let object = model.object();
            let normal = object.normals[0].normalize();
            assert!(normal.dot(facing(&object)[0]) > 0.999_999, "{scale:?}: {normal}");
        }
        // Squeezed flat, the triangle has no area but the normal still has a direction.
        model.json["nodes"][0]["scale"] = json!([0, 1, 1]);
        assert_eq!(model.object().normals[0], Vec3::X);
    }

    #[test]
    fn unscaled_data_arrive_bit_for_bit() {
        let normals = [0.267_261_24, 0.534_522_5, 0.801_783_7].repeat(3);
        let object = with_attribute(Model::triangle(), "NORMAL", "VEC3", &normals).object();
        assert_eq!(object.normals[2].to_array(), normals[..3]);
        assert_eq!(object.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }

    #[test]
    fn indices_may_have_any_unsigned_type_or_be_absent() {
        let mut model = Model::triangle();
        let absent = model.object();
        assert_eq!(facing(&absent), [Vec3::Z]);
        for (component, size) in [(U8, 1), (U16, 2), (U32, 4)] {
            let bytes: Vec<u8> =
                [1_u32, 2, 0].iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
            let indices = model.accessor(component, "SCALAR", 3, &bytes);
            model.primitive()["indices"] = json!(indices);
            let object = model.object();
            assert_eq!(object.faces[0].vertices, [1, 2, 0], "{component}");
            assert_eq!(object.positions, absent.positions);
        }
        let signed = model.accessor(5120, "SCALAR", 3, &[0, 1, 2]);
        model.primitive()["indices"] = json!(signed);
        assert!(model.error().contains("accessor 4, are not unsigned integers"), "{}", model.error());
    }

    #[test]
    fn strips_and_fans_face_the_same_way_as_triangles() {
        for (mode, indices) in [
            (4, vec![0_u16, 1, 2, 0, 2, 3]),
            (5, vec![0, 1, 3, 2]),
            (6, vec![0, 1, 2, 3]),
            (5, vec![0, 1, 3, 3, 2, 1]),
        ] {
            let object = square(mode, &indices).object();
            assert_eq!(facing(&object), [Vec3::Z; 2], "mode {mode}");
            let area: f32 = object
                .faces
                .iter()
                .map(|f| object.corners(f))
                .map(|[a, b, c]| (b - a).cross(c - a).length())
                .sum();
            assert_eq!(area, 2.0, "mode {mode}");
        }
    }

    #[test]
    fn points_and_lines_are_no_surface() {
        for mode in 0..4 {
            let imported = square(mode, &[0, 1, 2, 3]).read().unwrap();
            assert!(imported.scene.objects.is_empty());
            assert!(text(&imported.warnings).contains("mesh 0: its points and lines"));
        }
        assert!(square(7, &[0, 1, 2]).error().contains("its mode is none of 0 to 6"));
        let imported = square(4, &[0, 1, 2, 0, 2]).read().unwrap();
        assert_eq!(imported.scene.objects[0].faces.len(), 1);
        assert!(text(&imported.warnings).contains("primitive 0: 5 corners do not make triangles"));
    }

    #[test]
    fn indices_out_of_range_are_refused() {
        assert_eq!(square(4, &[0, 1, 4]).error(), "mesh 0, primitive 0: refers to vertex 4 of 4");
        assert!(square(5, &[0, 1, 65_535]).error().contains("vertex 65535 of 4"));
        let mut model = Model::triangle();
        model.json["nodes"][0]["mesh"] = json!(3);
        assert_eq!(model.error(), "node 0: refers to mesh 3 of 1");
        let mut model = Model::triangle();
        model.primitive()["attributes"]["POSITION"] = json!(9);
        assert_eq!(model.error(), "mesh 0, primitive 0, POSITION: refers to accessor 9 of 1");
    }

    #[test]
    fn vertices_that_no_triangle_uses_are_left_behind() {
        let object = square(4, &[3, 0, 2]).object();
        assert_eq!(object.positions, [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
        assert_eq!(object.faces[0].vertices, [2, 0, 1]);
    }

    #[test]
    fn quantised_meshes_get_their_size_from_the_node() {
        let mut model = Model::triangle();
        let positions = model.accessor(5120, "VEC3", 3, &[0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0]);
        model.json["bufferViews"][1]["byteStride"] = json!(4);
        let normals = model.accessor(5120, "VEC3", 3, &[0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0]);
        model.json["bufferViews"][2]["byteStride"] = json!(4);
        for accessor in [positions, normals] {
            model.json["accessors"][accessor]["normalized"] = json!(true);
        }
        let uvs = model.accessor(U16, "VEC2", 3, &[0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 3, 0]);
        model.primitive()["attributes"] =
            json!({ "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs });
        model.json["nodes"][0]["scale"] = json!([2, 2, 2]);
        model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let object = model.object();
        assert_eq!(object.positions, [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0]);
        assert_eq!(object.normals, [Vec3::Z; 3]);
        assert_eq!(object.uvs, [Vec2::ZERO, Vec2::X * 2.0, Vec2::Y * 3.0]);
    }

    #[test]
    fn missing_normals_are_left_to_be_flat() {
        let object = Model::triangle().object();
        assert!(object.normals.is_empty() && object.uvs.is_empty() && object.tints.is_empty());
        assert_eq!(object.faces[0].smoothing, Smoothing::Flat);
    }

    #[test]
    fn parts_with_and_without_an_attribute_share_an_object() {
        let ones = [1.0; 9];
        let mut model = with_attribute(Model::triangle(), "NORMAL", "VEC3", &ones);
        let full = model.primitive().clone();
        let bare = json!({ "attributes": { "POSITION": 0 } });
        model.json["meshes"][0]["primitives"] = json!([bare, full, bare]);
        let object = model.object();
        assert_eq!(
            object.faces.iter().map(|f| f.vertices).collect::<Vec<_>>(),
            [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
        );
        let given: Vec<bool> = object.normals.iter().map(|n| *n != Vec3::ZERO).collect();
        assert_eq!(given, [false, false, false, true, true, true, false, false, false]);
        let smoothing: Vec<_> = object.faces.iter().map(|f| f.smoothing).collect();
        assert_eq!(smoothing, [Smoothing::Flat, Smoothing::Crease, Smoothing::Flat]);
    }

    #[test]
    fn vertex_colours_of_every_type_are_linear_tints() {
        let tint = |component: u32, kind: &str, normalized: bool, bytes: &[u8]| {
            let mut model = Model::triangle();
            let colors = model.accessor(component, kind, 3, bytes);
            model.json["accessors"][colors]["normalized"] = json!(normalized);
            model.primitive()["attributes"]["COLOR_0"] = json!(colors);
            model.object().tints[0]
        };
        let floats: Vec<u8> =
            [0.25_f32, 0.5, 1.5, 0.1].repeat(3).iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(tint(5126, "VEC4", false, &floats), Vec3::new(0.25, 0.5, 1.0), "at most 1");
        assert_eq!(tint(U8, "VEC3", true, &[51, 255, 0].repeat(3)), Vec3::new(0.2, 1.0, 0.0));
        assert_eq!(
            tint(U8, "VEC4", false, &[51, 255, 0, 9].repeat(3)),
            Vec3::new(0.2, 1.0, 0.0),
            "without the flag"
        );
        assert_eq!(
            tint(U16, "VEC3", true, &[0x33, 0x33, 0xff, 0xff, 0, 0].repeat(3)),
            Vec3::new(0.2, 1.0, 0.0)
        );
    }

    #[test]
    fn attributes_need_one_element_for_each_vertex() {
        let message = with_attribute(Model::triangle(), "NORMAL", "VEC3", &[0.0; 6]).error();
        assert_eq!(message, "mesh 0, primitive 0: its NORMAL, accessor 1, has 2 elements for 3 vertices");
        let message = with_attribute(Model::triangle(), "TEXCOORD_0", "VEC3", &[0.0; 9]).error();
        assert_eq!(message, "mesh 0, primitive 0: its TEXCOORD_0, accessor 1, has 3 components");
    }

    fn textured(info: Value) -> Model {
        let mut model = Model::triangle();
        let texture = model.texture([255, 0, 0]);
        let mut info = info;
        info["index"] = json!(texture);
        model.push(
            "materials",
            json!({ "pbrMetallicRoughness": { "baseColorTexture": info, "metallicFactor": 0 } }),
        );
        model.primitive()["material"] = json!(0);
        let model = with_attribute(model, "TEXCOORD_0", "VEC2", &[0.0; 6]);
        with_attribute(model, "TEXCOORD_1", "VEC2", &[1.0; 6])
    }

    #[test]
    fn coordinates_are_those_the_texture_asks_for() {
        assert_eq!(textured(json!({})).object().uvs, [Vec2::ZERO; 3]);
        assert_eq!(textured(json!({ "texCoord": 1 })).object().uvs, [Vec2::ONE; 3]);
        let over = json!({ "texCoord": 0, "extensions": { "KHR_texture_transform": { "texCoord": 1 } } });
        assert_eq!(textured(over).object().uvs, [Vec2::ONE; 3]);
        let imported = textured(json!({ "texCoord": 2 })).read().unwrap();
        assert!(imported.scene.objects[0].uvs.is_empty());
        assert_eq!(
            text(&imported.warnings),
            "mesh 0, primitive 0: it has no TEXCOORD_2, for which its material asks: zero is used\n"
        );
    }

    #[test]
    fn every_node_shows_its_own_instance() {
        let mut model = Model::triangle();
        model.json["meshes"][0]["name"] = json!("Tile");
        model.push("nodes", json!({ "mesh": 0, "name": "Second", "translation": [5, 0, 0] }));
        let objects = model.read().unwrap().scene.objects;
        let names: Vec<_> = objects.iter().map(|object| object.name.as_str()).collect();
        assert_eq!(names, ["Tile", "Second"]);
        assert_eq!(objects[1].positions[0], Vec3::X * 5.0);
    }

    #[test]
    fn instances_beyond_number_are_refused_before_they_take_memory() {
        let mut model = Model::triangle();
        // Each mesh makes a million triangles out of three vertices.
        model.push("accessors", json!({ "componentType": U8, "type": "SCALAR", "count": 3_000_000 }));
        *model.primitive() = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
        model.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 200]);
        assert_eq!(
            model.error(),
            "node 134: with it, the scene has more than the 134217728 triangles lumel reads"
        );
        // Nor may primitives that make none go on for ever.
        let points = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
        model.json["meshes"][0]["primitives"] = json!(vec![points; 2000]);
        model.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 2000]);
        assert!(model.error().starts_with("node 1048: with it"));
    }

    #[test]
    fn what_would_move_is_shown_at_rest_with_a_warning() {
        let mut model = Model::triangle();
        model.json["nodes"][0] = json!({
            "name": "Hero", "mesh": 0, "skin": 0, "weights": [0.5],
            "extensions": { "EXT_mesh_gpu_instancing": { "attributes": {} } },
        });
        let imported = model.read().unwrap();
        assert_eq!(imported.scene.objects[0].faces.len(), 1);
        let warnings = text(&imported.warnings);
        for what in ["skinning", "EXT_mesh_gpu_instancing", "morph targets"] {
            assert!(warnings.contains(&format!("node \"Hero\": {what}")), "{warnings}");
        }
    }
}
