//! The emissive triangles of a scene, and how evenly it shines.

use crate::texel_density::{Footprint, TexelDensity};
use crate::texel_sums::TexelSums;
use lumel_scene::{MaterialId, Scene, TextureRef, TriId, luminance};
use rayon::prelude::*;

/// A triangle's edge is split at most this often for its texture.
const MAX_SPLIT: usize = 1024;

/// Pieces of all textured triangles together, 8 bytes each.
const MAX_PIECES: f64 = (1u64 << 22) as f64;

/// A triangle that shines.
pub(crate) struct EmissiveTriangle {
    pub(crate) tri: TriId,
    /// Of those that are textured or let light through.
    pub(crate) density: Option<TexelDensity>,
}

impl EmissiveTriangle {
    /// Means of the luminance and of its square.
    fn moments(&self, scene: &Scene) -> [f64; 2] {
        let uniform = f64::from(luminance(scene.material(self.tri).emission.0));
        let textured = self.density.as_ref().map(|density| [density.mean(), density.mean_square()]);
        textured.unwrap_or([uniform, uniform * uniform])
    }
}

/// All triangles that shine, in their order; those that show black texels alone are left out.
pub(crate) fn emissive_triangles(scene: &Scene) -> Vec<EmissiveTriangle> {
    let all = || (0..scene.triangle_count() as u32).map(TriId).filter(|&tri| scene.material(tri).emits());
    let plain = all().filter(|&tri| scene.material(tri).emission_texture.is_none());
    let without_texture = |tri| {
        // What is not there everywhere emits as unevenly as a texture.
        let even = || TexelDensity::even(f64::from(luminance(scene.material(tri).emission.0)));
        EmissiveTriangle { tri, density: scene.is_transparent(tri).then(even).flatten() }
    };
    let mut shining: Vec<_> = plain.map(without_texture).collect();
    let mut tris: Vec<(MaterialId, TriId)> = all()
        .filter(|&tri| scene.material(tri).emission_texture.is_some())
        .map(|tri| (scene.material_id(tri), tri))
        .collect();
    tris.sort_unstable();
    let materials: Vec<&[(MaterialId, TriId)]> = tris.chunk_by(|a, b| a.0 == b.0).collect();
    let sums: Vec<Option<(TextureRef, TexelSums)>> =
        materials.iter().map(|tris| texel_sums(scene, tris[0].0)).collect();
    let footprints: Vec<Footprint<'_>> = materials
        .iter()
        .zip(&sums)
        .filter_map(|(tris, sums)| Some((tris, sums.as_ref()?)))
        .flat_map(|(tris, (texture, sums))| {
            tris.iter().filter_map(|(_, tri)| Footprint::new(scene, *texture, sums, *tri))
        })
        .collect();
    let wanted: f64 = footprints.iter().map(|at| 2.0 * (at.wanted(MAX_SPLIT) as f64).powi(2)).sum();
    let scale = (MAX_PIECES / wanted).sqrt().min(1.0);
    let textured = footprints.par_iter().filter_map(|at| {
        let n = ((at.wanted(MAX_SPLIT) as f64 * scale) as usize).max(1);
        let density = TexelDensity::new(scene, at, n)?;
        Some(EmissiveTriangle { tri: at.tri, density: Some(density) })
    });
    shining.par_extend(textured);
    shining.sort_unstable_by_key(|triangle| triangle.tri);
    shining
}

fn texel_sums(scene: &Scene, material: MaterialId) -> Option<(TextureRef, TexelSums)> {
    let material = &scene.materials()[material.index()];
    let texture = material.emission_texture?;
    let brightness = |texel| luminance(material.emission.0 * texel);
    Some((texture, TexelSums::new(&scene.textures()[texture.texture.index()], brightness)?))
}

/// The share of all surface over which the emitted power is spread: all if everything shines the same, little if most power
/// comes from a few texels.
pub(crate) fn even_share(scene: &Scene, shining: &[EmissiveTriangle]) -> f64 {
    let area = |tri| f64::from(scene.area(tri));
    let (mut power, mut square) = (0.0, 0.0);
    for triangle in shining {
        let [mean, mean_square] = triangle.moments(scene);
        power += area(triangle.tri) * mean;
        square += area(triangle.tri) * mean_square;
    }
    let all: f64 = (0..scene.triangle_count() as u32).map(|tri| area(TriId(tri))).sum();
    if square > 0.0 { power * power / (square * all) } else { 0.0 }
}
