use crate::scenes::{AtVertices, colourful};
use glam::Vec3;
use lumel_basis::Lighting;
use lumel_export::{ColorScale, RadFile, write_glb, write_obj, write_ply};
use lumel_scene::{Irradiance, SurfacePoint};
use std::fs;

#[test]
fn light_of_any_kind_is_written_as_it_is_at_the_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let scene = colourful();
    let light = |position: Vec3, normal: Vec3| Vec3::splat(2.5) + normal + (3.0 * position).map(f32::sin);
    let anywhere = |at: SurfacePoint, normal: Vec3| Irradiance(light(scene.position(at), normal));
    let vertices = scene.positions().iter().zip(scene.normals());
    let stored = AtVertices(vertices.map(|(position, normal)| light(*position, *normal)).collect());
    let written = |lighting: &dyn Lighting| {
        ["a.glb", "a.ply", "a.obj", "a.rad"].map(|name| {
            let path = folder.path().join(name);
            match name {
                "a.glb" => drop(write_glb(&path, &scene, lighting, ColorScale::Auto).unwrap()),
                "a.ply" => drop(write_ply(&path, &scene, lighting, ColorScale::Auto).unwrap()),
                "a.obj" => drop(write_obj(&path, &scene, lighting, ColorScale::Auto).unwrap()),
                _ => RadFile::from_lighting(&scene, lighting).unwrap().write(&path).unwrap(),
            }
            fs::read(path).unwrap()
        })
    };
    assert!(written(&anywhere) == written(&stored));
    assert!(written(&anywhere) != written(&AtVertices(vec![Vec3::ONE; scene.vertex_count()])));
}
