//! A scene on the device.

use crate::batches::{Group, grouped};
use crate::corners::{Corners, Place};
use crate::layout::MaterialValues;
use crate::memory::{buffer, within_memory};
use crate::pipelines::{Detail, Layouts};
use crate::texture::{Blank, Image};
use crate::{Gpu, RenderError};
use glam::{Vec2, Vec3, Vec4};
use lumel_scene::{MaterialId, Scene};
use lumel_uv::Atlas;
use std::ops::Range;
use std::sync::Arc;

/// The surfaces of a scene on the device: geometry, materials and textures.
#[derive(Debug)]
pub struct Model {
    vertices: usize,
    triangles: usize,
    /// The vertex of the scene that each of the device is, if they differ.
    pub(crate) sources: Option<Arc<[u32]>>,
    /// Distance of the near plane, metres.
    pub(crate) near: f32,
    pub(crate) positions: wgpu::Buffer,
    pub(crate) normals: wgpu::Buffer,
    pub(crate) uvs: wgpu::Buffer,
    /// A single one where the scene has none.
    pub(crate) tangents: wgpu::Buffer,
    /// In the atlas; a single one where there is none.
    pub(crate) places: wgpu::Buffer,
    /// A single one where the scene has none.
    pub(crate) tints: wgpu::Buffer,
    /// For batches without tints.
    pub(crate) no_tint: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    /// All materials; batches hold the offset of theirs.
    pub(crate) materials: wgpu::BindGroup,
    material_values: wgpu::Buffer,
    groups: Vec<Group>,
    pub(crate) batches: Vec<Batch>,
    /// For rectangle lights without texture.
    pub(crate) plain_rect_light: wgpu::BindGroup,
    /// For rectangle lights with one, in the order of the scene's textures.
    pub(crate) textured_rect_lights: Vec<wgpu::BindGroup>,
}

/// Triangles that are drawn at once.
#[derive(Debug)]
pub(crate) struct Batch {
    pub(crate) indices: Range<u32>,
    pub(crate) detail: Detail,
    pub(crate) has_normal_map: bool,
    pub(crate) material_id: MaterialId,
    /// Offset of the material, bytes.
    pub(crate) material: u32,
    pub(crate) textures: wgpu::BindGroup,
}

/// The near plane in diagonals of the scene. Nearer planes cost precision on triangles close to the camera.
const NEAR: f32 = 1e-4;

/// Alignment of materials in their buffer: the largest that a device may require.
const MATERIAL_STRIDE: usize = 256;

impl Model {
    /// Number of vertices, which light buffers must match.
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// Number of triangles, back sides included.
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Whether its surfaces have places in an atlas.
    pub fn has_atlas(&self) -> bool {
        self.sources.is_some()
    }

    /// Number of index entries.
    pub(crate) fn all_indices(&self) -> Range<u32> {
        0..3 * self.triangles as u32
    }

    /// Takes the materials of a scene that differs in albedos only.
    pub(crate) fn repaint(&self, gpu: &Gpu, scene: &Scene) {
        gpu.queue().write_buffer(&self.material_values, 0, &values_of(scene, &self.groups));
    }

    pub(crate) fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        blank: &Blank,
        scene: &Scene,
        atlas: Option<&Atlas>,
    ) -> Result<Self, RenderError> {
        let (corners, groups) = grouped(scene, atlas);
        check_size(gpu, scene, corners.sources.as_ref().map_or(scene.vertex_count(), |s| s.len()))?;
        let what = format!("scene \"{}\"", scene.name());
        let upload = || Self::upload(gpu, layouts, blank, scene, &corners, groups);
        let model = within_memory(gpu, &what, upload)?;
        // Frees temporary copies.
        gpu.queue().submit([]);
        Ok(model)
    }

    fn upload(
        gpu: &Gpu,
        layouts: &Layouts,
        blank: &Blank,
        scene: &Scene,
        corners: &Corners,
        groups: Vec<Group>,
    ) -> Self {
        let images: Vec<Image> = scene.textures().iter().map(|t| blank.upload(gpu, t)).collect();
        let has_tints = groups.iter().any(|group| group.detail.tint);
        let tints = if has_tints { corners.of(scene.tints()) } else { vec![Vec3::ONE] };
        let tangents = match scene.tangents() {
            [] => vec![Vec4::ZERO],
            tangents => corners.of(tangents),
        };
        let places = if corners.places.is_empty() { &[Place::default()][..] } else { &corners.places };
        let batch = |(slot, group): (usize, &Group)| {
            let material = &scene.materials()[group.material];
            let alpha = material.transparency.texture;
            let normals = material.normal_texture.map(|map| map.image);
            let maps = [material.albedo_texture, material.emission_texture, normals, alpha];
            Batch {
                indices: group.indices.clone(),
                detail: group.detail,
                has_normal_map: material.normal_texture.is_some() && !scene.tangents().is_empty(),
                material_id: MaterialId(group.material as u32),
                material: (slot * MATERIAL_STRIDE) as u32,
                textures: blank.textures(gpu, layouts, &images, maps),
            }
        };
        let vertices = |label, bytes: &[u8]| buffer(gpu, label, wgpu::BufferUsages::VERTEX, bytes);
        let numbers = |label, values: &[Vec3]| vertices(label, bytemuck::cast_slice(&finite(values)));
        let rect_light = |image| blank.rect_light(gpu, layouts, image);
        let normals = corners.of(scene.normals()).into_iter().map(|normal| normal.extend(0.0));
        let values = values_of(scene, &groups);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let material_values = buffer(gpu, "materials", usage, &values);
        Self {
            vertices: scene.vertex_count(),
            triangles: scene.triangle_count(),
            // The diagonal of a scene may be tiny or overflow.
            near: (NEAR * scene.bounds().diagonal()).clamp(1e-12, 1e30),
            sources: corners.sources.clone(),
            positions: numbers("positions", &corners.of(scene.positions())),
            normals: vertices("normals", bytemuck::cast_slice(&packed(normals))),
            uvs: vertices("texture coordinates", bytemuck::cast_slice(&finite_uvs(&corners.of(scene.uvs())))),
            tangents: vertices("tangents", bytemuck::cast_slice(&packed(tangents))),
            places: vertices("places", bytemuck::cast_slice(places)),
            tints: numbers("tints", &tints),
            no_tint: numbers("no tint", &[Vec3::ONE]),
            indices: buffer(
                gpu,
                "indices",
                wgpu::BufferUsages::INDEX,
                bytemuck::cast_slice(&corners.indices),
            ),
            materials: materials(gpu, layouts, &material_values),
            material_values,
            batches: groups.iter().enumerate().map(batch).collect(),
            groups,
            plain_rect_light: rect_light(None),
            textured_rect_lights: images.iter().map(|image| rect_light(Some(image))).collect(),
        }
    }
}

/// One material per group.
fn values_of(scene: &Scene, groups: &[Group]) -> Vec<u8> {
    let mut bytes = vec![0; groups.len() * MATERIAL_STRIDE];
    for (slot, group) in bytes.chunks_exact_mut(MATERIAL_STRIDE).zip(groups) {
        let values = MaterialValues::new(&scene.materials()[group.material]);
        slot[..size_of::<MaterialValues>()].copy_from_slice(bytemuck::bytes_of(&values));
    }
    bytes
}

fn materials(gpu: &Gpu, layouts: &Layouts, values: &wgpu::Buffer) -> wgpu::BindGroup {
    let one = wgpu::BufferBinding {
        buffer: values,
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<MaterialValues>() as u64),
    };
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("materials"),
        layout: &layouts.material,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(one) }],
    })
}

/// The largest buffers, light included.
fn check_size(gpu: &Gpu, scene: &Scene, vertices: usize) -> Result<(), RenderError> {
    let limit = gpu.device().limits().max_buffer_size;
    let per_vertex = size_of::<[f32; 3]>() as u64;
    let per_triangle = size_of::<[u32; 3]>() as u64;
    let parts = [
        ("vertices", vertices as u64 * per_vertex),
        ("triangles", scene.triangle_count() as u64 * per_triangle),
    ];
    match parts.into_iter().find(|(_, bytes)| *bytes > limit) {
        Some((what, bytes)) => {
            Err(RenderError::TooLarge { scene: scene.name().to_owned(), what, bytes, limit })
        }
        None => Ok(()),
    }
}

/// Numbers that are not finite become zero: shaders may do anything with them.
fn finite(values: &[Vec3]) -> Vec<[f32; 3]> {
    values.iter().map(|v| v.to_array().map(|x| if x.is_finite() { x } else { 0.0 })).collect()
}

fn finite_uvs(uvs: &[Vec2]) -> Vec<[f32; 2]> {
    uvs.iter().map(|uv| if uv.is_finite() { uv.to_array() } else { [0.0; 2] }).collect()
}

/// Unit vectors in 16 bits per axis: half a thousandth of a degree.
fn packed(vectors: impl IntoIterator<Item = Vec4>) -> Vec<[i16; 4]> {
    let pack = |x: f32| (x.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round() as i16;
    vectors.into_iter().map(|v| v.to_array().map(pack)).collect()
}
