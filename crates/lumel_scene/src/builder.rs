//! From loose meshes to a checked scene.

use crate::corners::{Corners, split_vertices};
use crate::material::sound;
use crate::scene::{FaceList, Scene};
use crate::{
    Camera, Light, MAX_ALBEDO, Material, MaterialId, ObjectId, Radiance, RectLight, Sides, Texture,
    TextureId, Warnings, normals,
};
use glam::{Vec2, Vec3};

/// The largest number of triangles in a scene: indices of corners must fit 32 bits.
pub const MAX_TRIANGLES: usize = (u32::MAX / 3) as usize;

/// Neighbouring faces of one vertex that turn by more than this do not share a lighting vertex, whatever normals
/// the file gives: light changes at such an edge. Coarse but round meshes (an icosahedron turns by 42°) stay smooth.
const LIGHTING_CREASE_COS: f32 = 0.5;

/// Which faces share a normal at a vertex that has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Smoothing {
    /// Only faces in one plane.
    Flat,
    /// Faces of the same group.
    Group(u32),
    /// Faces that turn by less than 40° at their common edge.
    #[default]
    Crease,
}

/// A triangle of an [`ObjectMesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// Indices into the object's vertices, counter-clockwise seen from the front.
    pub vertices: [u32; 3],
    /// Index into the builder's materials.
    pub material: MaterialId,
    /// How missing normals are made.
    pub smoothing: Smoothing,
}

/// A named mesh in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectMesh {
    /// The name messages use.
    pub name: String,
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Vertex normals: empty, or one per position. Zero stands for "none given"; any length is accepted.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, `v` down: empty, or one per position.
    pub uvs: Vec<Vec2>,
    /// Linear vertex colours that multiply the albedo: empty, or one per position.
    pub tints: Vec<Vec3>,
    /// The triangles.
    pub faces: Vec<Face>,
}

/// Why a scene cannot be built.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum SceneError {
    /// Nothing to light.
    #[error("scene \"{scene}\" has no triangles that can be lit")]
    Empty {
        /// The scene's name.
        scene: String,
    },
    /// More triangles or vertices than indices can address.
    #[error("scene \"{scene}\" would have {triangles} triangles; the limit is {MAX_TRIANGLES}")]
    TooLarge {
        /// The scene's name.
        scene: String,
        /// How many it would have.
        triangles: u64,
    },
    /// An index points outside its array.
    #[error("object \"{object}\": face {face} refers to {what} {index} of {count}")]
    BadIndex {
        /// The object's name.
        object: String,
        /// Which of its faces.
        face: usize,
        /// "vertex" or "material".
        what: &'static str,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// Attribute arrays of different lengths.
    #[error("object \"{object}\" has {count} {what} for {vertices} vertices")]
    BadCount {
        /// The object's name.
        object: String,
        /// Which attribute.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there should be.
        vertices: usize,
    },
    /// A material or light names a texture that does not exist.
    #[error("{user} refers to texture {index} of {count}")]
    BadTexture {
        /// The material or light.
        user: String,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A sky that is not finite or negative.
    #[error("the sky's radiance must be finite and not negative")]
    BadSky,
    /// A rectangle light that has no area, is not rectangular or is not finite.
    #[error("light {index}: {problem}")]
    BadLight {
        /// Index into the lights.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A length for tessellation that would take more memory than anybody has.
    #[error(
        "edges of at most {max_edge} m would give scene \"{scene}\" at least {triangles} triangles; the limit is {limit}: choose a longer edge"
    )]
    TooFine {
        /// The scene's name.
        scene: String,
        /// The length, metres.
        max_edge: f32,
        /// How many triangles it takes at the least.
        triangles: u64,
        /// How many are allowed.
        limit: u64,
    },
    /// A length for tessellation that is not a positive number.
    #[error("the longest edge must be a positive length, not {0}")]
    BadEdgeLength(f32),
}

/// A scene in the making: plain data that importers and generators fill in.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    /// The name messages and output files use.
    pub name: String,
    /// Meshes in world space.
    pub objects: Vec<ObjectMesh>,
    /// Materials that faces refer to.
    pub materials: Vec<Material>,
    /// Textures that materials and lights refer to.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Viewpoints; the first is the default.
    pub cameras: Vec<Camera>,
    /// Radiance that arrives from everywhere outside the scene.
    pub sky: Radiance,
}

impl SceneBuilder {
    /// Checks, cleans and freezes the scene. What had to be left out is in the warnings.
    ///
    /// Triangles with positions that are not finite or with an area below 1e-12 of the squared diagonal are
    /// dropped. Missing normals are made; vertices are split where neighbouring faces turn sharply. Faces of
    /// two-sided materials get a second face for the back, with vertices of its own. The order of vertices is kept,
    /// split-off ones follow those of their object, and those of back sides come last.
    ///
    /// # Errors
    /// Anything that cannot be mended: see [`SceneError`].
    pub fn build(mut self) -> Result<(Scene, Warnings), SceneError> {
        let mut warnings = Warnings::default();
        self.check_materials()?;
        check_lights(&self.lights, self.textures.len())?;
        if !self.sky.0.is_finite() || self.sky.0.min_element() < 0.0 {
            return Err(SceneError::BadSky);
        }
        self.check_size()?;
        for object in &self.objects {
            object.check(self.materials.len())?;
        }
        self.clamp_albedo(&mut warnings);
        let smallest = 1e-12 * self.diagonal_squared();
        let mut faces = FaceList::default();
        for (id, mut object) in std::mem::take(&mut self.objects).into_iter().enumerate() {
            object.drop_degenerate(smallest, &mut warnings);
            normals::fill_missing(&mut object, &mut warnings);
            object.split_at_creases();
            faces.append(ObjectId(id as u32), object);
        }
        if faces.triangles.is_empty() {
            return Err(SceneError::Empty { scene: self.name });
        }
        let two_sided: Vec<bool> = self.materials.iter().map(|m| m.sides == Sides::Both).collect();
        faces.add_back_sides(&two_sided);
        if faces.positions.len() > MAX_TRIANGLES || faces.triangles.len() > MAX_TRIANGLES {
            return Err(SceneError::TooLarge { scene: self.name, triangles: faces.triangles.len() as u64 });
        }
        Ok((Scene::new(self, faces), warnings))
    }

    /// Squared diagonal of the bounds of all finite positions; in f64, where it cannot overflow.
    pub(crate) fn diagonal_squared(&self) -> f64 {
        let finite = self.objects.iter().flat_map(|o| &o.positions).filter(|p| p.is_finite());
        let (min, max) = finite.fold((Vec3::MAX, Vec3::MIN), |(min, max), p| (min.min(*p), max.max(*p)));
        if min.x > max.x { 0.0 } else { (max.as_dvec3() - min.as_dvec3()).length_squared() }
    }

    fn check_size(&self) -> Result<(), SceneError> {
        let triangles = self.objects.iter().map(|o| o.faces.len() as u64).sum();
        let vertices: u64 = self.objects.iter().map(|o| o.positions.len() as u64).sum();
        if triangles > MAX_TRIANGLES as u64 || vertices > MAX_TRIANGLES as u64 {
            return Err(SceneError::TooLarge { scene: self.name.clone(), triangles });
        }
        Ok(())
    }

    fn check_materials(&self) -> Result<(), SceneError> {
        for material in &self.materials {
            let used = [material.albedo_texture, material.emission_texture, material.normal_texture];
            for texture in used.into_iter().flatten() {
                let user = || format!("material \"{}\"", material.name);
                check_texture(texture.texture, self.textures.len(), user)?;
            }
        }
        Ok(())
    }

    fn clamp_albedo(&mut self, warnings: &mut Warnings) {
        let mut clamped: Vec<&str> = Vec::new();
        let mut highest: f32 = 0.0;
        for material in &mut self.materials {
            let subject = format!("material \"{}\"", material.name);
            if !material.albedo.is_finite() || !material.emission.0.is_finite() {
                warnings.push(&subject, "colour is not a finite number: black is used instead");
            }
            material.albedo = sound(material.albedo);
            material.emission = Radiance(sound(material.emission.0));
            let texture =
                material.albedo_texture.map_or(Vec3::ONE, |t| self.textures[t.texture.index()].max());
            let brightest = (material.albedo * texture).max_element();
            if brightest > MAX_ALBEDO {
                highest = highest.max(brightest);
                clamped.push(&material.name);
            }
        }
        // One warning for all: exporters leave white as the default of every material.
        if let [first, others @ ..] = clamped.as_slice() {
            let subject = match others {
                [] => format!("material \"{first}\""),
                [second] => format!("materials \"{first}\" and \"{second}\""),
                [second, rest @ ..] => format!("materials \"{first}\", \"{second}\" and {} more", rest.len()),
            };
            warnings.push(subject, format!("albedo of up to {highest:.3} is clamped to {MAX_ALBEDO}"));
        }
    }
}

/// Checks the lights of a scene with so many textures.
pub(crate) fn check_lights(lights: &[Light], n_textures: usize) -> Result<(), SceneError> {
    for (index, light) in lights.iter().enumerate() {
        if let Light::Rect(RectLight { texture: Some(texture), .. }) = light {
            check_texture(*texture, n_textures, || format!("light {index}"))?;
        }
        if let Some(problem) = light_problem(light) {
            return Err(SceneError::BadLight { index, problem });
        }
    }
    Ok(())
}

fn check_texture(texture: TextureId, count: usize, user: impl Fn() -> String) -> Result<(), SceneError> {
    if texture.index() < count {
        return Ok(());
    }
    Err(SceneError::BadTexture { user: user(), index: texture.0, count })
}

fn light_problem(light: &Light) -> Option<&'static str> {
    let bad_power = |v: Vec3| !v.is_finite() || v.min_element() < 0.0;
    match light {
        Light::Rect(rect) => {
            let (lu, lv) = (rect.u.length(), rect.v.length());
            if !(rect.center.is_finite() && rect.u.is_finite() && rect.v.is_finite()) {
                Some("centre and half-edges must be finite")
            } else if lu <= 0.0 || lv <= 0.0 {
                Some("the rectangle has no area")
            } else if rect.u.dot(rect.v).abs() > 1e-3 * lu * lv {
                // 1e-3: about 0.06 degrees, more than rounding to three digits in a file can cause.
                Some("the half-edges u and v must be at a right angle")
            } else {
                bad_power(rect.radiance.0).then_some("the radiance must be finite and not negative")
            }
        }
        Light::Point(point) => point_problem(point.position, point.intensity),
        Light::Spot(spot) => point_problem(spot.point.position, spot.point.intensity)
            .or_else(|| (!spot.direction.is_normalized()).then_some("the direction must be a unit vector")),
        Light::Directional(sun) => {
            if bad_power(sun.irradiance) {
                Some("the irradiance must be finite and not negative")
            } else {
                (!sun.direction.is_normalized()).then_some("the direction must be a unit vector")
            }
        }
    }
}

fn point_problem(position: Vec3, intensity: Vec3) -> Option<&'static str> {
    if !position.is_finite() {
        Some("the position must be finite")
    } else {
        (!intensity.is_finite() || intensity.min_element() < 0.0)
            .then_some("the intensity must be finite and not negative")
    }
}

impl ObjectMesh {
    fn check(&self, n_materials: usize) -> Result<(), SceneError> {
        let vertices = self.positions.len();
        let counts = [
            ("normals", self.normals.len()),
            ("texture coordinates", self.uvs.len()),
            ("vertex colours", self.tints.len()),
        ];
        for (what, count) in counts {
            if count != 0 && count != vertices {
                return Err(SceneError::BadCount { object: self.name.clone(), what, count, vertices });
            }
        }
        for (face, f) in self.faces.iter().enumerate() {
            let bad = |what, index, count| SceneError::BadIndex {
                object: self.name.clone(),
                face,
                what,
                index,
                count,
            };
            if let Some(&index) = f.vertices.iter().find(|&&v| v as usize >= vertices) {
                return Err(bad("vertex", index, vertices));
            }
            if f.material.index() >= n_materials {
                return Err(bad("material", f.material.0, n_materials));
            }
        }
        Ok(())
    }

    /// The corners' positions of a face.
    pub fn corners(&self, face: &Face) -> [Vec3; 3] {
        face.vertices.map(|v| self.positions[v as usize])
    }

    fn drop_degenerate(&mut self, smallest_area: f64, warnings: &mut Warnings) {
        let subject = format!("object \"{}\"", self.name);
        let (positions, before) = (&self.positions, self.faces.len());
        self.faces.retain(|f| f.vertices.iter().all(|&v| positions[v as usize].is_finite()));
        let finite = self.faces.len();
        if finite < before {
            let n = before - finite;
            warnings.push(&subject, format!("{n} triangles dropped: their positions are not finite numbers"));
        }
        self.faces.retain(|f| {
            let [a, b, c] = f.vertices.map(|v| positions[v as usize].as_dvec3());
            0.5 * (b - a).cross(c - a).length() > smallest_area
        });
        if self.faces.len() < finite {
            warnings.push(
                &subject,
                format!("{} triangles dropped: they have no area", finite - self.faces.len()),
            );
        }
        for uv in &mut self.uvs {
            *uv = if uv.is_finite() { *uv } else { Vec2::ZERO };
        }
        for tint in &mut self.tints {
            *tint = if tint.is_finite() { tint.max(Vec3::ZERO) } else { Vec3::ONE };
        }
    }

    fn split_at_creases(&mut self) {
        let face_normals = normals::face_normals(self);
        let corners = Corners::by_vertex(self);
        let groups =
            corners.groups(&self.faces, |a, b| face_normals[a].dot(face_normals[b]) > LIGHTING_CREASE_COS);
        split_vertices(self, &groups);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{FaceSide, TriId};

    pub(crate) fn quad(name: &str) -> ObjectMesh {
        let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
        ObjectMesh {
            name: name.to_owned(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            faces: vec![face([0, 1, 2]), face([0, 2, 3])],
            ..ObjectMesh::default()
        }
    }

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
        for bad in [f32::NAN, -1.0, f32::INFINITY] {
            let mut b = builder(vec![quad("q")]);
            b.sky = Radiance::splat(bad);
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
