//! Recognising a scene.

use crate::face_list::FaceList;
use crate::{Filter, Light, Material, Sky, Texture};
use glam::DVec3;
use std::fmt;

/// What a solution must agree with to belong to a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneHash {
    /// Positions, normals and triangles: a solution of the same geometry can be shown.
    pub geometry: blake3::Hash,
    /// Materials, textures, lights and sky: a solution of the same lighting can be continued.
    pub lighting: blake3::Hash,
}

/// Where hashing the lighting has got to before lights and sky, which is nearly all the work: what all scenes with the
/// same surfaces have in common.
#[derive(Clone, Debug)]
pub(crate) struct SurfacesHash(Bytes);

impl SurfacesHash {
    /// That of a scene, whatever its lights.
    pub(crate) fn of(faces: &FaceList, materials: &[Material], textures: &[Texture]) -> Self {
        Self(surfaces(faces, materials, textures))
    }

    /// The hash of the lighting under these lights.
    pub(crate) fn lit_by(&self, lights: &[Light], sky: &Sky) -> blake3::Hash {
        let mut lighting = self.0.clone();
        match sky {
            Sky::Uniform(radiance) => lighting.push(format!("{lights:?} {radiance:?}").as_bytes()),
            Sky::Gradient(gradient) => lighting.push(format!("{lights:?} {gradient:?}").as_bytes()),
            Sky::Image(image) => {
                let [rotation, strength] = [image.rotation(), image.strength()];
                lighting.push(format!("{lights:?} {rotation:?} {strength:?}").as_bytes());
                push_texture(&mut lighting, image.texture());
            }
        }
        lighting.finish()
    }
}

impl fmt::Display for SceneHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", &self.geometry.to_hex()[..16])
    }
}

pub(crate) fn geometry(faces: &FaceList, origin: DVec3) -> blake3::Hash {
    let mut bytes = Bytes::default();
    if origin != DVec3::ZERO {
        origin.to_array().iter().for_each(|coordinate| bytes.push(&coordinate.to_le_bytes()));
    }
    for v in faces.positions.iter().chain(&faces.normals) {
        bytes.floats(v.to_array());
    }
    for triangle in &faces.triangles {
        for index in triangle {
            bytes.push(&index.to_le_bytes());
        }
    }
    bytes.finish()
}

fn surfaces(faces: &FaceList, materials: &[Material], textures: &[Texture]) -> Bytes {
    let mut bytes = Bytes::default();
    for material in &faces.materials {
        bytes.push(&material.0.to_le_bytes());
    }
    for material in materials {
        // Debug output is a complete and stable rendering of these plain numbers; names do not matter.
        let anonymous = Material { name: String::new(), ..material.clone() };
        bytes.push(format!("{anonymous:?}").as_bytes());
    }
    for texture in textures {
        push_texture(&mut bytes, texture);
    }
    for uv in &faces.uvs {
        bytes.floats(uv.to_array());
    }
    for tint in &faces.tints {
        bytes.floats(tint.to_array());
    }
    for &alpha in &faces.alphas {
        bytes.floats([alpha]);
    }
    bytes
}

fn push_texture(bytes: &mut Bytes, texture: &Texture) {
    let (width, height) = texture.size();
    bytes.push(format!("{width} {height} {:?} {:?}", texture.wrap_u, texture.wrap_v).as_bytes());
    // Linear ones have the hash they had before there were others.
    if texture.filter == Filter::Nearest {
        bytes.push(b"nearest");
    }
    if let Some((rgba, encoding)) = texture.bytes() {
        bytes.push(format!("{encoding:?}").as_bytes());
        bytes.push(rgba.as_flattened());
    } else {
        for y in 0..height {
            for x in 0..width {
                bytes.floats(texture.texel(x, y).to_array());
            }
        }
    }
}

/// Feeds the hasher in large portions: it is several times as fast as with a few bytes at a time.
#[derive(Clone, Debug, Default)]
struct Bytes {
    hasher: blake3::Hasher,
    pending: Vec<u8>,
}

impl Bytes {
    const PORTION: usize = 1 << 16;

    fn push(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
        if self.pending.len() >= Self::PORTION {
            self.hasher.update(&self.pending);
            self.pending.clear();
        }
    }

    fn floats<const N: usize>(&mut self, values: [f32; N]) {
        for value in values {
            self.push(&value.to_le_bytes());
        }
    }

    fn finish(mut self) -> blake3::Hash {
        self.hasher.update(&self.pending);
        self.hasher.finalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::quad;
    use crate::{Light, Material, MaterialId, Radiance, RectLight, SceneBuilder};
    use glam::Vec3;

    const LIGHT: RectLight = RectLight {
        center: Vec3::ZERO,
        u: Vec3::X,
        v: Vec3::Y,
        radiance: Radiance::splat(1.0),
        texture: None,
    };

    /// Two squares of different materials under a light.
    fn squares() -> SceneBuilder {
        let mut upper = quad("upper");
        upper.positions.iter_mut().for_each(|p| p.z += 1.0);
        upper.faces.iter_mut().for_each(|face| face.material = MaterialId(1));
        SceneBuilder {
            objects: vec![quad("lower"), upper],
            materials: [0.2, 0.5].map(|albedo| Material::diffuse("grey", Vec3::splat(albedo))).to_vec(),
            lights: vec![Light::Rect(LIGHT)],
            ..SceneBuilder::default()
        }
    }

    fn hash_of(change: impl Fn(&mut SceneBuilder)) -> SceneHash {
        let mut builder = squares();
        change(&mut builder);
        builder.build().unwrap().0.hash()
    }

    #[test]
    fn a_relit_scene_has_the_hash_of_one_built_with_its_lights() {
        let mut builder = squares();
        let scene = builder.clone().build().unwrap().0;
        builder.lights = vec![Light::Rect(RectLight { radiance: Radiance::splat(2.0), ..LIGHT }); 2];
        let relit = scene.relit(builder.lights.clone()).unwrap();
        assert_eq!(relit.hash(), builder.build().unwrap().0.hash());
        assert_eq!(relit.hash().geometry, scene.hash().geometry);
        assert_ne!(relit.hash().lighting, scene.hash().lighting);
        assert_eq!(relit.relit(scene.lights().to_vec()).unwrap().hash(), scene.hash());
    }

    #[test]
    fn a_scene_under_another_sky_has_the_hash_of_one_built_with_it() {
        let mut builder = squares();
        let scene = builder.clone().build().unwrap().0;
        builder.sky = Radiance::splat(0.3).into();
        let under_sky = scene.under_sky(builder.sky.clone()).unwrap();
        assert_eq!(under_sky.hash(), builder.build().unwrap().0.hash());
        assert_ne!(under_sky.hash().lighting, scene.hash().lighting);
        assert!(under_sky.has_surfaces_of(&scene));
        assert_eq!(under_sky.relit(Vec::new()).unwrap().sky(), under_sky.sky());
    }

    #[test]
    fn a_repainted_scene_has_the_hash_of_one_built_with_its_albedos() {
        let mut builder = squares();
        let scene = builder.clone().build().unwrap().0;
        let albedos: Vec<Vec3> = (0..builder.materials.len()).map(|i| Vec3::splat(0.1 * i as f32)).collect();
        builder.materials.iter_mut().zip(&albedos).for_each(|(material, albedo)| material.albedo = *albedo);
        let repainted = scene.repainted(&albedos);
        assert_eq!(repainted.hash(), builder.build().unwrap().0.hash());
        assert_eq!(repainted.hash().geometry, scene.hash().geometry);
        assert_ne!(repainted.hash().lighting, scene.hash().lighting);
        assert!(!repainted.has_surfaces_of(&scene));
    }

    #[test]
    fn moving_a_vertex_changes_the_geometry_and_a_light_only_the_lighting() {
        let original = hash_of(|_| ());
        assert_eq!(original, hash_of(|b| b.name = "other".into()));
        let moved = hash_of(|b| b.objects[0].positions[0].x += 1e-3);
        assert_ne!(original.geometry, moved.geometry);
        let lit = hash_of(|b| b.lights.push(Light::Rect(LIGHT)));
        assert_eq!((original.geometry, false), (lit.geometry, original.lighting == lit.lighting));
        let repainted = hash_of(|b| b.materials[0].albedo *= 0.9);
        assert_eq!((original.geometry, false), (repainted.geometry, original.lighting == repainted.lighting));
    }
}
