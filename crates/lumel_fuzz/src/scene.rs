//! Scene files: read and built.

use crate::folder::with_files;
use lumel_import::{ImportOptions, load};
use lumel_scene::{FaceSide, ObjectId, SceneBuilder, TriId, Warnings, rounding_of};
use std::path::Path;

/// Larger scenes are read but not built, so that thousands of inputs are tried per second.
const MAX_BUILT: usize = 10_000;

/// How far the length of a unit normal may be from one: the rounding of a normalisation.
const UNIT: f32 = 1e-4;

/// An OBJ file beside the materials it may name, `a.mtl`.
pub(crate) fn obj(input: &[u8]) {
    let materials: &[u8] = b"newmtl a\nKd 1 0 0\nmap_Kd grey.png\nnewmtl b\nKe 4 4 4\n";
    with_files(&[("a.obj", input), ("a.mtl", materials)], read);
}

/// A material library that an OBJ file names.
pub(crate) fn mtl(input: &[u8]) {
    let mesh: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
        usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 3/3 2/2 1/1\n";
    with_files(&[("a.obj", mesh), ("a.mtl", input)], read);
}

/// A glTF file, as text or binary, beside a buffer, `a.bin`.
pub(crate) fn gltf(input: &[u8]) {
    // Zeros, then the floats 1.0 and 2.0 in turn: as positions, triangles with an area.
    let mut buffer = vec![0; 64];
    buffer.extend((0..64).flat_map(|i| [0.0, 1.0, 0.0, 0.0, 2.0_f32][i % 5].to_le_bytes()));
    let name = if input.starts_with(b"glTF") { "a.glb" } else { "a.gltf" };
    with_files(&[(name, input), ("a.bin", &buffer)], read);
}

/// A PLY file.
pub(crate) fn ply(input: &[u8]) {
    with_files(&[("a.ply", input)], read);
}

fn read(path: &Path) {
    match load(path, &ImportOptions::default()) {
        Ok(imported) => {
            check_warnings(&imported.warnings);
            build(imported.scene);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Builds a scene unless it is large, and checks what every scene promises.
pub(crate) fn build(builder: SceneBuilder) {
    let sizes = builder.objects.iter().map(|object| object.positions.len() + object.faces.len());
    if sizes.sum::<usize>() > MAX_BUILT {
        return;
    }
    let (given, origin) = (builder.objects.clone(), builder.origin);
    let (scene, warnings) = match builder.build() {
        Ok(built) => built,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    check_warnings(&warnings);
    assert!(scene.positions().iter().all(|position| position.is_finite()));
    for normal in scene.normals() {
        assert!((normal.length() - 1.0).abs() < UNIT, "{normal}");
    }
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let corners = scene.triangle(tri);
        assert!(corners.iter().all(|&corner| (corner as usize) < scene.vertex_count()));
        let normal = scene.geometric_normal(tri);
        assert!((normal.length() - 1.0).abs() < UNIT, "triangle {tri:?}: {normal}");
        assert!(scene.area(tri) >= 0.0);
        let at = lumel_scene::SurfacePoint { tri, bary: [0.25, 0.5].into() };
        let albedo = scene.albedo(at).0;
        assert!(albedo.min_element() >= 0.0 && albedo.max_element() <= lumel_scene::MAX_ALBEDO, "{albedo}");
        let emission = scene.emission(at).0;
        assert!(emission.is_finite() && emission.min_element() >= 0.0, "{emission}");
    }
    for (object, mesh) in given.iter().enumerate() {
        let input = scene.input_mesh(ObjectId(object as u32));
        assert_eq!((input.vertex_count(), input.face_count()), (mesh.positions.len(), mesh.faces.len()));
        for (number, face) in mesh.faces.iter().enumerate() {
            if let Some(corners) = input.corners(number, FaceSide::Front) {
                for (corner, given) in corners.into_iter().zip(mesh.corners(face)) {
                    let local = scene.positions()[corner as usize];
                    let exact = given.as_dvec3() + origin - scene.origin();
                    let noise = f64::EPSILON * scene.origin().length();
                    let allowed = rounding_of(local.abs().max_element()) + noise;
                    assert!((local.as_dvec3() - exact).abs().max_element() <= allowed, "{local} for {exact}");
                }
            }
        }
    }
    assert!(!scene.hash().geometry.to_hex().is_empty());
}

fn check_warnings(warnings: &Warnings) {
    assert!(warnings.iter().all(|warning| !warning.to_string().is_empty()));
}
