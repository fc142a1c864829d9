//! The immutable scene that everything else reads.

use crate::bounds::Bounds;
use crate::builder::SceneBuilder;
use crate::face_list::FaceList;
use crate::hash::{self, SurfacesHash};
use crate::light_names;
use crate::material::sound;
use crate::refine::Refinement;
use crate::shells::Shells;
use crate::transparency::mean;
use crate::{
    Albedo, AlphaMode, Barycentrics, Camera, FaceSide, Light, MAX_ALBEDO, Material, MaterialId, ObjectId,
    Radiance, SceneError, SceneHash, Sky, SurfacePoint, Texture, TextureRef, TriId, check, triangle,
};
use glam::{DVec3, Vec2, Vec3, Vec4};
use std::sync::{Arc, OnceLock};

/// Surfaces and lights; never changes after it is built. Coordinates are relative to an [origin](Self::origin).
///
/// The first [`Scene::traced_count`] triangles are what rays meet. Two-sided ones among them have a second triangle
/// for their back, after those, with reversed corners and vertices of its own: light on the two sides of a thin wall
/// never mixes, and every triangle is lit from its front only. Where two triangles were given in one place, back to back, the
/// second is the back of the first.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shared by all scenes that differ in their lights and skies only.
    unlit: Arc<Unlit>,
    lights: Vec<Light>,
    sky: Sky,
    /// One for each light; no part of the hash.
    light_names: Arc<[String]>,
    /// Made when it is first asked for: every checkpoint names it.
    hash: OnceLock<SceneHash>,
}

/// All of a scene but its lights and its sky.
#[derive(Clone, Debug)]
struct Unlit {
    name: String,
    origin: DVec3,
    /// Shared, as are the textures, by scenes that differ in the albedos of their materials.
    faces: Arc<FaceList>,
    refinement: Option<Arc<Refinement>>,
    object_names: Vec<String>,
    materials: Vec<Material>,
    textures: Arc<[Texture]>,
    cameras: Vec<Camera>,
    bounds: Bounds,
    usual_size: OnceLock<f64>,
    /// Made when something first asks.
    shells: OnceLock<Shells>,
    geometry_hash: OnceLock<blake3::Hash>,
    surfaces_hash: OnceLock<SurfacesHash>,
}

/// The share of light that passes through what is there of a material, under a colour that multiplies it.
fn transmitted(material: &Material, paint: Vec3) -> Vec3 {
    (material.transparency.transmission * paint).clamp(Vec3::ZERO, Vec3::ONE)
}

impl Scene {
    pub(crate) fn new(builder: SceneBuilder, mut faces: FaceList) -> Self {
        let unlit = Unlit {
            name: builder.name,
            origin: builder.origin,
            bounds: Bounds::around(faces.positions.iter().copied()),
            object_names: std::mem::take(&mut faces.object_names),
            faces: Arc::new(faces),
            refinement: None,
            materials: builder.materials,
            textures: builder.textures.into(),
            cameras: builder.cameras,
            usual_size: OnceLock::new(),
            shells: OnceLock::new(),
            geometry_hash: OnceLock::new(),
            surfaces_hash: OnceLock::new(),
        };
        let light_names = light_names::complete(builder.light_names, builder.lights.len()).into();
        let (lights, sky) = (builder.lights, builder.sky);
        Self { unlit: Arc::new(unlit), lights, sky, light_names, hash: OnceLock::new() }
    }

    /// The same scene under other lights. Geometry, materials and textures are shared, not copied, and hashed once.
    ///
    /// Vertices and triangles keep their indices, so ray tracers and bases of the one scene serve the other. Lights
    /// may use the textures that the scene has, as before. They keep their names if there are as many as before.
    ///
    /// # Errors
    /// Lights that [`SceneBuilder::build`] would refuse.
    pub fn relit(&self, lights: Vec<Light>) -> Result<Self, SceneError> {
        check::lights(&lights, self.unlit.textures.len())?;
        let light_names = match self.lights.len() == lights.len() {
            true => Arc::clone(&self.light_names),
            false => light_names::complete(Vec::new(), lights.len()).into(),
        };
        let (unlit, sky) = (Arc::clone(&self.unlit), self.sky.clone());
        Ok(Self { unlit, lights, sky, light_names, hash: OnceLock::new() })
    }

    /// The same scene under another sky. As with other [lights](Self::relit), all else is shared.
    ///
    /// # Errors
    /// A sky that [`SceneBuilder::build`] would refuse.
    pub fn under_sky(&self, sky: Sky) -> Result<Self, SceneError> {
        check::sky(&sky)?;
        Ok(Self { sky, hash: OnceLock::new(), ..self.clone() })
    }

    /// The same scene under the lights and the sky of another one, whose textures it has.
    ///
    /// # Errors
    /// Lights with textures that it does not have.
    pub fn lit_like(&self, other: &Self) -> Result<Self, SceneError> {
        let lit = self.relit(other.lights.clone())?;
        let (sky, light_names) = (other.sky.clone(), Arc::clone(&other.light_names));
        Ok(Self { sky, light_names, ..lit })
    }

    /// The same scene whose lights have other names; see [`SceneBuilder::light_names`].
    #[must_use]
    pub fn with_light_names(self, names: Vec<String>) -> Self {
        let light_names = light_names::complete(names, self.lights.len()).into();
        Self { light_names, ..self }
    }

    /// The same scene whose materials have other albedos, one for each; those that textures multiply, too.
    ///
    /// Geometry and textures are shared, not copied, and vertices and triangles keep their indices. What is no number
    /// is black, as in [`SceneBuilder::build`].
    ///
    /// # Panics
    /// If there are not as many albedos as materials.
    pub fn repainted(&self, albedos: &[Vec3]) -> Self {
        assert_eq!(albedos.len(), self.materials().len(), "one albedo per material");
        let mut unlit = Unlit { surfaces_hash: OnceLock::new(), ..(*self.unlit).clone() };
        for (material, &albedo) in unlit.materials.iter_mut().zip(albedos) {
            material.albedo = sound(albedo);
        }
        Self { unlit: Arc::new(unlit), hash: OnceLock::new(), ..self.clone() }
    }

    /// The same scene with green of all normal maps the other way: that of files whose green points down is up then.
    #[must_use]
    pub fn with_green_flipped(&self) -> Self {
        let mut unlit = Unlit { surfaces_hash: OnceLock::new(), ..(*self.unlit).clone() };
        for map in unlit.materials.iter_mut().filter_map(|material| material.normal_texture.as_mut()) {
            *map = map.flipped();
        }
        Self { unlit: Arc::new(unlit), hash: OnceLock::new(), ..self.clone() }
    }

    /// The same scene with these triangles in place of those that they are parts of.
    pub(crate) fn with_refined(&self, faces: FaceList, refinement: Refinement) -> Self {
        self.with_faces(Arc::new(faces), Some(Arc::new(refinement)))
    }

    fn with_faces(&self, faces: Arc<FaceList>, refinement: Option<Arc<Refinement>>) -> Self {
        let unlit = Unlit {
            faces,
            refinement,
            usual_size: OnceLock::new(),
            shells: OnceLock::new(),
            geometry_hash: OnceLock::new(),
            surfaces_hash: OnceLock::new(),
            ..(*self.unlit).clone()
        };
        Self { unlit: Arc::new(unlit), hash: OnceLock::new(), ..self.clone() }
    }

    /// Whether both are [refined](Self::refined) from the same triangles, or are these.
    pub fn has_originals_of(&self, other: &Self) -> bool {
        let of = |scene: &Self| scene.refinement().map_or(scene.shared_faces(), Refinement::given).clone();
        Arc::ptr_eq(&of(self), &of(other))
    }

    /// The scene that this one was [refined](Self::refined) from, under the same lights.
    pub fn original(&self) -> Option<Self> {
        Some(self.with_faces(Arc::clone(self.refinement()?.given()), None))
    }

    /// Triangles and vertices, shared.
    pub(crate) fn shared_faces(&self) -> &Arc<FaceList> {
        &self.unlit.faces
    }

    /// How it was [refined](Self::refined), if it was.
    pub fn refinement(&self) -> Option<&Refinement> {
        self.unlit.refinement.as_deref()
    }

    /// Triangles and vertices, and where they come from.
    pub(crate) fn faces(&self) -> &FaceList {
        &self.unlit.faces
    }

    /// Whether the two are one scene, under whatever lights and sky: the same surfaces and materials.
    pub fn has_surfaces_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.unlit, &other.unlit)
    }

    /// The scene's name.
    pub fn name(&self) -> &str {
        &self.unlit.name
    }

    /// Where the coordinates of the scene have their zero in world space, metres.
    ///
    /// All positions in the scene, of vertices, lights and cameras, are relative to it, and so are those that are asked of
    /// it. It is zero unless the scene is [far](crate::origin_for) from there: the numbers then are those that the meshes
    /// were given with. [`to_world`](Self::to_world) and [`to_local`](Self::to_local) convert.
    pub fn origin(&self) -> DVec3 {
        self.unlit.origin
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.unlit.faces.positions.len()
    }

    /// Number of triangles, back sides included.
    pub fn triangle_count(&self) -> usize {
        self.unlit.faces.triangles.len()
    }

    /// Number of triangles that rays meet: the first ones.
    pub fn traced_count(&self) -> usize {
        self.unlit.faces.traced
    }

    /// Vertex positions relative to the [origin](Self::origin), metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.unlit.faces.positions
    }

    /// Vertex positions in world space, metres: for files.
    pub fn world_positions(&self) -> impl ExactSizeIterator<Item = DVec3> {
        self.positions().iter().map(|&local| self.to_world(local))
    }

    /// Vertex normals, unit length, on the lit side.
    pub fn normals(&self) -> &[Vec3] {
        &self.unlit.faces.normals
    }

    /// Texture coordinates of the vertices, `v` down; zero where the file has none.
    pub fn uvs(&self) -> &[Vec2] {
        &self.unlit.faces.uvs
    }

    /// Tangents of the vertices, unit length, and the sign of `normal × tangent`, along which normal maps have their top.
    /// Empty where no material has a normal map, else zero where there is none.
    pub fn tangents(&self) -> &[Vec4] {
        &self.unlit.faces.tangents
    }

    /// Places of the vertices in a lightmap, as files have them, `v` down: empty where no object has any, else no number for
    /// vertices that have none.
    pub fn lightmap_uvs(&self) -> &[Vec2] {
        &self.unlit.faces.lightmap_uvs
    }

    /// Vertex colours that multiply the albedo; one where the file has none.
    pub fn tints(&self) -> &[Vec3] {
        &self.unlit.faces.tints
    }

    /// Vertex alphas that multiply those of materials; empty where no file has any.
    pub fn alphas(&self) -> &[f32] {
        &self.unlit.faces.alphas
    }

    /// Vertex indices of all triangles.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.unlit.faces.triangles
    }

    /// Names of the objects; indexed by [`ObjectId`].
    pub fn object_names(&self) -> &[String] {
        &self.unlit.object_names
    }

    /// How much finer the lumels of each object are in a lightmap than those of others, usually 1; indexed by [`ObjectId`].
    pub fn density_factors(&self) -> &[f32] {
        &self.unlit.faces.density_factors
    }

    /// The materials; indexed by [`MaterialId`].
    pub fn materials(&self) -> &[Material] {
        &self.unlit.materials
    }

    /// The textures; indexed by [`TextureId`](crate::TextureId).
    pub fn textures(&self) -> &[Texture] {
        &self.unlit.textures
    }

    /// The lights.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// What the lights are called, one name for each. Lights that share a name belong together.
    pub fn light_names(&self) -> &[String] {
        &self.light_names
    }

    /// The viewpoints; the first is the default.
    pub fn cameras(&self) -> &[Camera] {
        &self.unlit.cameras
    }

    /// Light from outside the scene.
    pub fn sky(&self) -> &Sky {
        &self.sky
    }

    /// Bounds of all vertices.
    pub fn bounds(&self) -> Bounds {
        self.unlit.bounds
    }

    /// The root of the mean area of all triangles, metres.
    pub(crate) fn usual_size(&self) -> f64 {
        let area = |tri: u32| triangle::area(self.triangle_positions(TriId(tri)));
        let n = self.traced_count();
        *self.unlit.usual_size.get_or_init(|| ((0..n as u32).map(area).sum::<f64>() / n as f64).sqrt())
    }

    pub(crate) fn shells(&self) -> &Shells {
        self.unlit.shells.get_or_init(|| Shells::of_faces(&self.unlit.faces))
    }

    /// Hashes that tell this scene from others.
    pub fn hash(&self) -> SceneHash {
        let surfaces = || {
            self.unlit
                .surfaces_hash
                .get_or_init(|| SurfacesHash::of(&self.unlit.faces, self.materials(), self.textures()))
        };
        let lighting = || surfaces().lit_by(&self.lights, self.sky());
        *self.hash.get_or_init(|| SceneHash { geometry: self.geometry_hash(), lighting: lighting() })
    }

    /// [`SceneHash::geometry`] alone: textures are not looked at.
    pub fn geometry_hash(&self) -> blake3::Hash {
        *self.unlit.geometry_hash.get_or_init(|| hash::geometry(&self.unlit.faces, self.origin()))
    }

    /// Vertex indices of a triangle.
    #[inline]
    pub fn triangle(&self, tri: TriId) -> [u32; 3] {
        self.unlit.faces.triangles[tri.index()]
    }

    /// Corner positions of a triangle.
    #[inline]
    pub fn triangle_positions(&self, tri: TriId) -> [Vec3; 3] {
        let ([a, b, c], positions) = (self.triangle(tri), &self.unlit.faces.positions);
        [positions[a as usize], positions[b as usize], positions[c as usize]]
    }

    /// The object a triangle belongs to.
    pub fn object_id(&self, tri: TriId) -> ObjectId {
        self.unlit.faces.objects[tri.index()]
    }

    /// The material of a triangle.
    #[inline]
    pub fn material_id(&self, tri: TriId) -> MaterialId {
        self.unlit.faces.materials[tri.index()]
    }

    /// The material of a triangle.
    #[inline]
    pub fn material(&self, tri: TriId) -> &Material {
        &self.unlit.materials[self.material_id(tri).index()]
    }

    /// Unit normal from the winding of a triangle, computed in f64.
    pub fn geometric_normal(&self, tri: TriId) -> Vec3 {
        triangle::normal(self.triangle_positions(tri))
    }

    /// Area of a triangle, m², computed in f64.
    pub fn area(&self, tri: TriId) -> f32 {
        triangle::area(self.triangle_positions(tri)) as f32
    }

    /// The least distance of a triangle's corner from the opposite edge, metres, computed in f64.
    pub fn least_height(&self, tri: TriId) -> f64 {
        triangle::least_height(self.triangle_positions(tri))
    }

    /// Position of a surface point.
    #[inline]
    pub fn position(&self, at: SurfacePoint) -> Vec3 {
        self.interpolate(&self.unlit.faces.positions, at)
    }

    /// Interpolated vertex normal, unit length.
    pub fn shading_normal(&self, at: SurfacePoint) -> Vec3 {
        self.vertex_normal(at).try_normalize().unwrap_or_else(|| self.geometric_normal(at.tri))
    }

    /// The same as it is interpolated: of any length.
    pub(crate) fn vertex_normal(&self, at: SurfacePoint) -> Vec3 {
        self.interpolate(&self.unlit.faces.normals, at)
    }

    /// Interpolated texture coordinate.
    #[inline]
    pub fn uv(&self, at: SurfacePoint) -> Vec2 {
        let ([a, b, c], [wa, wb, wc]) = (self.triangle(at.tri), at.bary.weights());
        let uv = &self.unlit.faces.uvs;
        uv[a as usize] * wa + uv[b as usize] * wb + uv[c as usize] * wc
    }

    /// Albedo at a surface point, of what light does not pass through, clamped to [`MAX_ALBEDO`].
    #[inline]
    pub fn albedo(&self, at: SurfacePoint) -> Albedo {
        let material = self.material(at.tri);
        let (tint, texture) = (self.tint(at), self.texture_value(material.albedo_texture, at));
        let mut reflected = material.albedo * tint * texture;
        if material.transparency.transmission != Vec3::ZERO {
            // Of what does not pass: rays end there that much more seldom.
            let ending = 1.0 - mean(transmitted(material, tint * texture));
            reflected = if ending > 0.0 { reflected / ending } else { Vec3::ZERO };
        }
        Albedo(reflected.clamp(Vec3::ZERO, Vec3::splat(MAX_ALBEDO)))
    }

    #[inline]
    fn tint(&self, at: SurfacePoint) -> Vec3 {
        self.interpolate(&self.unlit.faces.tints, at)
    }

    /// Whether light passes through any triangle.
    pub fn has_transparent(&self) -> bool {
        !self.unlit.faces.transparent.is_empty()
    }

    /// Whether light passes through a triangle anywhere.
    #[inline]
    pub fn is_transparent(&self, tri: TriId) -> bool {
        self.unlit.faces.transparent.get(tri.index()).is_some_and(|&is| is)
    }

    /// Number of triangles that rays meet and light passes through.
    pub fn transparent_count(&self) -> usize {
        let traced = self.unlit.faces.transparent.iter().take(self.traced_count());
        traced.filter(|&&is_transparent| is_transparent).count()
    }

    /// The share of light that passes through a surface point, 0..=1.
    ///
    /// What is not there lets all of it through, what is there tints it.
    pub fn transmittance(&self, at: SurfacePoint) -> Vec3 {
        if !self.is_transparent(at.tri) {
            return Vec3::ZERO;
        }
        let material = self.material(at.tri);
        let coverage = self.coverage(material, at);
        let absent = Vec3::splat(1.0 - coverage);
        if material.transparency.transmission == Vec3::ZERO || coverage == 0.0 {
            return absent;
        }
        let paint = self.tint(at) * self.texture_value(material.albedo_texture, at);
        absent + transmitted(material, paint) * coverage
    }

    /// The share of rays that end at a surface point, 0..=1: one minus the mean transmittance of the channels. Those
    /// that do see the whole [albedo](Self::albedo) and [emission](Self::emission).
    pub fn opacity(&self, at: SurfacePoint) -> f32 {
        1.0 - mean(self.transmittance(at))
    }

    fn coverage(&self, material: &Material, at: SurfacePoint) -> f32 {
        let transparency = &material.transparency;
        if transparency.mode == AlphaMode::Opaque {
            return 1.0;
        }
        let texture = transparency
            .texture
            .map_or(1.0, |t| self.unlit.textures[t.texture.index()].alpha(t.transform.apply(self.uv(at))));
        let ([a, b, c], [wa, wb, wc]) = (self.unlit.faces.corner_alphas(at.tri.index()), at.bary.weights());
        // Weights do not sum to one exactly; what is the same at all corners is the same between.
        let vertices = if a == b && b == c { a } else { a * wa + b * wb + c * wc };
        transparency.coverage(texture * vertices)
    }

    /// The albedo of a triangle if it is the same everywhere on it.
    pub fn uniform_albedo(&self, tri: TriId) -> Option<Albedo> {
        let anywhere = SurfacePoint { tri, bary: Barycentrics { u: 1.0, v: 0.0 } };
        self.is_uniform(tri).then(|| self.albedo(anywhere))
    }

    fn is_uniform(&self, tri: TriId) -> bool {
        let tints = self.triangle(tri).map(|v| self.unlit.faces.tints[v as usize]);
        self.material(tri).albedo_texture.is_none() && tints.iter().all(|t| *t == tints[0])
    }

    /// Whether the albedo of any triangle differs from place to place on it.
    pub fn has_varying_albedo(&self) -> bool {
        (0..self.triangle_count() as u32).any(|tri| !self.is_uniform(TriId(tri)))
    }

    /// Emitted radiance at a surface point, on the front of its triangle.
    #[inline]
    pub fn emission(&self, at: SurfacePoint) -> Radiance {
        let material = self.material(at.tri);
        if !material.emits() {
            return Radiance::ZERO;
        }
        Radiance(material.emission.0 * self.texture_value(material.emission_texture, at))
    }

    /// The triangle that rays meet for this one: itself, or the front whose back it is.
    #[inline]
    pub fn traced(&self, tri: TriId) -> TriId {
        tri.min(self.unlit.faces.other_side[tri.index()])
    }

    /// Corners of a triangle that no ray meets: they are not finite. Others keep their numbers beside it.
    pub const UNTRACED: [Vec3; 3] = [Vec3::NAN; 3];

    /// The corners of the triangles that rays meet, by [`TriId`].
    ///
    /// Those of a triangle that is the back of another one are [`UNTRACED`](Self::UNTRACED).
    pub fn traced_corners(&self) -> Vec<[Vec3; 3]> {
        let corners =
            |tri| if self.traced(tri) == tri { self.triangle_positions(tri) } else { Self::UNTRACED };
        (0..self.traced_count() as u32).map(|tri| corners(TriId(tri))).collect()
    }

    /// Whether the back of a triangle is lit, too.
    pub fn is_two_sided(&self, tri: TriId) -> bool {
        self.unlit.faces.other_side[tri.index()] != tri
    }

    /// The lit surface point that a ray sees when it meets the traced triangle of `at` on `side`.
    ///
    /// `None` for the back of a one-sided triangle: it neither emits nor reflects.
    #[inline]
    pub fn seen_side(&self, at: SurfacePoint, side: FaceSide) -> Option<SurfacePoint> {
        if side == FaceSide::Front {
            return Some(at);
        }
        let other = self.unlit.faces.other_side[at.tri.index()];
        let bary = Barycentrics { u: at.bary.v, v: at.bary.u };
        (other != at.tri).then_some(SurfacePoint { tri: other, bary })
    }

    #[inline]
    fn texture_value(&self, texture: Option<TextureRef>, at: SurfacePoint) -> Vec3 {
        texture.map_or(Vec3::ONE, |t| {
            self.unlit.textures[t.texture.index()].sample(t.transform.apply(self.uv(at)))
        })
    }

    #[inline]
    fn interpolate(&self, values: &[Vec3], at: SurfacePoint) -> Vec3 {
        let ([a, b, c], [wa, wb, wc]) = (self.triangle(at.tri), at.bary.weights());
        values[a as usize] * wa + values[b as usize] * wb + values[c as usize] * wc
    }
}
