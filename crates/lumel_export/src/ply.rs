//! Lit meshes as PLY, for viewers of points and meshes.

use crate::display::{finite_irradiance, seen_radiance, srgb_byte};
use crate::{ColorScale, ExportError, write_atomically};
use glam::{DVec3, Vec3};
use lumel_basis::{Lighting, VertexPoints};
use lumel_scene::Scene;
use std::io::{self, Write};
use std::path::Path;

/// Writes the lit scene as binary little-endian PLY, atomically. Returns the exposure used.
///
/// A vertex has `x y z`, in double precision where a scene is far from its world's origin, `nx ny nz`, `irradiance_r irradiance_g irradiance_b` in W·m⁻² and `red green blue`: radiance
/// times exposure on the sRGB curve. Its albedo and emission are those of the first triangle it belongs to.
///
/// # Errors
/// Light of a different scene or that is not finite, an exposure that is not positive, and the errors of
/// [`write_atomically`].
pub fn write_ply(
    path: &Path,
    scene: &Scene,
    lighting: &dyn Lighting,
    exposure: ColorScale,
) -> Result<f32, ExportError> {
    let irradiance = &*finite_irradiance(path, scene, lighting)?;
    let exposure = exposure.factor(path, irradiance)?;
    write_atomically(path, |out| {
        out.write_all(header(scene, exposure).as_bytes())?;
        write_vertices(out, scene, irradiance, exposure)?;
        write_faces(out, scene)
    })?;
    Ok(exposure)
}

fn header(scene: &Scene, exposure: f32) -> String {
    let name: String = scene.name().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let mut text = format!(
        "ply\nformat binary_little_endian 1.0\n\
         comment lumel {version}, scene {name}\n\
         comment irradiance in W/m^2 (lux if the lights are photometric), linear Rec. 709\n\
         comment red green blue: sRGB of radiance times {exposure}\n\
         element vertex {n_vertices}\n",
        version = env!("CARGO_PKG_VERSION"),
        n_vertices = scene.vertex_count(),
    );
    let coordinate = if has_own_origin(scene) { "double" } else { "float" };
    for name in ["x", "y", "z"] {
        text.push_str(&format!("property {coordinate} {name}\n"));
    }
    let floats = ["nx", "ny", "nz", "irradiance_r", "irradiance_g", "irradiance_b"];
    for name in floats {
        text.push_str(&format!("property float {name}\n"));
    }
    for name in ["red", "green", "blue"] {
        text.push_str(&format!("property uchar {name}\n"));
    }
    text.push_str(&format!("element face {}\n", scene.triangle_count()));
    text.push_str("property list uchar int vertex_indices\nend_header\n");
    text
}

fn write_vertices(out: &mut impl Write, scene: &Scene, irradiance: &[Vec3], exposure: f32) -> io::Result<()> {
    let points = VertexPoints::new(scene);
    for (vertex, (&e, &at)) in irradiance.iter().zip(points.points()).enumerate() {
        let position = scene.positions()[vertex];
        if has_own_origin(scene) {
            for number in scene.to_world(position).to_array() {
                out.write_all(&number.to_le_bytes())?;
            }
        } else {
            write_floats(out, position)?;
        }
        write_floats(out, scene.normals()[vertex])?;
        write_floats(out, e)?;
        let shown = seen_radiance(scene, at, e).0 * exposure;
        out.write_all(&shown.to_array().map(srgb_byte))?;
    }
    Ok(())
}

/// Whether single precision would not hold positions in world space.
fn has_own_origin(scene: &Scene) -> bool {
    scene.origin() != DVec3::ZERO
}

fn write_floats(out: &mut impl Write, vector: Vec3) -> io::Result<()> {
    vector.to_array().iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

fn write_faces(out: &mut impl Write, scene: &Scene) -> io::Result<()> {
    for triangle in scene.triangles() {
        out.write_all(&[3])?;
        for vertex in triangle {
            // Indices of a scene fit in 31 bits.
            out.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}
