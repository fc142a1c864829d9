//! Tangents for normal maps.

use crate::corners::split_vertices;
use crate::mesh::{Face, ObjectMesh};
use crate::{Material, Warnings};
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::Vec4;
use std::collections::HashMap;

/// Keeps the given tangents, with unit length, and makes those that normal maps miss; vertices are split where
/// texture coordinates are mirrored.
///
/// Missing ones are those of MikkTSpace: normal maps from other programs assume them. Normals must be complete. An object
/// without normal maps has no tangents, and those that cannot be made are zero. Returns which vertex each added one is a
/// copy of.
pub(crate) fn fill_missing(
    mesh: &mut ObjectMesh,
    materials: &[Material],
    warnings: &mut Warnings,
) -> Vec<u32> {
    let is_mapped =
        |face: &Face| materials.get(face.material.index()).is_some_and(|m| m.normal_texture.is_some());
    let mapped: Vec<usize> = (0..mesh.faces.len()).filter(|&face| is_mapped(&mesh.faces[face])).collect();
    let mut given = std::mem::take(&mut mesh.tangents);
    if mapped.is_empty() {
        return Vec::new();
    }
    given.iter_mut().for_each(|tangent| *tangent = unit(*tangent));
    given.resize(mesh.positions.len(), Vec4::ZERO);
    let is_given = |corner: &u32| given[*corner as usize] != Vec4::ZERO;
    if mapped.iter().all(|&face| mesh.faces[face].vertices.iter().all(is_given)) {
        mesh.tangents = given;
        return Vec::new();
    }
    if mesh.uvs.is_empty() {
        let message = "it has a normal map but no texture coordinates: the map is left out";
        warnings.push(format!("object \"{}\"", mesh.name), message);
        return Vec::new();
    }
    let mut made = Corners { mesh, mapped: &mapped, tangents: vec![Vec4::ZERO; 3 * mapped.len()] };
    // Its error has no values.
    let _ = generate_tangents(&mut made);
    let made = made.tangents;
    let flat = made.chunks(3).filter(|corners| corners.contains(&Vec4::ZERO)).count();
    if flat > 0 {
        let message =
            format!("{flat} triangles have a normal map but no area in it: the map is left out there");
        warnings.push(format!("object \"{}\"", mesh.name), message);
    }
    let corners = mapped.iter().flat_map(|face| [0, 1, 2].map(|k| 3 * face + k));
    split_by(mesh, given, corners.zip(made))
}

/// Gives each corner its tangent, where its vertex has none yet.
fn split_by(
    mesh: &mut ObjectMesh,
    mut tangents: Vec<Vec4>,
    made: impl Iterator<Item = (usize, Vec4)>,
) -> Vec<u32> {
    let given = tangents.clone();
    let vertex_of = |mesh: &ObjectMesh, corner: usize| mesh.faces[corner / 3].vertices[corner % 3] as usize;
    // Corners that have no tangent go with the first that has.
    let mut groups = vec![0; 3 * mesh.faces.len()];
    let mut known: HashMap<(usize, [u32; 4]), u32> = HashMap::new();
    let mut count = vec![0; tangents.len()];
    let mut of_corners = Vec::new();
    for (corner, tangent) in made {
        let vertex = vertex_of(mesh, corner);
        if given[vertex] == Vec4::ZERO && tangent != Vec4::ZERO {
            let next = count[vertex];
            let group = *known.entry((vertex, tangent.to_array().map(f32::to_bits))).or_insert(next);
            count[vertex] = count[vertex].max(group + 1);
            groups[corner] = group;
            of_corners.push((corner, tangent));
        }
    }
    let copies = split_vertices(mesh, &groups);
    tangents.extend(copies.iter().map(|&copy| given[copy as usize]));
    for (corner, tangent) in of_corners {
        tangents[vertex_of(mesh, corner)] = tangent;
    }
    mesh.tangents = tangents;
    copies
}

/// A tangent of unit length whose last number is a sign; zero for what is none.
fn unit(tangent: Vec4) -> Vec4 {
    let direction = tangent.truncate().try_normalize();
    direction.map_or(Vec4::ZERO, |t| t.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 }))
}

/// The tangent in the middle of an edge; zero if one end has none, or its image is mirrored there.
pub(crate) fn middle(a: Vec4, b: Vec4) -> Vec4 {
    if a.w == b.w { unit(a + b) } else { Vec4::ZERO }
}

/// The corners of the faces with a normal map.
struct Corners<'a> {
    mesh: &'a ObjectMesh,
    mapped: &'a [usize],
    tangents: Vec<Vec4>,
}

impl Corners<'_> {
    fn of<T: Copy>(&self, values: &[T], face: usize, corner: usize) -> T {
        values[self.mesh.faces[self.mapped[face]].vertices[corner] as usize]
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mapped.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.of(&self.mesh.positions, face, corner).to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.of(&self.mesh.normals, face, corner).to_array()
    }

    /// With `v` up: green is up, too.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.of(&self.mesh.uvs, face, corner);
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let encoded = space.map_or(Vec4::ZERO, |space| Vec4::from(space.tangent_encoded()));
        // What lies in no plane, or in one point of the image, has none.
        self.tangents[3 * face + corner] = unit(encoded);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::quad;
    use crate::{NormalMap, SceneBuilder, SurfacePoint, Texture, TextureId, TextureRef, TriId, UvTransform};
    use glam::{Vec2, Vec3};

    /// A square with a normal map and these texture coordinates, `v` up, as functions of the place.
    fn square(uv: impl Fn(Vec3) -> Vec2) -> ObjectMesh {
        let mut mesh = quad("square");
        mesh.uvs = mesh.positions.iter().map(|&p| uv(p) * Vec2::new(1.0, -1.0)).collect();
        mesh
    }

    fn mapped(objects: Vec<ObjectMesh>, map: NormalMap, texel: [f32; 3]) -> SceneBuilder {
        let material = Material { normal_texture: Some(map), ..Material::default() };
        let textures = Texture::from_floats("normals", 1, 1, vec![texel]).into_iter().collect();
        SceneBuilder { objects, materials: vec![material], textures, ..SceneBuilder::default() }
    }

    fn plain() -> NormalMap {
        NormalMap::new(TextureRef::plain(TextureId(0)))
    }

    fn warnings_of(builder: SceneBuilder) -> Vec<String> {
        builder.build().unwrap().1.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn tangents_point_along_u_and_their_sign_tells_mirrored_images() {
        let tangents = |mesh| mapped(vec![mesh], plain(), [1.0; 3]).build().unwrap().0.tangents().to_vec();
        let straight = tangents(square(|p| p.truncate()));
        assert_eq!(straight, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        let mirrored = tangents(square(|p| Vec2::new(-p.x, p.y)));
        assert_eq!(mirrored, [Vec4::new(-1.0, 0.0, 0.0, -1.0); 4]);
        let turned = tangents(square(|p| Vec2::new(p.y, -p.x)));
        assert_eq!(turned, [Vec4::new(0.0, 1.0, 0.0, 1.0); 4]);
    }

    #[test]
    fn vertices_are_split_where_the_image_is_mirrored_and_nowhere_else() {
        let face = |vertices| Face { vertices, ..quad("").faces[0] };
        let mut mesh = quad("butterfly");
        mesh.positions.extend([Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)]);
        mesh.faces.extend([face([1, 4, 5]), face([1, 5, 2])]);
        mesh.uvs = mesh.positions.iter().map(|p| Vec2::new((p.x - 1.0).abs(), -p.y)).collect();
        let (scene, _) = mapped(vec![mesh.clone()], plain(), [1.0; 3]).build().unwrap();
        assert_eq!((scene.vertex_count(), scene.triangle_count()), (8, 4));
        for tri in (0..4).map(TriId) {
            let sign = if tri.0 < 2 { -1.0 } else { 1.0 };
            for vertex in scene.triangle(tri) {
                assert_eq!(scene.tangents()[vertex as usize], Vec4::new(sign, 0.0, 0.0, sign));
            }
        }
        // The same vertices are known of the mesh, and none is split without a map.
        let shares = scene.input_mesh(crate::ObjectId(0)).vertex_map(crate::FaceSide::Front);
        let counts: Vec<usize> = (0..6).map(|v| shares.at(v).unwrap().len()).collect();
        assert_eq!(counts, [1, 2, 2, 1, 1, 1]);
        let mut plain = mapped(vec![mesh], plain(), [1.0; 3]);
        plain.materials[0].normal_texture = None;
        let (scene, _) = plain.build().unwrap();
        assert_eq!((scene.vertex_count(), scene.tangents().len()), (6, 0));
    }

    #[test]
    fn given_tangents_are_kept_and_missing_ones_made() {
        let given = Vec4::new(0.0, 3.0, 0.0, -1.0);
        let mut mesh = square(|p| p.truncate());
        mesh.tangents = vec![given; 4];
        let (scene, _) = mapped(vec![mesh.clone()], plain(), [1.0; 3]).build().unwrap();
        assert_eq!(scene.tangents(), [Vec4::new(0.0, 1.0, 0.0, -1.0); 4]);
        mesh.tangents[2] = Vec4::ZERO;
        mesh.tangents[3] = Vec4::NAN;
        let (scene, _) = mapped(vec![mesh], plain(), [1.0; 3]).build().unwrap();
        let made = Vec4::new(1.0, 0.0, 0.0, 1.0);
        assert_eq!(scene.tangents()[2..], [made; 2]);
    }

    #[test]
    fn the_back_of_a_map_is_that_of_its_front() {
        let mut builder = mapped(vec![square(|p| p.truncate())], plain(), [0.8, 0.6, 0.9]);
        builder.materials[0].sides = crate::Sides::Both;
        let (scene, _) = builder.build().unwrap();
        let at = SurfacePoint { tri: TriId(0), bary: [0.3, 0.3].into() };
        let back = scene.seen_side(at, crate::FaceSide::Back).unwrap();
        let expected = Vec3::new(0.6, 0.2, 0.8).normalize();
        assert!((shown_at(&scene, at) - expected).length() < 1e-6);
        assert!((shown_at(&scene, back) + expected).length() < 1e-6);
    }

    /// The normal in the middle of a square whose image, of one texel, is turned to the right and a little to the top.
    fn shown(map: NormalMap) -> Vec3 {
        let builder = mapped(vec![square(|p| p.truncate())], map, [0.9, 0.6, 0.9]);
        shown_at(&builder.build().unwrap().0, SurfacePoint::default())
    }

    fn shown_at(scene: &crate::Scene, at: SurfacePoint) -> Vec3 {
        scene.mapped_normal(at, Vec2::ONE).unwrap_or_else(|| scene.shading_normal(at))
    }

    #[test]
    fn maps_turn_with_their_image_and_have_a_scale() {
        let expected = |x: f32, y: f32| Vec3::new(x, y, 0.8).normalize();
        let near =
            |map, expected: Vec3| assert!((shown(map) - expected).length() < 1e-6, "{map:?} {}", shown(map));
        near(plain(), expected(0.8, 0.2));
        near(plain().flipped(), expected(0.8, -0.2));
        near(NormalMap { scale: Vec2::splat(0.5), ..plain() }, expected(0.4, 0.1));
        let with = |transform| NormalMap { image: TextureRef { transform, ..plain().image }, ..plain() };
        let scaled = UvTransform { scale: Vec2::new(7.0, 0.5), ..UvTransform::default() };
        near(with(scaled), expected(0.8, 0.2));
        // 90°: the image's u grows where v does, downwards here.
        let turned = UvTransform { rotation: 90_f32.to_radians(), ..UvTransform::default() };
        near(with(turned), expected(0.2, -0.8));
        let mirrored = UvTransform { scale: Vec2::new(-1.0, 1.0), ..UvTransform::default() };
        near(with(mirrored), expected(-0.8, 0.2));
        let nothing = UvTransform { scale: Vec2::ZERO, ..UvTransform::default() };
        near(with(nothing), Vec3::Z);
    }

    #[test]
    fn what_is_missing_is_said_and_the_map_left_out() {
        let mut without = quad("without");
        without.positions.iter_mut().for_each(|p| p.x += 5.0);
        let builder = mapped(vec![without.clone()], plain(), [1.0, 0.5, 0.5]);
        assert_eq!(shown_at(&builder.clone().build().unwrap().0, SurfacePoint::default()), Vec3::Z);
        let expected =
            "object \"without\": it has a normal map but no texture coordinates: the map is left out";
        assert_eq!(warnings_of(builder), [expected]);
        let in_a_point = square(|_| Vec2::ONE);
        let builder = mapped(vec![in_a_point], plain(), [1.0, 0.5, 0.5]);
        assert_eq!(shown_at(&builder.clone().build().unwrap().0, SurfacePoint::default()), Vec3::Z);
        let expected =
            "object \"square\": 2 triangles have a normal map but no area in it: the map is left out there";
        assert_eq!(warnings_of(builder), [expected]);
        let endless = NormalMap { scale: Vec2::splat(f32::NAN), ..plain() };
        let expected =
            "material \"default\": the scale of its normal map is not a finite number: 1 is used instead";
        assert_eq!(warnings_of(mapped(vec![square(|p| p.truncate())], endless, [1.0; 3])), [expected]);
    }

    #[test]
    fn fine_meshes_have_the_tangents_of_the_coarse_one() {
        // Bent at the middle, so that tangents there are means.
        let mut mesh = square(|p| p.truncate());
        mesh.positions[2].z = 0.3;
        let builder = mapped(vec![mesh], plain(), [0.9, 0.6, 0.9]);
        let (coarse, _) = builder.clone().build().unwrap();
        let mut fine = builder;
        fine.tessellate(0.6).unwrap();
        let (fine, _) = fine.build().unwrap();
        assert!(fine.vertex_count() > coarse.vertex_count());
        assert_eq!(fine.tangents()[..4], *coarse.tangents());
        assert!(fine.tangents().iter().all(|t| (t.truncate().length() - 1.0).abs() < 1e-6 && t.w == 1.0));
        let splits = [[0, 2]];
        let refined = coarse.refined(&splits).unwrap();
        let middle = *refined.tangents().last().unwrap();
        assert_eq!(middle, middle_of(&coarse, splits[0]));
    }

    fn middle_of(scene: &crate::Scene, [a, b]: [u32; 2]) -> Vec4 {
        middle(scene.tangents()[a as usize], scene.tangents()[b as usize])
    }
}
