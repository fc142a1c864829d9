//! The elements of a PLY file that are used.

use crate::color::linear_from_srgb;
use glam::{DVec3, Vec2, Vec3};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

/// Names of texture coordinates.
pub(super) const UV_NAMES: [[&str; 2]; 4] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Names of alpha.
pub(super) const ALPHA_NAMES: [&str; 3] = ["alpha", "diffuse_alpha", "a"];

/// Names of lists of indices.
pub(super) const INDEX_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlyVertex {
    /// In world space.
    pub(super) position: DVec3,
    pub(super) normal: Vec3,
    pub(super) color: PlyColor,
    /// 0..=1.
    pub(super) alpha: f32,
    uv: Vec2,
}

/// A colour as it is stored.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlyColor {
    /// Fractions.
    value: Vec3,
    /// Whether it was of an integer type.
    is_integer: bool,
}

impl PlyColor {
    /// Names of its channels.
    pub(super) const NAMES: [[&str; 3]; 3] =
        [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

    /// Sets a channel; `None` if the property is none, `Some(false)` if it is not a number.
    fn set(&mut self, name: &str, property: &Property) -> Option<bool> {
        let channel = Self::NAMES.iter().find_map(|names| names.iter().position(|n| *n == name))?;
        let Some((value, white)) = channel_value(property) else { return Some(false) };
        self.value[channel] = value / white;
        self.is_integer |= white > 1.0;
        Some(true)
    }

    /// The largest channel of a floating-point colour; zero of others.
    pub(super) fn largest_float(&self) -> f32 {
        if self.is_integer { 0.0 } else { self.value.max_element() }
    }

    /// A floating-point colour that runs to 255 as if it was of bytes.
    pub(super) fn of_bytes(self) -> Self {
        if self.is_integer { self } else { Self { value: self.value / 255.0, is_integer: true } }
    }

    /// The linear colour, 0..=1: integers are sRGB.
    pub(super) fn linear(&self) -> Vec3 {
        let value = self.value.clamp(Vec3::ZERO, Vec3::ONE);
        if self.is_integer { linear_from_srgb(value) } else { value }
    }
}

impl PlyVertex {
    /// The texture coordinate with `v` down.
    pub(super) fn uv_down(&self) -> Vec2 {
        Vec2::new(self.uv.x, 1.0 - self.uv.y)
    }
}

impl PropertyAccess for PlyVertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(is_number) = self.color.set(name, &property) {
            return if is_number { PropertyAccessResult::Set } else { PropertyAccessResult::UnsupportedType };
        }
        if ALPHA_NAMES.contains(&name) {
            let Some((value, whole)) = channel_value(&property) else {
                return PropertyAccessResult::UnsupportedType;
            };
            self.alpha = value / whole;
            return PropertyAccessResult::Set;
        }
        let coordinate = match name {
            "x" => Some(&mut self.position.x),
            "y" => Some(&mut self.position.y),
            "z" => Some(&mut self.position.z),
            _ => None,
        };
        if let Some(coordinate) = coordinate {
            let Some(value) = scalar(&property) else { return PropertyAccessResult::UnsupportedType };
            *coordinate = value;
            return PropertyAccessResult::Set;
        }
        let slot = match name {
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "s" | "u" | "texture_u" | "texture_s" => &mut self.uv.x,
            "t" | "v" | "texture_v" | "texture_t" => &mut self.uv.y,
            _ => return PropertyAccessResult::Ignored,
        };
        let Some(value) = scalar(&property) else { return PropertyAccessResult::UnsupportedType };
        *slot = value as f32;
        PropertyAccessResult::Set
    }
}

/// The value of a channel, and that of white.
fn channel_value(property: &Property) -> Option<(f32, f32)> {
    Some(match *property {
        // Bytes, also where the header calls them signed.
        Property::Char(value) => (f32::from(value.cast_unsigned()), 255.0),
        Property::UShort(value) => (f32::from(value), 65_535.0),
        Property::Float(_) | Property::Double(_) => (scalar(property)? as f32, 1.0),
        // Wider integers hold bytes too.
        _ => (scalar(property)? as f32, 255.0),
    })
}

fn scalar(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(value) => f64::from(value),
        Property::UChar(value) => f64::from(value),
        Property::Short(value) => f64::from(value),
        Property::UShort(value) => f64::from(value),
        Property::Int(value) => f64::from(value),
        Property::UInt(value) => f64::from(value),
        Property::Float(value) => f64::from(value),
        Property::Double(value) => value,
        _ => return None,
    })
}

/// A face or strip; negative indices wrap to large ones.
#[derive(Clone, Debug, Default)]
pub(super) struct IndexList {
    pub(super) indices: Vec<u32>,
    pub(super) color: PlyColor,
}

impl PropertyAccess for IndexList {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(is_number) = self.color.set(name, &property) {
            return if is_number { PropertyAccessResult::Set } else { PropertyAccessResult::UnsupportedType };
        }
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
