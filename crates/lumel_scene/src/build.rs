//! From loose meshes to a checked scene.

use crate::creases::split_at_creases;
use crate::error::{MAX_TRIANGLES, SceneError};
use crate::face_list::{FaceList, Given};
use crate::scene::Scene;
use crate::transparency::Looks;
use crate::{SceneBuilder, Warnings, check, coincident, normals, resolution, sanitize, tangents};

impl SceneBuilder {
    /// Checks, cleans and freezes the scene. What had to be left out is in the warnings.
    ///
    /// A scene far from its origin is [recentred](Self::recenter). Triangles that are fully transparent, have positions
    /// that are not finite or an area below 1e-12 of the squared diagonal are dropped, and so are all but one of those in
    /// the same place that face the same way; two that face opposite ways become the sides of one surface. Missing normals
    /// are made, and so are missing tangents of normal maps; vertices are split where neighbouring faces turn sharply and where
    /// texture coordinates of normal maps are mirrored. Faces of two-sided materials get a second face
    /// for the back, with vertices of its own. The order of vertices is kept,
    /// split-off ones follow those of their object, and those of back sides come last. [`Scene::input_mesh`] leads
    /// back to the vertices and faces as they were given here.
    ///
    /// # Errors
    /// Anything that cannot be mended: see [`SceneError`].
    pub fn build(mut self) -> Result<(Scene, Warnings), SceneError> {
        let mut warnings = Warnings::default();
        check::builder(&self)?;
        self.recenter();
        sanitize::materials(&mut self.materials, &self.textures, &self.objects, &mut warnings);
        let looks = Looks::new(&self.materials, &self.textures);
        let face_counts: Vec<u32> = self.objects.iter().map(|object| object.faces.len() as u32).collect();
        let present: Vec<Vec<u32>> = self
            .objects
            .iter_mut()
            .map(|object| sanitize::absent_faces(object, &looks, &mut warnings))
            .collect();
        let mut smallest = sanitize::Smallest::of(self.diagonal_squared());
        let mut faces = FaceList::default();
        let mut objects = std::mem::take(&mut self.objects);
        let mut kept = Vec::with_capacity(objects.len());
        for (object, present) in objects.iter_mut().zip(present) {
            resolution::check(object, &mut warnings)?;
            kept.push(sanitize::object(object, present, &mut smallest, &mut warnings));
        }
        let pairs = coincident::resolve(&mut objects, &mut kept, &self.materials, &mut warnings);
        for ((mut object, kept), face_count) in objects.into_iter().zip(kept).zip(face_counts) {
            let vertex_count = object.positions.len() as u32;
            let mut vertices: Vec<u32> = (0..vertex_count).collect();
            let mut note_copies = |copies: Vec<u32>| {
                copies.into_iter().for_each(|vertex| vertices.push(vertices[vertex as usize]));
            };
            note_copies(normals::fill_missing(&mut object, &mut warnings));
            note_copies(split_at_creases(&mut object));
            note_copies(tangents::fill_missing(&mut object, &self.materials, &mut warnings));
            faces.append(object, Given { vertex_count, vertices, face_count, faces: kept });
        }
        if faces.triangles.is_empty() {
            return Err(match smallest.was_undercut {
                true => SceneError::TooSmall { scene: self.name, diagonal: smallest.diagonal },
                false => SceneError::Empty { scene: self.name },
            });
        }
        faces.add_back_sides(&self.materials, &pairs);
        if looks.vary() {
            faces.note_transparent(&looks);
        }
        if faces.positions.len() > MAX_TRIANGLES || faces.triangles.len() > MAX_TRIANGLES {
            return Err(SceneError::TooLarge { scene: self.name, triangles: faces.triangles.len() as u64 });
        }
        Ok((Scene::new(self, faces), warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::quad;
    use crate::{
        Face, FaceSide, Light, MAX_ALBEDO, Material, MaterialId, ObjectMesh, Radiance, RectLight, Sides,
        Smoothing, TextureId, TriId,
    };
    use glam::{Vec2, Vec3};

    fn builder(objects: Vec<ObjectMesh>) -> SceneBuilder {
        SceneBuilder {
            name: "test".into(),
            objects,
            materials: vec![Material::default()],
            ..Default::default()
        }
    }

    #[test]
    fn a_quad_keeps_its_vertices_and_gets_normals() {
        let (scene, warnings) = builder(vec![quad("q")]).build().unwrap();
        assert_eq!((scene.vertex_count(), scene.triangle_count()), (4, 2));
        assert!(scene.normals().iter().all(|n| *n == Vec3::Z));
        assert!(warnings.is_empty());
    }

    #[test]
    fn two_sided_faces_have_a_back_with_vertices_of_its_own() {
        let mut b = builder(vec![quad("q")]);
        b.materials[0].sides = Sides::Both;
        let (scene, _) = b.build().unwrap();
        assert_eq!((scene.vertex_count(), scene.triangle_count(), scene.traced_count()), (8, 4, 2));
        let front = crate::SurfacePoint { tri: TriId(1), bary: [0.2, 0.3].into() };
        let back = scene.seen_side(front, FaceSide::Back).unwrap();
        assert!((scene.position(back) - scene.position(front)).length() < 1e-6);
        assert!((scene.geometric_normal(back.tri) + scene.geometric_normal(front.tri)).length() < 1e-6);
        assert_eq!(scene.traced(back.tri), front.tri);
        assert_eq!(scene.seen_side(front, FaceSide::Front), Some(front));
    }

    #[test]
    fn one_sided_faces_are_black_from_behind() {
        let (scene, _) = builder(vec![quad("q")]).build().unwrap();
        assert_eq!(scene.seen_side(crate::SurfacePoint::default(), FaceSide::Back), None);
    }

    #[test]
    fn bad_faces_are_dropped_with_a_warning_and_an_empty_scene_is_refused() {
        let mut broken = quad("broken");
        broken.positions[3] = Vec3::new(f32::NAN, 0.0, 0.0);
        let (scene, warnings) = builder(vec![broken.clone()]).build().unwrap();
        assert_eq!(scene.triangle_count(), 1);
        assert_eq!(warnings.len(), 1);
        broken.positions[1] = Vec3::ZERO;
        assert_eq!(builder(vec![broken]).build().unwrap_err(), SceneError::Empty { scene: "test".into() });
    }

    #[test]
    fn objects_too_far_from_each_other_are_told_from_empty_ones() {
        let mut far = quad("far");
        far.positions.iter_mut().for_each(|p| *p += Vec3::splat(3e6));
        let error = builder(vec![quad("near"), far.clone()]).build().unwrap_err();
        assert!(matches!(error, SceneError::TooSmall { .. }), "{error}");
        assert!(error.to_string().contains("the scene is 519615"), "{error}");
        // What is large enough stays, and the other is named.
        far.positions.iter_mut().for_each(|p| *p *= 10.0);
        let large = ObjectMesh {
            positions: quad("large").positions.iter().map(|p| *p * 1e4).collect(),
            ..quad("large")
        };
        let (_, warnings) = builder(vec![quad("near"), large, far]).build().unwrap();
        let text = warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        assert!(
            text.contains("object \"near\": 2 triangles dropped: they are smaller than a millionth"),
            "{text}"
        );
    }

    #[test]
    fn places_in_a_lightmap_go_with_their_vertices_to_copies_and_backs() {
        let face = |vertices, material| Face {
            vertices,
            material: MaterialId(material),
            smoothing: Smoothing::Crease,
        };
        // A right angle along the edge from 0 to 1, whose one face has two sides.
        let mut bent = quad("bent");
        bent.positions.push(Vec3::Z);
        bent.faces = vec![face([0, 1, 2], 0), face([0, 4, 1], 1)];
        bent.lightmap_uvs = (0..5).map(|i| Vec2::splat(i as f32)).collect();
        let moved = |mut mesh: ObjectMesh, by: f32| {
            mesh.positions.iter_mut().for_each(|p| p.x += by);
            mesh
        };
        let mut b = builder(vec![quad("without"), moved(bent, 5.0), moved(quad("without too"), 10.0)]);
        b.materials.push(Material::default().two_sided());
        let (scene, _) = b.build().unwrap();
        let uvs = |tri: u32| scene.triangle(TriId(tri)).map(|v| scene.lightmap_uvs()[v as usize].x);
        assert_eq!(scene.lightmap_uvs().len(), scene.vertex_count());
        assert_eq!([2, 3, 6].map(uvs), [[0.0, 1.0, 2.0], [0.0, 4.0, 1.0], [4.0, 0.0, 1.0]]);
        assert!([0, 1, 4, 5].map(uvs).as_flattened().iter().all(|uv| uv.is_nan()));
        let (scene, _) = builder(vec![quad("without")]).build().unwrap();
        assert!(scene.lightmap_uvs().is_empty());
    }

    #[test]
    fn bad_indices_and_counts_name_the_object() {
        let mut bad = quad("bad");
        bad.faces[1].vertices[2] = 9;
        let message = builder(vec![bad]).build().unwrap_err().to_string();
        assert_eq!(message, "object \"bad\": face 1 refers to vertex 9 of 4");
        let mut bad = quad("bad");
        bad.uvs = vec![Vec2::ZERO; 3];
        let message = builder(vec![bad]).build().unwrap_err().to_string();
        assert_eq!(message, "object \"bad\" has 3 texture coordinates for 4 vertices");
    }

    #[test]
    fn white_walls_with_dark_vertex_colours_are_not_clamped() {
        let warned = |tint: Vec3| {
            let mut b = builder(vec![ObjectMesh { tints: vec![tint; 4], ..quad("q") }]);
            b.materials[0].albedo = Vec3::ONE;
            let (_, warnings) = b.build().unwrap();
            warnings.iter().any(|warning| warning.message.contains("clamped"))
        };
        assert!(!warned(Vec3::splat(0.5)));
        assert!(warned(Vec3::new(0.1, 0.99, 0.1)) && warned(Vec3::splat(f32::NAN)));
    }

    #[test]
    fn white_walls_are_clamped_with_a_warning() {
        let mut b = builder(vec![quad("q")]);
        b.materials[0].albedo = Vec3::ONE;
        let (scene, warnings) = b.build().unwrap();
        assert_eq!(scene.albedo(crate::SurfacePoint::default()).0, Vec3::splat(MAX_ALBEDO));
        assert_eq!(
            warnings.iter().next().unwrap().to_string(),
            "material \"default\": albedo of up to 1.000 is clamped to 0.98"
        );
    }

    /// A unit of light on the plane of `u` and `v`.
    fn lamp(u: Vec3, v: Vec3) -> RectLight {
        RectLight { center: Vec3::ZERO, u, v, radiance: Radiance::splat(1.0), texture: None }
    }

    #[test]
    fn lights_that_are_not_rectangles_are_refused() {
        let mut b = builder(vec![quad("q")]);
        b.lights.push(Light::Rect(lamp(Vec3::X, Vec3::X + Vec3::Y)));
        assert!(b.build().unwrap_err().to_string().contains("right angle"));
    }

    #[test]
    fn relit_scenes_share_their_surfaces_and_differ_in_lights() {
        let (scene, _) = builder(vec![quad("q")]).build().unwrap();
        let light = Light::Rect(lamp(Vec3::X, Vec3::Y));
        let relit = scene.relit(vec![light; 2]).unwrap();
        assert_eq!((scene.lights(), relit.lights()), (&[][..], &[light; 2][..]));
        assert_eq!((relit.name(), relit.triangle_count()), ("test", 2));
        assert!(std::ptr::eq(relit.positions(), scene.positions()), "nothing is copied");
        assert!(std::ptr::eq(relit.textures(), scene.textures()));
    }

    #[test]
    fn relit_scenes_refuse_the_lights_that_builders_refuse() {
        let (scene, _) = builder(vec![quad("q")]).build().unwrap();
        let textured = RectLight { texture: Some(TextureId(3)), ..lamp(Vec3::X, Vec3::Y) };
        let lights = [lamp(Vec3::X, Vec3::X + Vec3::Y), lamp(Vec3::X, Vec3::ZERO), textured];
        for light in lights.map(Light::Rect) {
            let mut b = builder(vec![quad("q")]);
            b.lights = vec![Light::Rect(lamp(Vec3::X, Vec3::Y)), light];
            let refused = scene.relit(b.lights.clone()).unwrap_err();
            assert!(refused.to_string().starts_with("light 1"), "{refused}");
            assert_eq!(b.build().unwrap_err(), refused);
        }
    }

    #[test]
    fn a_sky_that_is_no_light_is_refused() {
        let (scene, _) = builder(vec![quad("q")]).build().unwrap();
        for bad in [f32::NAN, -1.0, f32::INFINITY] {
            let mut b = builder(vec![quad("q")]);
            b.sky = Radiance::splat(bad).into();
            assert_eq!(scene.under_sky(b.sky.clone()).unwrap_err(), SceneError::BadSky);
            assert_eq!(b.build().unwrap_err(), SceneError::BadSky);
        }
    }

    #[test]
    fn huge_coordinates_keep_their_triangles() {
        let mut huge = quad("huge");
        huge.positions.iter_mut().for_each(|p| *p *= 1e20);
        assert_eq!(builder(vec![huge]).build().unwrap().0.triangle_count(), 2);
    }

    #[test]
    fn faces_at_a_right_angle_do_not_share_a_lighting_vertex() {
        let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
        let mut bent = quad("bent");
        bent.positions.push(Vec3::Z);
        bent.faces = vec![face([0, 1, 2]), face([0, 4, 1])];
        // Smooth normals in the file do not join what light sees as an edge.
        bent.normals = vec![Vec3::ONE; 5];
        let (scene, _) = builder(vec![bent]).build().unwrap();
        assert_eq!(scene.vertex_count(), 6);
        let (scene, _) = builder(vec![quad("flat")]).build().unwrap();
        assert_eq!(scene.vertex_count(), 4);
    }
}
