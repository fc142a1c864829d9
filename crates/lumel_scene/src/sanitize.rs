//! What can be mended in a scene is mended, with a warning.

use crate::material::sound;
use crate::mesh::{Face, ObjectMesh};
use crate::runs::Runs;
use crate::transparency::{Look, Looks};
use crate::{AlphaMode, MAX_ALBEDO, Material, Radiance, Texture, Transparency, Warnings, triangle};
use glam::{Vec2, Vec3};

/// Drops the triangles of an object that are nowhere there. Returns the numbers of those that are kept.
pub(crate) fn absent_faces(mesh: &mut ObjectMesh, looks: &Looks, warnings: &mut Warnings) -> Vec<u32> {
    for alpha in &mut mesh.alphas {
        *alpha = if alpha.is_finite() { alpha.clamp(0.0, 1.0) } else { 1.0 };
    }
    let faces = std::mem::take(&mut mesh.faces);
    let n_faces = faces.len();
    let is_there = |face: &Face| looks.of(face.material.index(), mesh.corner_alphas(face)) != Look::Absent;
    let (numbers, kept): (Vec<u32>, Vec<Face>) = (0..).zip(faces).filter(|(_, face)| is_there(face)).unzip();
    if kept.len() < n_faces {
        let message = format!("{} triangles dropped: they are fully transparent", n_faces - kept.len());
        warnings.push(format!("object \"{}\"", mesh.name), message);
    }
    mesh.faces = kept;
    numbers
}

/// Triangles below this share of the squared diagonal of their scene are dropped.
const SMALLEST_SHARE: f64 = 1e-12;

/// How small triangles may be.
pub(crate) struct Smallest {
    /// The diagonal of the scene, metres.
    pub(crate) diagonal: f64,
    /// Whether any was smaller.
    pub(crate) was_undercut: bool,
}

impl Smallest {
    /// In a scene with this squared diagonal, m².
    pub(crate) fn of(diagonal_squared: f64) -> Self {
        Self { diagonal: diagonal_squared.sqrt(), was_undercut: false }
    }
}

/// Drops the triangles of an object that are smaller than that or have positions that are not finite, and
/// makes its attributes finite. Returns which of the faces, which have these `numbers`, are kept.
pub(crate) fn object(
    mesh: &mut ObjectMesh,
    numbers: Vec<u32>,
    smallest: &mut Smallest,
    warnings: &mut Warnings,
) -> Runs {
    let positions = &mesh.positions;
    let smallest_area = SMALLEST_SHARE * smallest.diagonal * smallest.diagonal;
    let (mut n_infinite, mut n_flat, mut n_tiny) = (0, 0, 0);
    let mut kept = Runs::default();
    let mut numbers = numbers.into_iter();
    mesh.faces.retain(|face| {
        let corners = face.vertices.map(|v| positions[v as usize]);
        let is_finite = corners.iter().all(|p| p.is_finite());
        let area = if is_finite { triangle::area(corners) } else { 0.0 };
        let has_area = area > smallest_area;
        n_infinite += usize::from(!is_finite);
        n_flat += usize::from(is_finite && area == 0.0);
        n_tiny += usize::from(area > 0.0 && !has_area);
        kept.extend(numbers.next().filter(|_| has_area));
        has_area
    });
    let subject = format!("object \"{}\"", mesh.name);
    if n_infinite > 0 {
        warnings.push(
            &subject,
            format!("{n_infinite} triangles dropped: their positions are not finite numbers"),
        );
    }
    if n_flat > 0 {
        warnings.push(&subject, format!("{n_flat} triangles dropped: they have no area"));
    }
    if n_tiny > 0 {
        smallest.was_undercut = true;
        let across = smallest.diagonal;
        warnings.push(
            &subject,
            format!(
                "{n_tiny} triangles dropped: they are smaller than a millionth of the scene, which is {across:.3} m across; \
                 move what lies far away nearer"
            ),
        );
    }
    for uv in &mut mesh.uvs {
        *uv = if uv.is_finite() { *uv } else { Vec2::ZERO };
    }
    if let Some(factor) = mesh.density_factor.take_if(|factor| !(*factor > 0.0 && factor.is_finite())) {
        let message = format!("its density factor is {factor}, which is not above 0: it is ignored");
        warnings.push(&subject, message);
    }
    mesh.tints.iter_mut().for_each(|tint| *tint = sound_tint(*tint));
    kept
}

/// Makes the transparency of a material one that light can have.
fn transparency(material: &mut Material, subject: &str, warnings: &mut Warnings) {
    let emits = material.emits();
    let transparency = &mut material.transparency;
    let cutoff = match transparency.mode {
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.0,
    };
    if !(transparency.alpha.is_finite() && transparency.transmission.is_finite() && cutoff.is_finite()) {
        warnings.push(subject, "transparency is not a finite number: it is treated as opaque");
        *transparency = Transparency::default();
    }
    transparency.alpha = transparency.alpha.clamp(0.0, 1.0);
    transparency.transmission = transparency.transmission.clamp(Vec3::ZERO, Vec3::ONE);
    if emits && transparency.transmission != Vec3::ZERO {
        warnings.push(subject, "it emits light, so no light passes through it: its transmission is ignored");
        material.albedo += transparency.transmission;
        material.transparency.transmission = Vec3::ZERO;
    }
}

/// A vertex colour that can multiply an albedo.
fn sound_tint(tint: Vec3) -> Vec3 {
    if tint.is_finite() { tint.max(Vec3::ZERO) } else { Vec3::ONE }
}

/// The largest vertex colour in each channel that multiplies each material; 1 where none does.
fn brightest_tints(objects: &[ObjectMesh], n_materials: usize) -> Vec<Vec3> {
    let mut brightest = vec![None; n_materials];
    for object in objects {
        for face in &object.faces {
            let slot: &mut Option<Vec3> = &mut brightest[face.material.index()];
            let tint = |v: &u32| object.tints.get(*v as usize).map_or(Vec3::ONE, |tint| sound_tint(*tint));
            let largest = face.vertices.iter().map(tint).fold(Vec3::ZERO, Vec3::max);
            *slot = Some(slot.map_or(largest, |known| known.max(largest)));
        }
    }
    brightest.into_iter().map(|tint| tint.unwrap_or(Vec3::ONE)).collect()
}

/// Makes colours finite and not negative. Warns of albedos that [`Scene::albedo`](crate::Scene::albedo) clamps, with
/// the vertex colours that multiply them.
pub(crate) fn materials(
    materials: &mut [Material],
    textures: &[Texture],
    objects: &[ObjectMesh],
    warnings: &mut Warnings,
) {
    let tints = brightest_tints(objects, materials.len());
    let mut clamped: Vec<String> = Vec::new();
    let mut highest: f32 = 0.0;
    for (material, tint) in materials.iter_mut().zip(tints) {
        let subject = format!("material \"{}\"", material.name);
        if !material.albedo.is_finite() || !material.emission.0.is_finite() {
            warnings.push(&subject, "colour is not a finite number: black is used instead");
        }
        material.albedo = sound(material.albedo);
        material.emission = Radiance(sound(material.emission.0));
        transparency(material, &subject, warnings);
        if let Some(map) = material.normal_texture.as_mut().filter(|map| !map.scale.is_finite()) {
            warnings.push(&subject, "the scale of its normal map is not a finite number: 1 is used instead");
            map.scale = Vec2::ONE;
        }
        let texture = material.albedo_texture.map_or(Vec3::ONE, |t| textures[t.texture.index()].max());
        let brightest = (material.albedo * texture * tint).max_element();
        if brightest > MAX_ALBEDO {
            highest = highest.max(brightest);
            clamped.push(format!("\"{}\"", material.name));
        }
    }
    warnings.push_for_all(
        "material",
        &clamped,
        format!("albedo of up to {highest:.3} is clamped to {MAX_ALBEDO}"),
    );
}
