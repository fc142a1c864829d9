//! The elements of a PLY file that are used.

use crate::color::linear_from_srgb;
use glam::{Vec2, Vec3};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

/// Names of texture coordinates.
pub(super) const UV_NAMES: [[&str; 2]; 4] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Names of lists of indices.
pub(super) const INDEX_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlyVertex {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    color: Vec3,
    color_is_srgb: bool,
    uv: Vec2,
}

impl PlyVertex {
    /// The texture coordinate with `v` down.
    pub(super) fn uv_down(&self) -> Vec2 {
        Vec2::new(self.uv.x, 1.0 - self.uv.y)
    }

    /// The linear colour.
    pub(super) fn tint(&self) -> Vec3 {
        if self.color_is_srgb { linear_from_srgb(self.color) } else { self.color }
    }
}

impl PropertyAccess for PlyVertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "red" => &mut self.color.x,
            "green" => &mut self.color.y,
            "blue" => &mut self.color.z,
            "s" | "u" | "texture_u" | "texture_s" => &mut self.uv.x,
            "t" | "v" | "texture_v" | "texture_t" => &mut self.uv.y,
            _ => return PropertyAccessResult::Ignored,
        };
        let is_color = matches!(name, "red" | "green" | "blue");
        let Some(value) = scalar(&property) else { return PropertyAccessResult::UnsupportedType };
        let white = match property {
            Property::UChar(_) if is_color => 255.0,
            Property::UShort(_) if is_color => 65_535.0,
            _ => 1.0,
        };
        *slot = value / white;
        self.color_is_srgb |= white > 1.0;
        PropertyAccessResult::Set
    }
}

fn scalar(property: &Property) -> Option<f32> {
    Some(match *property {
        Property::Char(value) => f32::from(value),
        Property::UChar(value) => f32::from(value),
        Property::Short(value) => f32::from(value),
        Property::UShort(value) => f32::from(value),
        Property::Int(value) => value as f32,
        Property::UInt(value) => value as f32,
        Property::Float(value) => value,
        Property::Double(value) => value as f32,
        _ => return None,
    })
}

/// A face or strip; negative indices wrap to large ones.
#[derive(Clone, Debug, Default)]
pub(super) struct IndexList {
    pub(super) indices: Vec<u32>,
}

impl PropertyAccess for IndexList {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !INDEX_NAMES.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.indices = match property {
            Property::ListUInt(list) => list,
            Property::ListInt(list) => list.into_iter().map(i32::cast_unsigned).collect(),
            Property::ListChar(list) => list.into_iter().map(|i| i32::from(i).cast_unsigned()).collect(),
            Property::ListShort(list) => list.into_iter().map(|i| i32::from(i).cast_unsigned()).collect(),
            Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element that is skipped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
