//! Light as pictures and files read it.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use glam::Vec3;
use lumel_basis::Basis;
use lumel_basis::{
    Coefficients, Directional, Field, FieldLighting, Lighting, VertexBasis, VertexCountError, VertexLighting,
    VertexPoints, irradiance_at_vertices,
};
use lumel_scene::{Barycentrics, Irradiance, Scene, SurfacePoint, TriId};
use lumel_testkit::mesh::{Facing, sphere};
use lumel_testkit::scene::{grey, two_sided};
use std::sync::Arc;

/// A ball whose inside is lit too: front and back have vertices of their own.
fn ball() -> Arc<Scene> {
    let mesh = sphere(Vec3::ZERO, 1.0, 1, Facing::Outward, 0);
    let builder = lumel_testkit::scene::scene(vec![mesh], vec![two_sided(grey(0.5, 0.0))], Vec::new());
    Arc::new(builder.build().unwrap().0)
}

fn different_values(scene: &Scene) -> Vec<Vec3> {
    (0..scene.vertex_count()).map(|v| Vec3::new(v as f32, 0.1, -0.7)).collect()
}

#[test]
fn light_that_is_not_stored_at_vertices_is_sampled_there_with_their_normals() {
    let scene = ball();
    let lighting = |at: SurfacePoint, normal: Vec3| Irradiance(scene.position(at) + 10.0 * normal);
    let values = irradiance_at_vertices(&scene, &lighting).unwrap();
    let vertices = scene.positions().iter().zip(scene.normals());
    let expected: Vec<Vec3> = vertices.map(|(position, normal)| *position + 10.0 * *normal).collect();
    assert_eq!(*values, *expected);
}

#[test]
fn light_that_is_stored_at_vertices_is_read_as_it_is() {
    let scene = ball();
    let stored = different_values(&scene);
    let lighting = VertexLighting::new(&scene, &stored).unwrap();
    let values = irradiance_at_vertices(&scene, &lighting).unwrap();
    assert!(std::ptr::eq(&*values, &*stored), "nothing is copied");
    let sampled = |at: SurfacePoint, normal: Vec3| lighting.irradiance(at, normal);
    assert_eq!(*irradiance_at_vertices(&scene, &sampled).unwrap(), *stored, "samples would be the same");
}

#[test]
fn light_at_vertices_is_linear_over_triangles() {
    let scene = ball();
    let lighting = VertexLighting::new(&scene, scene.positions()).unwrap();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let at = SurfacePoint { tri, bary: Barycentrics { u: 0.2, v: 0.7 } };
        assert_eq!(lighting.irradiance(at, Vec3::Y).0, scene.position(at));
    }
}

#[test]
fn light_at_the_vertices_of_another_scene_is_refused() {
    struct Other([Vec3; 3]);
    impl Lighting for Other {
        fn irradiance(&self, _at: SurfacePoint, _normal: Vec3) -> Irradiance {
            Irradiance::ZERO
        }
        fn vertex_values(&self) -> Option<&[Vec3]> {
            Some(&self.0)
        }
    }
    let scene = ball();
    let error = VertexCountError { values: 3, vertices: scene.vertex_count() };
    let other = Other([Vec3::ONE; 3]);
    assert_eq!(VertexLighting::new(&scene, &other.0).unwrap_err(), error);
    assert_eq!(irradiance_at_vertices(&scene, &other).unwrap_err(), error);
}

#[test]
fn fields_are_read_at_vertices_as_their_basis_reads_them() {
    let scene = ball();
    let basis = VertexBasis::new(Arc::clone(&scene));
    let field = Field::from_values(different_values(&scene)[..basis.node_count()].to_vec());
    let lighting = FieldLighting { basis: &basis, field: &field };
    let values = irradiance_at_vertices(&scene, &lighting).unwrap();
    assert_eq!(*values, *VertexPoints::new(&scene).read(&basis, &field));
}

#[test]
fn light_by_direction_is_read_as_irradiance_is() {
    let scene = ball();
    let basis = VertexBasis::new(Arc::clone(&scene));
    let vertices = scene.positions();
    for kind in [Directional::Sh1, Directional::Sh2] {
        let coefficient = |position: Vec3, i: usize| position * (1.0 + i as f32);
        let of_vertex = |p: &Vec3| (0..kind.harmonics()).map(|i| coefficient(*p, i)).collect::<Vec<_>>();
        let coefficients: Vec<Vec3> = vertices.iter().flat_map(of_vertex).collect();
        let channels = vertices.iter().flat_map(|p| [vec![*p], of_vertex(p)].concat()).collect();
        let field = Field::with_channels(kind.channels(), channels);
        let at_vertices = VertexLighting::new(&scene, vertices).unwrap();
        let few = Coefficients::new(kind, coefficients[kind.harmonics()..].to_vec()).unwrap();
        assert!(at_vertices.with_incident(Some(&few)).is_err());
        let coefficients = Coefficients::new(kind, coefficients).unwrap();
        let at_vertices = at_vertices.with_incident(Some(&coefficients)).unwrap();
        let of_field = FieldLighting { basis: &basis, field: &field };
        for tri in (0..scene.triangle_count() as u32).step_by(7).map(TriId) {
            let at = SurfacePoint { tri, bary: Barycentrics { u: 0.2, v: 0.7 } };
            for light in [at_vertices.incident(at).unwrap(), of_field.incident(at).unwrap()] {
                assert_eq!(light.kind(), kind);
                for (i, c) in light.coefficients().iter().enumerate() {
                    let expected =
                        if i < kind.harmonics() { coefficient(scene.position(at), i) } else { Vec3::ZERO };
                    assert!((*c - expected).length() < 1e-5, "{c} {expected}");
                }
            }
        }
    }
    let scalar = VertexLighting::new(&scene, vertices).unwrap();
    assert_eq!(scalar.incident(SurfacePoint { tri: TriId(0), bary: Barycentrics { u: 0.2, v: 0.7 } }), None);
}
