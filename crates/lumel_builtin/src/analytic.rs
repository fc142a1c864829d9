//! Closed rooms whose light is known exactly.

use crate::shapes::{add_quad, object};
use glam::{Vec2, Vec3};
use lumel_scene::{
    Camera, Face, Material, MaterialId, ObjectMesh, Radiosity, SceneBuilder, Smoothing, Texture, TextureId,
    TextureRef, Wrap,
};
use std::collections::HashMap;

/// Cells along an edge of the furnace.
const FURNACE_CELLS: u32 = 8;

/// Times the faces of the icosahedron are split into four: 5120 triangles.
const SPHERE_LEVEL: u32 = 4;

/// The unit cube around the origin, seen from inside: albedo 0.5 and radiosity 1 W·m⁻² everywhere.
///
/// Every point sees the same light whatever its place: irradiance is `1 + 1/2 + 1/4 + … = 2` W·m⁻² in the end, and
/// its first terms after as many bounces.
pub(crate) fn furnace(subdivide: u32) -> SceneBuilder {
    let mut cube = object("furnace");
    for (s, t) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
        let inward = s.cross(t);
        for (s, t, inward) in [(s, t, inward), (t, s, -inward)] {
            let corners = [-s - t, s - t, s + t, t - s].map(|corner| 0.5 * (corner - inward));
            add_quad(&mut cube, MaterialId(0), corners, [FURNACE_CELLS << subdivide; 2]);
        }
    }
    let mut material = Material::diffuse("emissive grey", Vec3::splat(0.5));
    material.emission = Radiosity::splat(1.0).radiance();
    SceneBuilder {
        name: "furnace".to_owned(),
        objects: vec![cube],
        materials: vec![material],
        cameras: vec![Camera::looking_at("inside", Vec3::new(0.0, 0.0, 0.45), Vec3::ZERO, 1.2)],
        ..SceneBuilder::default()
    }
}

/// The unit sphere seen from inside: albedo `0.5 + 0.3 z`, radiosity of the emission `1 + z` W·m⁻².
///
/// Inside a sphere light falls evenly wherever it comes from, so irradiance is the mean emission over one minus the
/// mean albedo: 2 W·m⁻² everywhere. The albedo is in vertex colours, the emission in a texture of two texels.
pub(crate) fn sphere(subdivide: u32) -> SceneBuilder {
    /// Vertex colours multiply this; it keeps the material itself within what albedos may be.
    const BRIGHTEST: f32 = 0.8;
    let mut mesh = icosphere(SPHERE_LEVEL + subdivide);
    mesh.normals = mesh.positions.iter().map(|p| -*p).collect();
    mesh.tints = mesh.positions.iter().map(|p| Vec3::splat((0.5 + 0.3 * p.z) / BRIGHTEST)).collect();
    // Between the centres of the two texels, at 1/4 and 3/4, lookup is linear.
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(0.5, 0.5 - 0.25 * p.z)).collect();
    let mut ramp = Texture::from_floats("emission ramp", 1, 2, vec![[2.0; 3], [0.0; 3]]);
    ramp.iter_mut().for_each(|ramp| ramp.wrap_v = Wrap::Clamp);
    let mut material = Material::diffuse("emissive sphere", Vec3::splat(BRIGHTEST));
    material.emission = Radiosity::splat(1.0).radiance();
    material.emission_texture = Some(TextureRef::plain(TextureId(0)));
    SceneBuilder {
        name: "sphere".to_owned(),
        objects: vec![mesh],
        materials: vec![material],
        textures: ramp.into_iter().collect(),
        cameras: vec![Camera::looking_at("inside", Vec3::new(0.0, -0.9, 0.0), Vec3::ZERO, 1.2)],
        ..SceneBuilder::default()
    }
}

/// A unit icosphere that faces inward: 20 · 4^level triangles, no vertex twice.
fn icosphere(level: u32) -> ObjectMesh {
    let mut mesh = icosahedron();
    for _ in 0..level {
        let mut middles = HashMap::new();
        for face in std::mem::take(&mut mesh.faces) {
            let [a, b, c] = face.vertices;
            let positions = &mut mesh.positions;
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum = positions[a.min(b) as usize] + positions[a.max(b) as usize];
                    positions.push(on_sphere(sum));
                    positions.len() as u32 - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            for vertices in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                mesh.faces.push(Face { vertices, ..face });
            }
        }
    }
    mesh
}

fn icosahedron() -> ObjectMesh {
    let mut mesh = object("sphere");
    let golden = 0.5 + 1.25_f32.sqrt();
    for (x, y) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        for corner in [Vec3::new(x, y, 0.0), Vec3::new(0.0, x, y), Vec3::new(y, 0.0, x)] {
            mesh.positions.push(on_sphere(corner));
        }
    }
    // Its faces are the triples of neighbours, 1.051 apart; other pairs of corners are at least 1.7 apart.
    let near = |a: usize, b: usize| mesh.positions[a].distance(mesh.positions[b]) < 1.4;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [p, q, r] = [a, b, c].map(|v| mesh.positions[v]);
                    let inward = (q - p).cross(r - p).dot(p) < 0.0;
                    let vertices = if inward { [a, b, c] } else { [a, c, b] }.map(|v| v as u32);
                    let smoothing = Smoothing::Group(1);
                    mesh.faces.push(Face { vertices, material: MaterialId(0), smoothing });
                }
            }
        }
    }
    mesh
}

/// The unit vector along `p`, rounded once.
fn on_sphere(p: Vec3) -> Vec3 {
    p.as_dvec3().normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};

    fn area(scene: &Scene) -> f64 {
        (0..scene.triangle_count()).map(|t| f64::from(scene.area(TriId(t as u32)))).sum()
    }

    fn faces_inward(scene: &Scene) -> bool {
        (0..scene.triangle_count() as u32).map(TriId).all(|t| {
            let [a, b, c] = scene.triangle_positions(t);
            scene.geometric_normal(t).dot(a + b + c) < 0.0
        })
    }

    /// Every edge has a partner that runs the other way, by position.
    fn is_closed(scene: &Scene) -> bool {
        let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut edges = HashMap::new();
        for t in 0..scene.triangle_count() as u32 {
            let p = scene.triangle_positions(TriId(t)).map(bits);
            for k in 0..3 {
                *edges.entry((p[k], p[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1))
    }

    #[test]
    fn the_furnace_is_a_closed_unit_cube_seen_from_inside() {
        let (scene, _) = furnace(0).build().unwrap();
        assert_eq!(scene.triangle_count(), 6 * 8 * 8 * 2);
        assert!((area(&scene) - 6.0).abs() < 1e-5);
        assert!(faces_inward(&scene) && is_closed(&scene));
        let at = SurfacePoint::default();
        assert_eq!(scene.albedo(at).0, Vec3::splat(0.5));
        assert!((scene.emission(at).radiosity().0 - Vec3::ONE).length() < 1e-6);
    }

    #[test]
    fn the_sphere_is_closed_and_round() {
        for (level, n, tolerance) in [(0, 5120, 4e-3), (1, 20_480, 1e-3)] {
            let (scene, _) = sphere(level).build().unwrap();
            assert_eq!((scene.triangle_count(), scene.vertex_count()), (n, n / 2 + 2));
            let round = 2.0 * 360_f64.to_radians();
            assert!((area(&scene) / round - 1.0).abs() < tolerance, "{}", area(&scene));
            assert!(faces_inward(&scene) && is_closed(&scene));
            let radial =
                |(p, n): (&Vec3, &Vec3)| (p.length() - 1.0).abs() < 1e-6 && (*p + *n).length() < 1e-6;
            assert!(scene.positions().iter().zip(scene.normals()).all(radial));
        }
    }

    #[test]
    fn albedo_and_emission_of_the_sphere_are_linear_in_z() {
        let (scene, _) = sphere(0).build().unwrap();
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            for bary in Barycentrics::CORNERS.into_iter().chain([[0.2, 0.5].into()]) {
                let at = SurfacePoint { tri, bary };
                let z = scene.position(at).z;
                let (albedo, emission) = (scene.albedo(at).0, scene.emission(at).radiosity().0);
                assert!((albedo - Vec3::splat(0.5 + 0.3 * z)).abs().max_element() < 1e-6, "{z}: {albedo}");
                assert!((emission - Vec3::splat(1.0 + z)).abs().max_element() < 1e-6, "{z}: {emission}");
            }
        }
    }

    #[test]
    fn means_over_the_sphere_are_those_of_the_exact_solution() {
        let (scene, _) = sphere(0).build().unwrap();
        let (mut albedo, mut emission, mut whole) = (0.0, 0.0, 0.0);
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            let at = SurfacePoint { tri, bary: [1.0 / 3.0, 1.0 / 3.0].into() };
            let a = f64::from(scene.area(tri));
            albedo += a * f64::from(scene.albedo(at).0.x);
            emission += a * f64::from(scene.emission(at).radiosity().0.x);
            whole += a;
        }
        assert!((emission / whole / (1.0 - albedo / whole) - 2.0).abs() < 1e-4);
    }
}
