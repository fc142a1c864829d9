//! Light at scattered points.

use crate::light::number;
use crate::memory::{buffer, within_memory};
use crate::pipelines::Layouts;
use crate::shaders::MAX_LEVELS;
use crate::{Gpu, RenderError};
use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3};
use lumel_basis::{CloudPoint, DIRECTIONS, PointCloud};

/// Storage buffers that the shader reads.
pub(crate) const BUFFERS: u32 = 4;

/// The number of the clearance of a point around which nothing stands: `OPEN` in `gather.wgsl`.
const OPEN: u32 = u32::MAX;

/// The points of a [`PointCloud`] and a linear RGB value for each, on the device: usually coefficients of irradiance, W·m⁻².
///
/// They are sorted by the cells of a grid for each level, so that a pixel finds those around it. Values are kept in 32 bits.
#[derive(Debug)]
pub struct PointBuffer {
    /// Of each value, the number of its point.
    order: Vec<u32>,
    levels: u32,
    settings: wgpu::Buffer,
    values: wgpu::Buffer,
    pub(crate) group: wgpu::BindGroup,
}

/// A point: `gather.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Node {
    position: [f32; 3],
    /// Which of the clearances it has.
    clearance: u32,
    normal: [f32; 3],
    /// Of that, a bit for each direction.
    outer: u32,
}

/// A place of the table of cells: `gather.wgsl`. Empty where it holds no points.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
struct Slot {
    key: [u32; 2],
    first: u32,
    end: u32,
}

/// A level: `gather.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Default, Pod, Zeroable)]
struct Level {
    origin: [f32; 3],
    cells_per_metre: f32,
    /// One over the squared radius of a kernel, m⁻².
    per_square: f32,
    unused: [f32; 3],
}

/// What a table of cells is like: `gather.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Settings {
    /// How many levels are read.
    levels: u32,
    /// Places of the table but one: it has a power of two of them.
    mask: u32,
    unused: [u32; 2],
    level: [Level; MAX_LEVELS],
}

/// Cells of each level, and the points in them.
struct Cells {
    settings: Settings,
    slots: Vec<Slot>,
    /// The numbers of the points, cell by cell.
    order: Vec<u32>,
}

impl PointBuffer {
    /// Uploads points; their values are zero.
    ///
    /// # Errors
    /// [`RenderError::Points`] if the device cannot hold them.
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, cloud: &PointCloud) -> Result<Self, RenderError> {
        let limits = gpu.device().limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let limit = if limits.max_storage_buffers_per_shader_stage < BUFFERS {
            0
        } else {
            binding / size_of::<Node>() as u64
        };
        let (points, levels) = (cloud.points().len(), cloud.level_count() as usize);
        if points as u64 > limit || levels > MAX_LEVELS {
            return Err(RenderError::Points { points, levels, limit, most_levels: MAX_LEVELS });
        }
        within_memory(gpu, "points", || Self::make(gpu, layouts, cloud))
    }

    fn make(gpu: &Gpu, layouts: &Layouts, cloud: &PointCloud) -> Self {
        let points = cloud.points();
        let Cells { settings, slots, order } = Cells::of(points);
        let (mut around, mut lines) = (vec![(OPEN, 0); points.len()], Vec::new());
        for ((point, clearance), number) in cloud.clearances().zip(0..) {
            around[point as usize] = (number, clearance.outer.into());
            lines.extend(clearance.lines.map(|line| line.to_array()));
        }
        lines.resize(lines.len().max(DIRECTIONS), [0.0; 2]);
        let node = |&number: &u32| {
            let CloudPoint { position, normal, .. } = points[number as usize];
            let (clearance, outer) = around[number as usize];
            Node { position: position.to_array(), clearance, normal: normal.to_array(), outer }
        };
        // A binding is never empty.
        let mut nodes: Vec<Node> = order.iter().map(node).collect();
        nodes.resize(nodes.len().max(1), Node::zeroed());
        let storage = |label, bytes: &[u8]| buffer(gpu, label, wgpu::BufferUsages::STORAGE, bytes);
        let levels = settings.levels;
        let usage = wgpu::BufferUsages::UNIFORM;
        let settings = buffer(gpu, "levels of points", usage, bytemuck::bytes_of(&settings));
        let values = storage("light at points", &vec![0; nodes.len() * size_of::<[f32; 4]>()]);
        let resources = [
            &settings,
            &storage("points", bytemuck::cast_slice(&nodes)),
            &values,
            &storage("cells of points", bytemuck::cast_slice(&slots)),
            &storage("what stands around points", bytemuck::cast_slice(&lines)),
        ];
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("points"),
            layout: &layouts.points,
            entries: &(0..)
                .zip(resources)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect::<Vec<_>>(),
        });
        Self { order, levels, settings, values, group }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Replaces the values: those of the points in the order of the cloud; missing ones, and NaN, become zero.
    pub(crate) fn set(&self, gpu: &Gpu, values: &[Vec3]) {
        let value = |&point: &u32| {
            let value = values.get(point as usize).copied().unwrap_or_default();
            value.extend(0.0).to_array().map(number)
        };
        let values: Vec<[f32; 4]> = self.order.iter().map(value).collect();
        gpu.queue().write_buffer(&self.values, 0, bytemuck::cast_slice(&values));
    }

    /// Reads levels up to the finest of these.
    pub(crate) fn set_finest(&self, gpu: &Gpu, finest: u32) {
        let levels = self.levels.min(finest.saturating_add(1));
        gpu.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&levels));
    }
}

impl Cells {
    /// Sorts points into cells twice as wide as a kernel reaches: a place has all that are near in eight of them.
    fn of(points: &[CloudPoint]) -> Self {
        let mut settings =
            Settings { levels: 0, mask: 0, unused: [0; 2], level: [Level::default(); MAX_LEVELS] };
        let origin = points.iter().map(|point| point.position).fold(Vec3::INFINITY, Vec3::min);
        let mut by_level: Vec<u32> = (0..points.len() as u32).collect();
        by_level.sort_by_key(|&point| points[point as usize].level);
        let (mut order, mut cells) = (Vec::with_capacity(points.len()), Vec::new());
        let same = |a: &u32, b: &u32| points[*a as usize].level == points[*b as usize].level;
        for (numbers, number) in by_level.chunk_by(same).zip(0..) {
            let radius = points[numbers[0] as usize].radius;
            let level = Level {
                origin: origin.to_array(),
                cells_per_metre: 0.5 / radius,
                per_square: 1.0 / (radius * radius),
                unused: [0.0; 3],
            };
            let key_of = |point: &u32| {
                let from_origin = points[*point as usize].position - origin;
                key((from_origin * level.cells_per_metre).floor().as_ivec3(), number)
            };
            let mut numbers = numbers.to_vec();
            numbers.sort_by_cached_key(key_of);
            for cell in numbers.chunk_by(|a, b| key_of(a) == key_of(b)) {
                let first = order.len() as u32;
                order.extend_from_slice(cell);
                cells.push(Slot { key: key_of(&cell[0]), first, end: order.len() as u32 });
            }
            settings.level[number as usize] = level;
            settings.levels = number + 1;
        }
        let slots = table(&cells);
        settings.mask = slots.len() as u32 - 1;
        Self { settings, slots, order }
    }
}

/// Coordinates of a cell are told apart up to this many; points of others are told apart by their distance.
const CELLS: i32 = 1 << 16;

/// The name of a cell of a level.
fn key(cell: IVec3, level: u32) -> [u32; 2] {
    let [x, y, z] = cell.to_array().map(|k| k.rem_euclid(CELLS) as u32);
    [x | y << 16, z | level << 16]
}

/// Where the search for a cell begins: `slot_of` in `gather.wgsl`.
fn hash([a, b]: [u32; 2]) -> u32 {
    let mixed = a.wrapping_mul(0x9e37_79b1) ^ b.wrapping_mul(0x85eb_ca77);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2c1b_3c6d);
    mixed ^ mixed >> 13
}

/// A table of cells, less than half full, open addressing.
fn table(cells: &[Slot]) -> Vec<Slot> {
    let len = (2 * cells.len() + 1).next_power_of_two();
    let mut slots = vec![Slot::default(); len];
    for cell in cells {
        let mut at = hash(cell.key) as usize & (len - 1);
        while slots[at].end > 0 {
            at = (at + 1) & (len - 1);
        }
        slots[at] = *cell;
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_in_the_cell_that_its_place_leads_to() {
        let spread = |i: u32, k: f32| (i as f32 * k).sin() * 3.0;
        let point = |i: u32| CloudPoint {
            position: Vec3::new(spread(i, 0.37), spread(i, 0.73), spread(i, 1.19)),
            normal: Vec3::Y,
            radius: if i.is_multiple_of(3) { 0.8 } else { 0.4 },
            level: u32::from(!i.is_multiple_of(3)),
        };
        let points: Vec<CloudPoint> = (0..600).map(point).collect();
        let Cells { settings, slots, order } = Cells::of(&points);
        assert_eq!((settings.levels, order.len()), (2, 600));
        for (place, &number) in (0..).zip(&order) {
            let CloudPoint { position, level, .. } = points[number as usize];
            let Level { origin, cells_per_metre, .. } = settings.level[level as usize];
            let cell = ((position - Vec3::from(origin)) * cells_per_metre).floor().as_ivec3();
            let wanted = key(cell, level);
            let probes = (0..slots.len() as u32)
                .map(|i| slots[(hash(wanted).wrapping_add(i) & settings.mask) as usize]);
            let found = probes.take_while(|slot| slot.end > 0).find(|slot| slot.key == wanted).unwrap();
            assert!((found.first..found.end).contains(&place));
        }
    }

    #[test]
    fn cells_before_the_origin_have_names_of_their_own() {
        assert_ne!(key(IVec3::new(-1, 0, 0), 0), key(IVec3::new(1, 0, 0), 0));
        assert_ne!(key(IVec3::new(0, -1, 0), 0), key(IVec3::new(-1, 0, 0), 0));
        assert_ne!(key(IVec3::ZERO, 0), key(IVec3::ZERO, 1));
    }
}
