//! Primitives: triangles and the attributes of their vertices.

use super::accessor::{Accessors, Elements};
use super::fault::Fault;
use super::materials::Used;
use super::morph::{Morph, Morphed};
use super::own::BAKED;
use super::pose::Pose;
use super::skin::Influences;
use super::topology::{self, triangle_count};
use glam::{Vec2, Vec3, Vec4};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use lumel_scene::{Face, MaterialId, ObjectMesh, Smoothing, Warnings, rounding_of};

/// The data of a primitive.
pub(super) struct Corners<'a> {
    mode: Mode,
    positions: Elements<'a>,
    /// `None` means all vertices in order.
    indices: Option<Elements<'a>>,
}

/// The triangles of a primitive.
pub(super) struct Shape<'a> {
    positions: Elements<'a>,
    /// The vertices that triangles use, in the order of the file.
    pub(super) vertices: Vec<u32>,
    /// Indices into `vertices`, counter-clockwise in the mesh's own space.
    triangles: Vec<[u32; 3]>,
}

/// A primitive, ready to be placed.
pub(super) struct Part<'a> {
    shape: Shape<'a>,
    material: MaterialId,
    positions: Morphed<'a>,
    normals: Option<Morphed<'a>>,
    uvs: Option<Morphed<'a>>,
    /// Where the material has a normal map.
    tangents: Option<Morphed<'a>>,
    /// The second set of texture coordinates: places in a lightmap, whatever else materials use it for.
    lightmap_uvs: Option<Morphed<'a>>,
    colors: Option<Morphed<'a>>,
    /// Colours that are light: their alpha counts.
    baked: Option<Morphed<'a>>,
}

/// A primitive and where messages say it is.
#[derive(Clone, Copy)]
pub(super) struct Source<'s, 'a> {
    pub(super) primitive: &'s Primitive,
    pub(super) accessors: &'s Accessors<'a>,
    pub(super) place: &'s str,
}

impl<'a> Source<'_, 'a> {
    /// What the primitive is made of; `None` without positions.
    pub(super) fn corners(self) -> Result<Option<Corners<'a>>, Fault> {
        let Self { primitive, accessors, place } = self;
        let Checked::Valid(mode) = primitive.mode else {
            return Err(Fault::at(place, "its mode is none of 0 to 6"));
        };
        let Some(positions) = self.attribute(&Semantic::Positions, &[3], None)? else {
            return Ok(None);
        };
        let indices = primitive.indices.map(|accessor| {
            let elements = accessors.elements(accessor.value(), place)?;
            let problem = format_args!("its indices, accessor {accessor}, are not unsigned integers");
            if elements.are_indices() { Ok(elements) } else { Err(Fault::at(place, problem)) }
        });
        Ok(Some(Corners { mode, positions, indices: indices.transpose()? }))
    }

    /// The triangles of the primitive, none of which leads outside its vertices; `None` if it has no surface.
    pub(super) fn shape(self, mesh: &str, warnings: &mut Warnings) -> Result<Option<Shape<'a>>, Fault> {
        let place = self.place;
        let Some(corners) = self.corners()? else {
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

    /// The primitive's attributes with its morph applied.
    pub(super) fn part(
        self,
        shape: Shape<'a>,
        material: Used,
        morph: &Morph<'_>,
        warnings: &mut Warnings,
    ) -> Result<Part<'a>, Fault> {
        let count = Some(shape.positions.count());
        let morphed = |base: Elements<'a>, semantic: &Semantic| {
            morph.of(base, &semantic.to_string(), self.accessors, self.place)
        };
        let attribute = |semantic: &Semantic, widths: &[usize]| {
            self.attribute(semantic, widths, count)?.map(|base| morphed(base, semantic)).transpose()
        };
        let uvs = Semantic::TexCoords(material.uv_set.unwrap_or(0));
        let uv_name = uvs.to_string();
        let uvs = attribute(&uvs, &[2])?;
        if uvs.is_none() && material.uv_set.is_some() {
            let message = format!("it has no {uv_name}, for which its material asks: zero is used");
            warnings.push(self.place, message);
        }
        // The specification wants integer colours normalised; where the flag is missing, nothing else makes sense. Without
        // it, quantized places in a lightmap have a scale that no material tells: charts keep their shapes.
        let normalized = |semantic: &Semantic, widths: &[usize]| {
            let base = self.attribute(semantic, widths, count)?.map(Elements::normalized);
            base.map(|base| morphed(base, semantic)).transpose()
        };
        let normals = attribute(&Semantic::Normals, &[3])?;
        // The specification wants tangents without normals to be ignored.
        let has_tangents = material.has_normal_map && normals.is_some();
        let tangents = has_tangents.then(|| attribute(&Semantic::Tangents, &[4])).transpose()?.flatten();
        Ok(Part {
            material: material.id,
            positions: morphed(shape.positions, &Semantic::Positions)?,
            normals,
            uvs,
            tangents,
            lightmap_uvs: normalized(&Semantic::TexCoords(1), &[2])?,
            baked: attribute(&Semantic::Extras(BAKED.to_owned()), &[4])?,
            colors: normalized(&Semantic::Colors(0), &[3, 4])?,
            shape,
        })
    }

    /// The joints of a skinned primitive and their weights; `None` if it has none.
    pub(super) fn influences(self) -> Result<Option<Influences<'a>>, Fault> {
        let count = self.attribute(&Semantic::Positions, &[3], None)?.map(|positions| positions.count());
        let mut sets = Vec::new();
        for set in 0.. {
            let joints = self.attribute(&Semantic::Joints(set), &[4], count)?;
            let weights = self.attribute(&Semantic::Weights(set), &[4], count)?;
            match (joints, weights) {
                (Some(joints), Some(weights)) if joints.are_unsigned() => sets.push([joints, weights]),
                (None, None) => break,
                (Some(_), Some(_)) => {
                    let problem = format!("its JOINTS_{set} are not unsigned integers");
                    return Err(Fault::at(self.place, problem));
                }
                (joints, _) => {
                    let [has, lacks] =
                        if joints.is_some() { ["JOINTS", "WEIGHTS"] } else { ["WEIGHTS", "JOINTS"] };
                    let problem = format!("it has {has}_{set} but no {lacks}_{set}");
                    return Err(Fault::at(self.place, problem));
                }
            }
        }
        Ok((!sets.is_empty()).then(|| Influences::new(sets)))
    }

    /// An attribute of the primitive, with one element of one of these `widths` for each of `count` vertices.
    fn attribute(
        self,
        semantic: &Semantic,
        widths: &[usize],
        count: Option<usize>,
    ) -> Result<Option<Elements<'a>>, Fault> {
        let Self { primitive, accessors, place } = self;
        let Some(accessor) = primitive.attributes.get(&Checked::Valid(semantic.clone())) else {
            return Ok(None);
        };
        let name = semantic.to_string();
        let elements = accessors.elements(accessor.value(), &format!("{place}, {name}"))?;
        let problem = match count {
            _ if !widths.contains(&elements.width()) => format!("has {} components", elements.width()),
            Some(count) if count != elements.count() => {
                format!("has {} elements for {count} vertices", elements.count())
            }
            _ => return Ok(Some(elements)),
        };
        Err(Fault::at(place, format_args!("its {name}, accessor {accessor}, {problem}")))
    }
}

impl Part<'_> {
    /// The vertices that it uses, as indices into all of its attributes.
    pub(super) fn vertices(&self) -> &[u32] {
        &self.shape.vertices
    }

    /// Adds its triangles, in this pose, to an object.
    pub(super) fn append_to(&self, object: &mut ObjectMesh, pose: &Pose) {
        let vertices = || self.shape.vertices.iter().map(|&vertex| vertex as usize);
        let first = object.positions.len();
        object
            .positions
            .extend(vertices().enumerate().map(|(i, vertex)| pose.point(i, self.positions.vector(vertex))));
        let end = object.positions.len();
        let coordinates = vertices().flat_map(|v| self.positions.vector::<3>(v)).map(f32::abs);
        let largest = coordinates.filter(|c| c.is_finite()).fold(0.0, f32::max);
        object.rounding = object.rounding.max(pose.stretch() * rounding_of(largest));
        let normals = self.normals.as_ref();
        let normals =
            normals.map(|n| vertices().enumerate().map(|(i, vertex)| pose.normal(i, n.vector(vertex))));
        // The specification asks for flat normals where there are none.
        let smoothing = if normals.is_some() { Smoothing::default() } else { Smoothing::Flat };
        fill(&mut object.normals, first, end, Vec3::ZERO, normals);
        let tangents = self.tangents.as_ref().map(|tangents| {
            vertices().enumerate().map(|(i, v)| pose.tangent(i, tangents.vector(v), tangents.fourth(v)))
        });
        fill(&mut object.tangents, first, end, Vec4::ZERO, tangents);
        let coordinates = |uvs: &Option<Morphed<'_>>| {
            uvs.as_ref().map(|uvs| vertices().map(|v| Vec2::from(uvs.vector::<2>(v))).collect::<Vec<_>>())
        };
        fill(&mut object.uvs, first, end, Vec2::ZERO, coordinates(&self.uvs));
        fill(&mut object.lightmap_uvs, first, end, Vec2::NAN, coordinates(&self.lightmap_uvs));
        let tint = |color: [f32; 3]| Vec3::from(color).clamp(Vec3::ZERO, Vec3::ONE);
        let tints = self.colors.as_ref().map(|colors| vertices().map(move |v| tint(colors.vector(v))));
        fill(&mut object.tints, first, end, Vec3::ONE, tints);
        let with_alpha = self.colors.as_ref().or(self.baked.as_ref()).filter(|colors| colors.has_fourth());
        let alphas = with_alpha.map(|colors| vertices().map(|v| colors.fourth(v).clamp(0.0, 1.0)));
        fill(&mut object.alphas, first, end, 1.0, alphas);
        object.faces.extend(self.shape.triangles.iter().map(|&[a, b, c]| {
            let vertices = if pose.mirrors([a, b, c]) { [a, c, b] } else { [a, b, c] };
            Face { vertices: vertices.map(|v| v + first as u32), material: self.material, smoothing }
        }));
    }
}

impl Corners<'_> {
    /// How many triangles there are; `None` for points and lines.
    pub(super) fn triangle_count(&self) -> Option<usize> {
        triangle_count(self.mode, self.count())
    }

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
    values: Option<impl IntoIterator<Item = T>>,
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
