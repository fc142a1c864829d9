//! Lit meshes as OBJ, for programs that read little else.

mod material;
mod name;

use crate::display::{finite_irradiance, seen_radiance, srgb};
use crate::{ColorScale, ExportError, write_atomically};
use glam::{DVec3, Vec3};
use lumel_basis::{Lighting, VertexPoints};
use lumel_scene::{MaterialId, ObjectId, Scene, TriId};
use material::Materials;
use name::printable;
use std::collections::btree_map::{BTreeMap, Entry};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

/// How files of ours begin.
const MARK: &str = "# lumel";

/// Writes the lit scene as OBJ. Returns the exposure used.
///
/// `NAME.obj` comes with `NAME.mtl` and, where materials have textures, with PNG files in `NAME_textures`. A vertex has
/// `v x y z r g b`, whose colour is radiance times exposure on the sRGB curve, as that of [`write_ply`]; `vn`; and, in
/// a scene with textures, `vt`. Backs of two-sided surfaces are faces of their own with vertices of their own, because
/// OBJ cannot say that a material has two sides and the two are lit differently.
///
/// Irradiance itself has no place in OBJ: write PLY, GLB or a solution beside it. Programs that multiply vertex colours
/// with materials show the surface's colour twice; lumel knows its own files by their first comment and leaves the
/// colours out. Materials have `Kd`, `Ke`, `map_Kd` and `map_Ke`;
/// textures are sRGB of 8 bits, bytes of sRGB textures as they were. Textures that are turned on the surface have that
/// in the `vt` of their faces; where albedo and emission are turned differently, the emission is its mean. A texture
/// that is clamped in one direction only repeats in both. Vertex tints and normal maps are left out.
///
/// Each file appears whole or not at all, the OBJ file last. Textures of an older export stay where they are.
///
/// # Errors
/// Light of a different scene or that is not finite, an exposure that is not positive, conflicting files (see
/// [`check_obj`]), and the errors of [`write_atomically`].
///
/// [`write_ply`]: crate::write_ply
pub fn write_obj(
    path: &Path,
    scene: &Scene,
    lighting: &dyn Lighting,
    exposure: ColorScale,
) -> Result<f32, ExportError> {
    let irradiance = &*finite_irradiance(path, scene, lighting)?;
    let exposure = exposure.factor(path, irradiance)?;
    let files = Files::beside(path)?;
    files.check()?;
    let faces = faces(scene);
    let materials = Materials::new(scene, faces.keys().map(|(_, material)| *material), &files.folder_name);
    materials.write_textures(scene, &files.folder)?;
    let head = head(scene);
    write_atomically(&files.mtl, |out| {
        write!(out, "{head}")?;
        materials.write(out)
    })?;
    write_atomically(path, |out| {
        write!(out, "{head}{}\nmtllib {}\n", about(exposure), files.mtl_name)?;
        write_vertices(out, scene, irradiance, exposure, materials.have_textures())?;
        write_faces(out, scene, &faces, &materials)
    })?;
    Ok(exposure)
}

/// Checks that writing an OBJ file would not replace files beside it that lumel has not written.
///
/// # Errors
/// A material library that lumel has not written, or invalid names.
pub fn check_obj(path: &Path) -> Result<(), ExportError> {
    Files::beside(path)?.check()
}

/// The files that belong to an OBJ file.
struct Files {
    mtl: PathBuf,
    mtl_name: String,
    folder: PathBuf,
    folder_name: String,
}

impl Files {
    fn beside(path: &Path) -> Result<Self, ExportError> {
        let mtl = path.with_extension("mtl");
        if mtl == path {
            return Err(ExportError::content(path, "this is the name of the material library; use .obj"));
        }
        let Some(stem) = path.file_stem().and_then(|stem| stem.to_str()) else {
            return Err(ExportError::content(
                path,
                "the name must be valid Unicode because the file contains it",
            ));
        };
        let (mtl_name, folder_name) = (format!("{stem}.mtl"), format!("{stem}_textures"));
        Ok(Self { mtl, mtl_name, folder: path.with_file_name(&folder_name), folder_name })
    }

    fn check(&self) -> Result<(), ExportError> {
        if self.folder.exists() && !self.folder.is_dir() {
            let problem = "a folder of this name is needed for textures; choose another name";
            return Err(ExportError::content(&self.folder, problem));
        }
        // If it cannot be read, writing reports the reason.
        let Ok(old) = File::open(&self.mtl) else { return Ok(()) };
        let mut start = Vec::new();
        let _ = io::Read::take(BufReader::new(old), MARK.len() as u64).read_until(b'\n', &mut start);
        if start.is_empty() || start == MARK.as_bytes() {
            return Ok(());
        }
        let problem =
            "the material library of this name is not from lumel and would be replaced; choose another name";
        Err(ExportError::content(&self.mtl, problem))
    }
}

fn head(scene: &Scene) -> String {
    format!("{MARK} {}, scene {}\n", env!("CARGO_PKG_VERSION"), printable(scene.name()))
}

fn about(exposure: f32) -> String {
    format!(
        "# vertex colours: sRGB of radiance times {exposure}\n\
         # irradiance has no place in this format; a .ply, .glb or .npz has it\n"
    )
}

/// Triangles by object and material.
fn faces(scene: &Scene) -> BTreeMap<(ObjectId, MaterialId), Vec<TriId>> {
    let mut faces: BTreeMap<_, Vec<TriId>> = BTreeMap::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        faces.entry((scene.object_id(tri), scene.material_id(tri))).or_default().push(tri);
    }
    faces
}

fn write_vertices(
    out: &mut impl Write,
    scene: &Scene,
    irradiance: &[Vec3],
    exposure: f32,
    with_uvs: bool,
) -> io::Result<()> {
    let points = VertexPoints::new(scene);
    let lit_points = points.points().iter().zip(irradiance);
    for (&local, (&at, &e)) in scene.positions().iter().zip(lit_points) {
        let shown = seen_radiance(scene, at, e).0 * exposure;
        let [r, g, b] = shown.to_array().map(srgb);
        if scene.origin() == DVec3::ZERO {
            write!(out, "v {} {} {}", local.x, local.y, local.z)?;
        } else {
            let world = scene.to_world(local);
            write!(out, "v {} {} {}", world.x, world.y, world.z)?;
        }
        writeln!(out, " {r:.4} {g:.4} {b:.4}")?;
    }
    for n in scene.normals() {
        writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
    }
    for uv in scene.uvs().iter().filter(|_| with_uvs) {
        write_uv(out, *uv)?;
    }
    Ok(())
}

/// A coordinate whose `v` points down, in a format where it points up.
fn write_uv(out: &mut impl Write, uv: glam::Vec2) -> io::Result<()> {
    writeln!(out, "vt {} {}", uv.x, 1.0 - uv.y)
}

fn write_faces(
    out: &mut impl Write,
    scene: &Scene,
    faces: &BTreeMap<(ObjectId, MaterialId), Vec<TriId>>,
    materials: &Materials,
) -> io::Result<()> {
    let mut object = None;
    // Numbers count from 1. Coordinates of turned textures follow those of the vertices.
    let mut n_uvs = scene.vertex_count();
    for ((of, material), triangles) in faces {
        if object.replace(of) != Some(of) {
            writeln!(out, "o {}", printable(&scene.object_names()[of.index()]))?;
        }
        writeln!(out, "usemtl {}", materials.name(*material))?;
        let mut turned: BTreeMap<u32, usize> = BTreeMap::new();
        if let Some(transform) = materials.turned(*material) {
            for vertex in triangles.iter().flat_map(|&tri| scene.triangle(tri)) {
                if let Entry::Vacant(new) = turned.entry(vertex) {
                    write_uv(out, transform.apply(scene.uvs()[vertex as usize]))?;
                    n_uvs += 1;
                    new.insert(n_uvs);
                }
            }
        }
        for &tri in triangles {
            write!(out, "f")?;
            for vertex in scene.triangle(tri) {
                let v = vertex as usize + 1;
                if materials.have_textures() {
                    write!(out, " {v}/{}/{v}", turned.get(&vertex).unwrap_or(&v))?;
                } else {
                    write!(out, " {v}//{v}")?;
                }
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
