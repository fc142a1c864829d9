use crate::scenes::{AtVertices, colourful, light_on};
use glam::Vec3;
use lumel_export::{ColorScale, ExportError, write_ply};
use std::fs;

const VERTEX_SIZE: usize = 9 * 4 + 3;
const FACE_SIZE: usize = 1 + 3 * 4;

#[test]
fn the_header_describes_the_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let scene = colourful();
    let light = light_on(&scene);
    assert_eq!(write_ply(&path, &scene, &AtVertices(light.clone()), ColorScale::Factor(0.25)).unwrap(), 0.25);
    let bytes = fs::read(&path).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    let expected = format!(
        "ply\nformat binary_little_endian 1.0\ncomment lumel {}, scene bunte Räume \n",
        env!("CARGO_PKG_VERSION")
    );
    assert!(header.starts_with(&expected), "{header}");
    let (n, m) = (scene.vertex_count(), scene.triangle_count());
    assert!(header.contains(&format!("element vertex {n}\nproperty float x\n")));
    assert!(header.contains("property float irradiance_b\nproperty uchar red\n"));
    assert!(
        header.ends_with(&format!("element face {m}\nproperty list uchar int vertex_indices\nend_header\n"))
    );
    let (vertices, faces) = bytes[end..].split_at(n * VERTEX_SIZE);
    assert_eq!(faces.len(), m * FACE_SIZE);
    for (i, vertex) in vertices.chunks(VERTEX_SIZE).enumerate() {
        let floats: Vec<f32> = vertex[..36].as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect();
        assert_eq!(Vec3::from_slice(&floats), scene.positions()[i]);
        assert_eq!(Vec3::from_slice(&floats[3..]), scene.normals()[i]);
        assert_eq!(Vec3::from_slice(&floats[6..]), light[i]);
    }
    for (face, triangle) in faces.chunks(FACE_SIZE).zip(scene.triangles()) {
        assert_eq!(face[0], 3);
        let indices = face[1..].as_chunks().0.iter().map(|&b| u32::from_le_bytes(b));
        assert!(indices.eq(*triangle));
    }
    // The lamp's 15 W/m2/sr are white at this exposure, black stays black.
    let color = |v: usize| &vertices[v * VERTEX_SIZE + 36..][..3];
    let vertex_of = |name: &str| {
        let tri = (0..m as u32).map(lumel_scene::TriId).find(|&t| scene.material(t).name == name).unwrap();
        scene.triangle(tri)[2] as usize
    };
    assert_eq!(color(vertex_of("lamp")), [255; 3]);
    // Its albedo is 0.6 and 0.05, its light reddish: 12 and 24 times the linear values.
    let red = color(vertex_of("red \"wall\""));
    assert!(red[0] / 3 > red[1] && red[1] > red[2], "{red:?}");
}

#[test]
fn light_that_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let scene = colourful();
    let error = write_ply(&path, &scene, &AtVertices(vec![Vec3::ONE]), ColorScale::Auto).unwrap_err();
    assert!(matches!(error, ExportError::Content { .. }));
    assert!(!path.exists());
}
